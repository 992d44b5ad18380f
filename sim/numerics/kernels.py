"""numba's compiler, and a place for compiled code where none that belongs to other sources is ever found."""

import fcntl
import hashlib
import inspect
import pickle
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import llvmlite
import numba
import numpy as np
from numba import config, types
from numba.core.compiler import CompileResult
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.core.typing.templates import infer_global

from sim.numerics import elementary
from sim.numerics.compiled_files import cache_folder, make_folder, mark_used, read, write
from sim.numerics.sources import ROOT, key_of

if TYPE_CHECKING:
    from numba.core.base import BaseContext

F = TypeVar("F")

__all__ = ["file_of", "folder_of", "njit", "register_formula", "wait_for_others"]

_OTHERS: dict[Path, Callable[[], object]] = {}
_FORMULAS: list["_Kernel"] = []
"""They live as long as the program: types hold them by weak references."""


def njit(*, cache: bool, nogil: bool = False) -> Callable[[F], F]:
    """Compile a function, once for each signature; its type stays what it is.

    Args:
        cache: keep what is compiled, for all processes that have the same sources.
        nogil: let other threads run beside it.
    """

    def compiled(function: F) -> F:
        if config.DISABLE_JIT:
            return function
        # Nobody goes C's way to call a kernel, which is no small part of what is compiled else.
        options = {"nogil": nogil, "no_cfunc_wrapper": True}
        kernel: F
        if cache:
            kernel = _Kernel(function, targetoptions={"nopython": True, **options})
        else:
            kernel = numba.njit(**options)(function)
        return kernel

    return compiled


def register_formula(formula: object) -> None:
    """Let kernels call a plain function, which stays one for others, in programs that need no compiler."""
    kernel = _Kernel(formula, targetoptions={"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True})
    infer_global(formula, types.Dispatcher(kernel))
    _FORMULAS.append(kernel)


def folder_of(source: Path) -> Path:
    """Return the folder of the compiled code of a file's kernels, which may not be there yet.

    It belongs to the file and to all files that it imports, as they are now, and to these versions of the compiler.
    """
    compiler = (sys.version, numba.__version__, llvmlite.__version__, np.__version__, config.OPT, config.BOUNDSCHECK)
    key = hashlib.blake2b(f"{key_of(source)} {compiler}".encode(), digest_size=8).hexdigest()
    module = source.relative_to(ROOT) if source.is_relative_to(ROOT) else Path(source.name)
    return cache_folder() / f"{'.'.join(module.with_suffix('').parts)}-{key}"


def file_of(kernel: object, signature: tuple[types.Type, ...]) -> Path:
    """Return the file of a kernel's code for a signature; once it is there, the code needs only be loaded."""
    # A kernel is a dispatcher of numba's.
    return kernel._cache.file(signature, kernel.targetctx)  # type: ignore[attr-defined,no-any-return]


def wait_for_others(compiled: Mapping[Path, Callable[[], object]]) -> None:
    """Wait for code that others are about to compile, by the file it will be in, instead of compiling it as well."""
    _OTHERS.update(compiled)


class _Kernel(CPUDispatcher):  # type: ignore[misc]  # numba has no types
    """A compiled function, of which a machine compiles each signature once."""

    def __init__(self, function: object, targetoptions: dict[str, bool]) -> None:
        super().__init__(function, targetoptions=targetoptions)
        # Where numba has its own.
        self._cache = _CompiledCode(function)

    def compile(self, signature: tuple[types.Type, ...]) -> object:
        """Compile or load the code for a signature; if another process is compiling it, wait for that and load it."""
        # The compiler's lock comes first: whoever has it may wait for a claim, which no other thread of ours has then.
        with global_compiler_lock, nullcontext() if signature in self.overloads else self._cache.claimed(signature):
            return super().compile(signature)

    def get_call_template(self, arguments: Iterable[types.Type], named: dict[str, types.Type]) -> object:
        """Find the code for a call by another kernel; that for any number serves one written in the caller's text."""
        named = {name: types.unliteral(kind) for name, kind in named.items()}
        return super().get_call_template(tuple(map(types.unliteral, arguments)), named)


class _CompiledCode:
    """The compiled code of one function; it stands where numba has its own cache, and has the methods that are called.

    numba's looks only at the file that a function stands in: after a change in another file from which it calls
    something, it would go on running the old code. And its index of signatures goes wrong where two processes write it
    at once; here a signature has a file of its own.
    """

    def __init__(self, function: object) -> None:
        # A kernel has the code of a function.
        self._name = f"{function.__qualname__}-{function.__code__.co_firstlineno}"  # type: ignore[attr-defined]
        self._folder = folder_of(Path(inspect.getfile(function)))  # type: ignore[arg-type]
        self.cache_path = str(self._folder)

    def load_overload(self, signature: object, target: "BaseContext") -> CompileResult | None:
        """Return what was compiled for a signature and this processor; None if nothing was."""
        content = read(self.file(signature, target))
        if content is None:
            return None
        # All that compiled code needs; numba's own cache loads what it would compile with as well.
        rtsys.initialize(target)
        compiled_for, parts = pickle.loads(content)
        if compiled_for != signature:
            return None
        mark_used(self._folder)
        return CompileResult._rebuild(target, *parts)

    def save_overload(self, signature: object, compiled: CompileResult) -> None:
        """Keep what was compiled for a signature; where that fails, it is compiled again next time."""
        with suppress(OSError):
            write(self.file(signature, compiled.target_context), dumps((signature, compiled._reduce())))

    @contextmanager
    def claimed(self, signature: object) -> Iterator[None]:
        """Let no other process compile for a signature meanwhile; a process that ends, in whatever way, has no claim.

        Claims never wait in a circle: who waits for a kernel claims none but its callers, and no kernel calls itself.
        """
        with ExitStack() as claim:
            with suppress(OSError):
                kept = self.file(signature, cpu_target.target_context)
                if kept in _OTHERS:
                    _OTHERS[kept]()
                if not kept.exists():
                    make_folder(self._folder)
                    file = claim.enter_context(Path(f"{kept}.claim").open("w"))
                    fcntl.flock(file, fcntl.LOCK_EX)
                    claim.callback(Path(file.name).unlink, missing_ok=True)
            yield

    def file(self, signature: object, target: "BaseContext") -> Path:
        """Return the file of a signature's code for this processor, whether or not it exists."""
        which = f"{signature} {target.codegen().magic_tuple()}"
        return self._folder / f"{self._name}-{hashlib.blake2b(which.encode(), digest_size=8).hexdigest()}"


for _, _formula in inspect.getmembers(elementary, inspect.isfunction):
    register_formula(_formula)

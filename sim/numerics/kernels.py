"""numba's compiler, with a store of compiled code. Code compiled from other sources is never loaded."""

import fcntl
import hashlib
import inspect
import pickle
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from functools import cache as once
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import llvmlite
import numba
import numpy as np
from llvmlite.binding import ModuleRef, ObjectFileRef, parse_bitcode
from numba import config, types
from numba.core.codegen import CPUCodegen, JITCodeLibrary
from numba.core.compiler import CompileResult, compile_result
from numba.core.compiler_lock import global_compiler_lock
from numba.core.environment import Environment, lookup_environment
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.core.typing.templates import infer_global

from sim.numerics import elementary
from sim.numerics.compiled_files import cache_folder, make_folder, mark_used, read, write
from sim.numerics.sources import ROOT, key_of

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.funcdesc import FunctionDescriptor

F = TypeVar("F")

__all__ = ["file_of", "folder_of", "njit", "register_formula", "wait_for_others"]

_OTHERS: dict[Path, Callable[[], object]] = {}
_FORMULAS: list["_Kernel"] = []
"""Types of plain functions for kernels, kept until the program ends, because numba has only weak references to them."""


def njit(*, cache: bool, nogil: bool = False) -> Callable[[F], F]:
    """Compile a function once for each signature. Type checkers still see the function's own type.

    Args:
        cache: True to store the code for all processes with the same sources.
        nogil: True to let other threads run at the same time.
    """

    def compiled(function: F) -> F:
        if config.DISABLE_JIT:
            return function
        # C never calls kernels. Skipping that wrapper saves much of the compile time.
        options = {"nogil": nogil, "no_cfunc_wrapper": True}
        kernel: F
        if cache:
            kernel = _Kernel(function, targetoptions={"nopython": True, **options})
        else:
            kernel = numba.njit(**options)(function)
        return kernel

    return compiled


def register_formula(formula: object) -> None:
    """Let kernels call a plain function. Other callers still call the plain function, even without the compiler."""
    kernel = _Kernel(formula, targetoptions={"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True})
    infer_global(formula, types.Dispatcher(kernel))
    _FORMULAS.append(kernel)


def folder_of(source: Path) -> Path:
    """Return the folder of the compiled code of a file's kernels. It may not exist yet.

    The name depends on the content of the file and of all files that it imports, on this module, which defines the
    form of stored code, and on the compiler's versions.
    """
    compiler = (sys.version, numba.__version__, llvmlite.__version__, np.__version__, config.OPT, config.BOUNDSCHECK)
    sources = f"{key_of(source)} {key_of(Path(__file__))}"
    key = hashlib.blake2b(f"{sources} {compiler}".encode(), digest_size=8).hexdigest()
    module = source.relative_to(ROOT) if source.is_relative_to(ROOT) else Path(source.name)
    return cache_folder() / f"{'.'.join(module.with_suffix('').parts)}-{key}"


def file_of(kernel: object, signature: tuple[types.Type, ...]) -> Path:
    """Return the file of a kernel's code for a signature. If the file exists, the code need not be compiled."""
    # A kernel is a dispatcher of numba.
    return kernel._cache.file(signature)  # type: ignore[attr-defined,no-any-return]


def wait_for_others(compiled: Mapping[Path, Callable[[], object]]) -> None:
    """Let kernels wait for code that other processes are about to compile, given by its files."""
    _OTHERS.update(compiled)


class _Kernel(CPUDispatcher):  # type: ignore[misc]  # numba has no types
    """A compiled function. Each of its signatures is compiled only once per machine."""

    def __init__(self, function: object, targetoptions: dict[str, bool]) -> None:
        super().__init__(function, targetoptions=targetoptions)
        # numba has its own cache at this place.
        self._cache = _CompiledCode(function)

    def compile(self, signature: tuple[types.Type, ...]) -> object:
        """Compile or load the code for a signature. If another process is compiling it, wait and load the result."""
        # Take the compiler's lock first. Its holder may wait for a claim, and no other thread of this process can hold
        # a claim at that time.
        with global_compiler_lock, nullcontext() if signature in self.overloads else self._cache.claimed(signature):
            return super().compile(signature)

    def get_call_template(self, arguments: Iterable[types.Type], named: dict[str, types.Type]) -> object:
        """Find the code for a call by another kernel. A literal number uses the same code as any number of its type."""
        named = {name: types.unliteral(kind) for name, kind in named.items()}
        return super().get_call_template(tuple(map(types.unliteral, arguments)), named)


class _CompiledCode:
    """The compiled code of one function. It replaces numba's own cache, with the methods that numba calls.

    numba's cache only checks the file that contains the function. If a called function in another file changed, numba
    would run the old code. Also, its index of signatures breaks if two processes write it at the same time. Here each
    signature has its own file.
    """

    def __init__(self, function: object) -> None:
        # `function` may be a kernel, which has the `__code__` of its function.
        self._name = f"{function.__qualname__}-{function.__code__.co_firstlineno}"  # type: ignore[attr-defined]
        self._folder = folder_of(Path(inspect.getfile(function)))  # type: ignore[arg-type]
        self.cache_path = str(self._folder)

    def load_overload(self, signature: object, target: "BaseContext") -> CompileResult | None:
        """Return the stored code for a signature and this processor. If there is none, return None."""
        content = read(self.file(signature))
        if content is None:
            return None
        # This initializes all that compiled code needs. numba's own cache also loads all that compiling needs,
        # which is slow.
        rtsys.initialize(target)
        compiled_for, *parts = pickle.loads(content)
        if compiled_for != signature:
            return None
        mark_used(self._folder)
        return _rebuilt(target, *parts)

    def save_overload(self, signature: object, compiled: CompileResult) -> None:
        """Store the code for a signature. If this fails, it is compiled again next time."""
        with suppress(OSError):
            write(self.file(signature), dumps((signature, *_parts_of(compiled))))

    @contextmanager
    def claimed(self, signature: object) -> Iterator[None]:
        """Let no other process compile a signature while this context is open. A process that ends loses its claims.

        Claims never wait in a circle: a process that waits for a kernel holds only claims of its callers, and no kernel
        calls itself.
        """
        with ExitStack() as claim:
            with suppress(OSError):
                kept = self.file(signature)
                if kept in _OTHERS:
                    _OTHERS[kept]()
                if not kept.exists():
                    make_folder(self._folder)
                    file = claim.enter_context(Path(f"{kept}.claim").open("w"))
                    fcntl.flock(file, fcntl.LOCK_EX)
                    claim.callback(Path(file.name).unlink, missing_ok=True)
            yield

    def file(self, signature: object) -> Path:
        """Return the file of a signature's code for this processor, existing or not."""
        which = f"{signature} {_processor()}"
        return self._folder / f"{self._name}-{hashlib.blake2b(which.encode(), digest_size=8).hexdigest()}"


@once
def _processor() -> str:
    """Return the name and features of this processor, for which code is compiled."""
    return str(cpu_target.target_context.codegen().magic_tuple())


class _StoredLibrary(JITCodeLibrary):  # type: ignore[misc]  # numba has no types
    """Machine code of a kernel from the store.

    Its bitcode is only parsed when another kernel that calls this kernel is compiled.
    """

    def __init__(self, codegen: CPUCodegen, name: str, code: bytes, bitcode: bytes) -> None:
        super().__init__(codegen, name)
        self._bitcode = bitcode
        codegen._engine._ee.add_object_file(ObjectFileRef.from_data(code))
        codegen._engine.finalize_object()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of a function of this library. numba's own method does not know functions of objects."""
        address: int = self._codegen._engine.get_function_address(name)
        return address

    def _get_module_for_linking(self) -> ModuleRef:
        # numba's own finished libraries also keep this module.
        if self._bitcode:
            self._shared_module, self._bitcode = parse_bitcode(self._bitcode), b""
        return self._shared_module


_Environment = tuple[str, str | None, list[object]]
"""Name of a function's environment, name of the function's module, and Python objects that its code uses."""


def _parts_of(compiled: CompileResult) -> tuple[object, ...]:
    """Return what `_rebuilt` needs to make a compile result again."""
    name, _, (code, bitcode) = compiled.library.serialize_using_object_code()
    environments = [
        (env.env_name, env.globals.get("__name__"), env.consts)
        for env in (compiled.environment, *compiled._find_referenced_environments())
    ]
    fndesc = compiled.fndesc
    fndesc.typemap = fndesc.calltypes = None  # They cannot always be pickled, and are only needed for compiling.
    return name, code, bitcode, fndesc, compiled.signature, compiled.reload_init, environments


def _rebuilt(
    target: "BaseContext",
    name: str,
    code: bytes,
    bitcode: bytes,
    fndesc: "FunctionDescriptor",
    signature: object,
    reload_init: list[Callable[[], object]],
    environments: list[_Environment],
) -> CompileResult:
    """Return a compile result from its parts.

    numba's own method parses the bitcode, and imports the module of each function that the compiler inlined; some of
    these modules of numba import scipy.
    """
    for prepare in reload_init:
        prepare()
    library = _StoredLibrary(target.codegen(), name, code, bitcode)
    own, *others = map(_environment, environments)
    entry_point = target.get_executable(library, fndesc, own)
    for env in others:
        library.codegen.set_env(env.env_name, env)
    return compile_result(
        target_context=target,
        typing_context=target.typing_context,
        library=library,
        environment=own,
        entry_point=entry_point,
        fndesc=fndesc,
        signature=signature,
        objectmode=False,
        lifted=(),
        reload_init=reload_init,
        referenced_envs=others,
    )


def _environment(parts: _Environment) -> Environment:
    """Return a function's environment. Its globals are empty except for the module's name, because only code in object
    mode reads globals."""
    name, module, constants = parts
    env = lookup_environment(name)
    if env is None:
        env = Environment({"__name__": module})
        env.env_name = name
        env.consts[:] = constants
        Environment._memo[name] = env
    return env


for _, _formula in inspect.getmembers(elementary, inspect.isfunction):
    register_formula(_formula)

"""numba's compiler, with a folder for compiled code that belongs to these very sources."""

import hashlib
import inspect
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from numba import config
from numba.extending import register_jitable

from sim.common import elementary
from sim.common.geometry import wrap_angle

if TYPE_CHECKING:
    F = TypeVar("F")

    def njit(*, cache: bool, nogil: bool = False) -> Callable[[F], F]:
        """Compile a function; its type stays what it is."""
else:
    from numba import njit

__all__ = ["is_compiled", "njit", "register_jitable"]

# Plain code calls these, too, in programs that need no compiler.
register_jitable(wrap_angle)
for _, _formula in inspect.getmembers(elementary, inspect.isfunction):
    register_jitable(_formula)


def _folder_of_compiled_code() -> Path:
    """Return the folder of compiled kernels that belongs to these very sources.

    numba looks only at the file that a kernel stands in: after a change in another file from which the kernel calls
    something, it would go on running the old code.
    """
    here = Path(__file__).parents[1]
    sources = hashlib.blake2b(digest_size=8)
    for source in sorted(here.rglob("*.py")):
        sources.update(source.read_bytes())
    folder = here / "__pycache__" / f"kernels-{sources.hexdigest()}"
    if not folder.exists():
        for older in folder.parent.glob("kernels-*"):
            shutil.rmtree(older, ignore_errors=True)
    return folder


_FOLDER = _folder_of_compiled_code()
# Where this folder cannot be written, numba finds a place of its own.
config.CACHE_DIR = str(_FOLDER)  # type: ignore[attr-defined]  # numba makes it at import, from the environment


def is_compiled() -> bool:
    """Return True when kernels of these sources were compiled here before; else the first run takes longer."""
    # numba makes the folder as soon as a kernel is imported.
    return any(_FOLDER.rglob("*.nbc"))

"""Checks of folders that commands write to, and of the compiled code of the simulator."""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryFile, gettempdir

from sim.numerics.compiled_files import cache_folder
from thbridge.files.errors import reason_of
from ui.commands.doctor.result import HealthCheck, fault, ok, warning

LITTLE = 1_000_000_000
"""Size of several long recordings, bytes. If less space is free, the check prints a warning."""
TOO_LITTLE = 50_000_000
"""Size of one recording, bytes. If less space is free, the check reports a fault."""


def check_folder(name: str, folder: Path) -> HealthCheck:
    """Check that a folder is writable and has free space. If it does not exist, check its nearest existing parent."""
    place = folder.absolute()
    while not place.exists():
        place = place.parent
    try:
        if not place.is_dir():
            raise NotADirectoryError(20, "Not a directory")
        TemporaryFile(dir=place).close()
        free = shutil.disk_usage(place).free
    except OSError as error:
        remedy = "Change its permissions, or run thbridge in another folder"
        return fault(name, f"{place} is not writable ({reason_of(error).lower()})", remedy)
    room = f"{free / 1e9:.1f} GB free in {place}"
    if free < TOO_LITTLE:
        return fault(name, room, "Delete files, or use another disk")
    return warning(name, room, "Delete files before long recordings") if free < LITTLE else ok(name, room)


def check_kernels() -> HealthCheck:
    """Check that the simulator is compiled, and that compiled code is stored permanently."""
    name = "compiled code"
    folder = cache_folder()
    usual = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    if not folder.is_relative_to(Path(usual).resolve()) and folder.is_relative_to(Path(gettempdir()).resolve()):
        remedy = f"Make {usual} a folder that you own and that others cannot write to"
        return warning(name, f"it is only stored in the temporary folder {folder}", remedy)
    try:
        from sim.numerics.signatures import missing, recorded_calls  # may fail to import

        left, total = len(missing(before_moves=False)), len(recorded_calls())
    except (ImportError, OSError) as error:
        return fault(name, f"the compiler cannot be loaded ({error})", "Install thbridge again with its dependencies")
    if left == total:
        return ok(name, f"no part is compiled yet in {folder}; the first game compiles {total} parts")
    if left:
        return ok(name, f"{total - left} of {total} parts are up to date in {folder}; the next game compiles the rest")
    return ok(name, f"all {total} parts are up to date in {folder}")

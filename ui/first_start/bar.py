"""Progress bar while the simulator is compiled, on a terminal or in a window with the button *Cancel*."""

import atexit
import hashlib
import os
import subprocess
import sys
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from threading import Thread

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from sim.numerics.compiled_files import cache_folder, make_folder, mark_used
from sim.numerics.sources import ROOT, key_of
from ui.command_line.terminal import FAILED, err, note
from ui.first_start.generated_code import keep_generated_code

FIRST_START = "Compiling the simulator for this machine (first start only)."
STOPPED = "Stopped. Compiled parts are kept, and the next start compiles the rest."
_WINDOW = "from ui.windows.first_start import show; show()"


def own_environment() -> dict[str, str]:
    """Return environment variables with which child processes use the same sources and cache of compiled code."""
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(cache_folder().parent)}


class StartBar:
    """Progress bar of this program, and the compiling processes that its user can cancel.

    Attributes:
        compilers: processes that compile for this program.
    """

    def __init__(self) -> None:
        self.compilers: set[subprocess.Popen[str]] = set()
        self._window: subprocess.Popen[str] | None = None
        self._terminal: Progress | None = None
        self._task = TaskID(0)

    def open(self, look: str | None = None) -> None:
        """Show the bar on a terminal; if `look` names colors of windows, also in a window."""
        atexit.register(self.close)  # Close the bar even after an error, because the bar hides the terminal's cursor.
        if self._terminal is None and err.is_terminal:
            what = "Compiling the remaining parts" if is_unfinished() else "First start: compiling"
            columns = (TextColumn(what), BarColumn(20), MofNCompleteColumn(), TimeElapsedColumn())
            self._terminal = Progress(*columns, console=err, transient=True)
            self._task = self._terminal.add_task("", total=None)
            self._terminal.start()
        if self._window is None and look is not None:
            self._window = subprocess.Popen(
                [sys.executable, "-P", "-c", _WINDOW, look],
                env=own_environment(),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                start_new_session=True,  # Only this program handles Ctrl-C; it then closes the window.
            )
            Thread(target=self._wait_for_cancel, args=(self._window,), daemon=True).start()

    def show(self, done: int, total: int) -> None:
        """Show the number of compiled kernels, and the number of all kernels."""
        if self._terminal is not None:
            self._terminal.update(self._task, completed=done, total=total)
        if self._window is not None and self._window.stdin is not None:
            with suppress(OSError):
                print(done, total, file=self._window.stdin, flush=True)

    def close(self) -> None:
        """Close the bar."""
        if self._terminal is not None:
            self._terminal.stop()
        if self._window is not None and self._window.stdin is not None:
            with suppress(OSError):
                self._window.stdin.close()
        self._window = self._terminal = None

    def stop_compiling(self) -> None:
        """Kill the processes that compile. Files of compiled code are either complete or missing."""
        for process in self.compilers:
            process.kill()

    def _wait_for_cancel(self, window: "subprocess.Popen[str]") -> None:
        """End the program if the user cancels. Only the bar must be closed, because nothing else is open yet."""
        with window:
            if window.stdout is not None and window.stdout.readline() == "cancel\n":
                self.stop_compiling()
                self.close()
                note(STOPPED)
                os._exit(FAILED)


START_BAR = StartBar()


def announce_start(look: str | None = None) -> None:
    """Open the bar if the simulator has not been compiled here, and speed up the imports that follow.

    To be called before all other imports.

    Args:
        look: colors of the window with the bar. If None, there is no window.
    """
    keep_generated_code(cache_folder() / f"dataclasses-{_key()}" / "code")
    if not _compiled_mark().exists():
        START_BAR.open(look)


def mark_compiled() -> None:
    """Record that all kernels that hunts usually need are compiled, so that the next start shows no bar."""
    _make_mark(_compiled_mark())


def mark_begun() -> None:
    """Record that compiling has begun, so that the next start finishes it."""
    _make_mark(_begun_mark())


def is_unfinished() -> bool:
    """Return True if an earlier start began to compile these sources here and did not finish."""
    return _begun_mark().exists() and not _compiled_mark().exists()


def _make_mark(mark: Path) -> None:
    with suppress(OSError):
        make_folder(mark)
        mark_used(mark)


def _compiled_mark() -> Path:
    """Return the path of a folder that exists if these sources were compiled here; do not import the compiler."""
    return cache_folder() / f"first_start-{_key()}"


def _begun_mark() -> Path:
    """Return the path of a folder that exists if a start began to compile these sources here."""
    return cache_folder() / f"begun-{_key()}"


@cache
def _key() -> str:
    """Return a hash of these sources and of the compiler's versions."""
    recorded = ROOT / "sim" / "numerics" / "signatures.jsonl"
    parts = (key_of(ROOT / "sim" / "team.py"), recorded.read_text(encoding="utf-8"), sys.version)
    versions = (version(name) for name in ("numba", "llvmlite", "numpy"))
    return hashlib.blake2b(" ".join((*parts, *versions)).encode(), digest_size=8).hexdigest()

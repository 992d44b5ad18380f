import json
import os
import pty
import re
import signal
import subprocess
import sys
import termios
from contextlib import suppress
from pathlib import Path

import pytest

from sim.numerics.compiled_files import read
from sim.numerics.signatures import RECORDED
from tests.support.project import ROOT
from ui.first_start.bar import FIRST_START, STOPPED

PROGRAM = """\
import sys
from pathlib import Path
from sim.numerics import signatures
from ui.first_start.compiling import compile_ahead

signatures.RECORDED = Path(sys.argv[1])
compile_ahead(whole_hunt=True)
print(len(signatures.missing(before_moves=False)))
"""


def start(folder: Path, calls: list[str], program: str = PROGRAM) -> tuple[int, str]:
    """Compile the calls ahead; how many are missing then, and what was told."""
    (folder / "calls").write_text("".join(f"{call}\n" for call in calls))
    ended = subprocess.run(
        [sys.executable, "-c", program, "calls"], cwd=folder, check=True, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "cache")},
    )  # fmt: skip
    return int(ended.stdout), ended.stderr


@pytest.mark.slow
def test_what_is_recorded_is_compiled_ahead_once(tmp_path: Path) -> None:
    # Those that take least.
    calls = RECORDED.read_text().splitlines()[-3:]
    missing, told = start(tmp_path, calls)
    assert missing == 0
    assert told == f"{FIRST_START}\n"
    assert start(tmp_path, calls) == (0, "")


@pytest.mark.slow
def test_what_a_short_run_leaves_is_compiled_before_the_next_which_says_so(tmp_path: Path) -> None:
    recorded = RECORDED.read_text().splitlines()
    ahead = [call for call in recorded if not json.loads(call)["moves"]][-1:]
    calls = [*ahead, *[call for call in recorded if json.loads(call)["moves"]][-12:]]
    short = PROGRAM.replace("whole_hunt=True", "whole_hunt=False")
    left, told = start(tmp_path, calls, short)
    assert left > 0
    assert told == f"{FIRST_START}\n"
    missing, told = start(tmp_path, calls, short)
    assert missing == 0
    match = re.fullmatch(
        r"Compiling (\d+) of 13 parts of the simulator for this machine, because an earlier start did not finish\.\n",
        told,
    )
    assert match, told
    assert 0 < int(match[1]) <= left
    assert start(tmp_path, calls, short) == (0, "")


@pytest.mark.slow
def test_a_call_that_cannot_be_compiled_holds_nobody_up(tmp_path: Path) -> None:
    calls = RECORDED.read_text().splitlines()[-1:]
    wrong = json.dumps(json.loads(calls[0]) | {"arguments": ["float64"] * 12})
    assert start(tmp_path, [wrong, *calls])[0] == 1


MANY = 24
"""Calls that take longer to compile than a signal takes to arrive, however busy the machine is."""

CANCELLED = """\
import signal
import sys
from pathlib import Path
import typer
from ui.first_start import bar as start_bar

signal.signal(signal.SIGINT, signal.default_int_handler)  # As main does: tests begun by & in a script ignore it.
start_bar._WINDOW = sys.argv[2]
start_bar.announce_start("system")
print("numba" in sys.modules, start_bar.START_BAR._window is not None, flush=True)

from sim.numerics import signatures
from ui.first_start.compiling import compile_ahead

signatures.RECORDED = Path(sys.argv[1])
try:
    compile_ahead(whole_hunt=True, look="system")
except typer.Exit as left:
    sys.exit(left.exit_code)
print("compiled")
"""
CANCEL = "import sys; sys.stdin.readline(); print('cancel', flush=True)"
WAIT = "import sys; sys.stdin.read()"
"""Windows in which people cancel once something is compiled, and wait until all is."""


def start_with_window(folder: Path, window: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", CANCELLED, "calls", window], cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "cache")},
    )  # fmt: skip


def test_cancel_ends_the_first_start_and_its_compilers_and_leaves_a_whole_cache(tmp_path: Path) -> None:
    (tmp_path / "calls").write_text("".join(f"{call}\n" for call in RECORDED.read_text().splitlines()[-MANY:]))
    ended = start_with_window(tmp_path, CANCEL)
    assert (ended.returncode, ended.stdout) == (1, "False True\n"), ended.stderr
    assert STOPPED in ended.stderr
    assert "Traceback" not in ended.stderr
    # Their standard output is this pipe, too: it would not have ended before they have.
    kept = [path for path in (tmp_path / "cache").rglob("*-*") if path.is_file() and path.suffix != ".claim"]
    assert all(read(path) is not None for path in kept)


def test_on_a_terminal_there_is_one_line_with_seconds_and_ctrl_c_stops(tmp_path: Path) -> None:
    (tmp_path / "calls").write_text("".join(f"{call}\n" for call in RECORDED.read_text().splitlines()[-MANY:]))
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (24, 80))
    program = subprocess.Popen(
        [sys.executable, "-c", CANCELLED.replace('"system"', "None"), "calls", ""],
        cwd=tmp_path, stdin=theirs, stdout=subprocess.DEVNULL, stderr=theirs, start_new_session=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path / "cache"), "TERM": "xterm"},
    )  # fmt: skip
    os.close(theirs)
    shown = ""
    stopped = False
    with suppress(OSError):  # It ends with the program.
        while piece := os.read(ours, 4096).decode(errors="replace"):
            shown += piece
            if f"0/{MANY}" in shown and not stopped:
                stopped = True
                program.send_signal(signal.SIGINT)
    os.close(ours)
    assert program.wait() == 1
    assert re.search(r"First start: compiling .*0/\?.*0:00:0\d", shown), "before anything is loaded"
    assert STOPPED in shown
    assert "Traceback" not in shown


@pytest.mark.slow
def test_the_bar_is_there_until_all_is_compiled_and_never_again(tmp_path: Path) -> None:
    (tmp_path / "calls").write_text("".join(f"{call}\n" for call in RECORDED.read_text().splitlines()[-2:]))
    ended = start_with_window(tmp_path, WAIT)
    assert (ended.returncode, ended.stdout) == (0, "False True\ncompiled\n"), ended.stderr
    again = start_with_window(tmp_path, WAIT)
    assert (again.returncode, again.stdout, again.stderr) == (0, "False False\ncompiled\n", "")

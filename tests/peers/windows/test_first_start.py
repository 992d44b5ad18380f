"""The first start on a machine, on a real display: a window with seconds and Cancel, before anything is compiled."""

import subprocess
from pathlib import Path

import pytest

from tests.support.programs.processes import THBRIDGE, Program
from tests.support.windows.desktop import desktop, needs_desktop
from ui.first_start.bar import STOPPED


@needs_desktop
@pytest.mark.parametrize("command", [("play",), pytest.param(("study", "run", "new"), marks=pytest.mark.slow)])
def test_a_window_with_seconds_comes_before_anything_is_compiled_and_cancel_ends_the_program(
    tmp_path: Path, command: tuple[str, ...]
) -> None:
    if "new" in command:
        subprocess.run([*THBRIDGE, "study", "new", "new"], cwd=tmp_path, check=True, capture_output=True)
    cache = tmp_path / "cache"
    with desktop(800, 480) as screen:
        program = Program(tmp_path, *command, environment={**screen.environment, "NUMBA_CACHE_DIR": str(cache)})
        try:
            screen.focus_window("Starting thbridge")
            assert not [path for path in cache.rglob("*") if path.is_file()]
            screen.click(screen.rested("Cancel", role="push button"))
            assert program.process.wait(60) == 1
        finally:
            program.close()
    assert STOPPED in program.text
    assert "Traceback" not in program.text

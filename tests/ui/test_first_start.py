import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from sim.numerics.signatures import RECORDED
from tests.compiling import ROOT

PROGRAM = """\
import sys
from pathlib import Path
from sim.numerics import signatures
from ui.first_start import compile_ahead

signatures.RECORDED = Path(sys.argv[1])
compile_ahead(whole_hunt=True)
print(len(signatures.missing(before_moves=False)))
"""


def start(folder: Path, calls: list[str]) -> tuple[int, str]:
    """Compile the calls ahead; how many are missing then, and what was told."""
    (folder / "calls").write_text("".join(f"{call}\n" for call in calls))
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, "calls"], cwd=folder, check=True, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "cache")},
    )  # fmt: skip
    return int(ended.stdout), ended.stderr


@pytest.mark.slow
def test_what_is_recorded_is_compiled_ahead_once(tmp_path: Path) -> None:
    # Those that take least.
    calls = RECORDED.read_text().splitlines()[-3:]
    missing, told = start(tmp_path, calls)
    assert missing == 0
    assert "first start only" in told
    assert start(tmp_path, calls) == (0, "")


@pytest.mark.slow
def test_a_call_that_cannot_be_compiled_holds_nobody_up(tmp_path: Path) -> None:
    calls = RECORDED.read_text().splitlines()[-1:]
    wrong = json.dumps(json.loads(calls[0]) | {"arguments": ["float64"] * 12})
    assert start(tmp_path, [wrong, *calls])[0] == 1

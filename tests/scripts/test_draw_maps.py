import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "draw" / "maps.py"
RESOLUTION = 0.05

drawn = runpy.run_path(str(SCRIPT))


def files(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def test_a_map_is_what_the_script_draws(tmp_path: Path) -> None:
    plan = drawn["PRACTICE"]
    drawn["write"](plan, tmp_path / plan.name, RESOLUTION)
    assert files(tmp_path / plan.name) == files(ROOT / "maps" / plan.name)


@pytest.mark.parametrize("plan", [drawn["ARENA8"], drawn["WAREHOUSE12"], drawn["OFFICE"]], ids=lambda plan: plan.name)
def test_a_larger_map_is_too_but_for_its_costs(plan, tmp_path: Path) -> None:
    drawn["write"](replace(plan, estimate_costs=False), tmp_path / plan.name, RESOLUTION)
    kept = files(ROOT / "maps" / plan.name)
    del kept["mapTimes"]
    assert files(tmp_path / plan.name) == kept


@pytest.mark.slow
def test_all_maps_are_what_the_script_draws(tmp_path: Path) -> None:
    subprocess.run([sys.executable, SCRIPT, "--into", tmp_path], check=True, cwd="/")
    for name in ("arena8", "office", "practice", "warehouse12"):
        kept = files(ROOT / "maps" / name)
        if name == "arena8":
            del kept["mapTimes"]  # Measured.
        assert files(tmp_path / name) == kept

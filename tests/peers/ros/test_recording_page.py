"""The page on recordings, with ROS's tools, evo and pandas: every script runs as it stands, and they agree."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import skip_if_crashed
from tests.support.project import ROOT

EVO = ROOT / ".peers" / "evo" / "bin"
PAGE = ROOT / "docs" / "how-to" / "your-own-recording.md"
_SCRIPT = re.compile(r"^```(sh|bash)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("rostopic") is None, reason="not installed: rostopic (see scripts/install_peers.sh)")
@pytest.mark.skipif(not (EVO / "evo_ape").exists(), reason="not installed: evo (see scripts/install_peers.sh)")
def test_the_tools_of_others_read_what_the_page_says(tmp_path: Path) -> None:
    ours = Path(sys.executable).parent
    said = []
    for kind, script in _SCRIPT.findall(PAGE.read_text(encoding="utf-8")):
        surroundings = {name: value for name, value in os.environ.items() if name not in {"DISPLAY", "PYTHONPATH"}}
        surroundings["PATH"] = os.pathsep.join([str(ours if kind == "sh" else EVO), os.environ["PATH"]])
        surroundings["HOME"] = str(tmp_path)
        if kind == "sh":
            surroundings["PYTHONPATH"] = str(ROOT)
        command = ["bash", "-euo", "pipefail", "-c", script]
        ran = subprocess.run(
            command, cwd=tmp_path, env=surroundings, capture_output=True, text=True, timeout=300, check=False
        )
        if kind == "bash":  # Tools of others, in a shell, which exits with 128 and the number of the signal.
            skip_if_crashed("ROS or evo", 128 - ran.returncode, ran.stderr)
        assert ran.returncode == 0, f"{script}\n{ran.stdout}\n{ran.stderr}"
        if kind == "bash":
            said.append(ran.stdout)
    by_ros, by_evo, by_pandas = said
    error = float(by_ros.split()[-1])
    found = dict(re.findall(r"(max|rmse|mean)\s+(\d+\.\d+)", by_evo))
    assert 0.0 < float(found["mean"]) <= float(found["rmse"]) <= float(found["max"])
    at_20 = float(re.search(r"error_m\s+(\d\S*)", by_pandas)[1])
    assert error == pytest.approx(at_20, abs=2e-3)

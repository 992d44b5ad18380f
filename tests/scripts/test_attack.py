"""The whole attack on a session, by its own command: nobody else notices much."""

import json
import subprocess
import sys

import pytest

from tests.support.project import ROOT


@pytest.mark.slow
@pytest.mark.timeout(1600)
def test_a_session_bears_each_attack() -> None:
    command = [sys.executable, "scripts/attack.py", "--scale", "3"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=1500, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    outcome = json.loads(done.stdout.splitlines()[-1])
    assert outcome["held"] == outcome["attacks"] > 20

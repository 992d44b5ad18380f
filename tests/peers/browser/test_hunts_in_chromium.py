"""Whole games in Debian's Chromium: by mouse, by keyboard alone, and by touch on a phone; axe-core judges each page."""

import json
import subprocess
from pathlib import Path

import pytest

from tests.support.programs.processes import Program, until
from tests.support.project import ROOT

SELENIUM = ROOT / ".peers" / "selenium" / "bin" / "python"
STUDY = "map: practice\ntemplates: practice\nrobots: 1\nrate: 6\n"

pytestmark = pytest.mark.skipif(
    not (SELENIUM.exists() and Path("/usr/bin/chromium").exists() and Path("/usr/bin/chromedriver").exists()),
    reason="Chromium or selenium is not installed (make peers, as root)",
)


@pytest.mark.parametrize(
    ("how", "width", "height"),
    [
        ("mouse", 1280, 800),
        pytest.param("keyboard", 1024, 768, marks=pytest.mark.slow),
        pytest.param("touch", 390, 844, marks=pytest.mark.slow),
    ],
)
def test_a_person_plays_a_whole_game(how: str, width: int, height: int, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(STUDY)
    server = Program(tmp_path, "serve", "study.yaml", "--port", "0")
    try:
        until("the gateway", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
        port = server.text.split("127.0.0.1:")[1].split("/")[0]
        script = Path(__file__).with_name("hunt_in_chromium.py")
        played = subprocess.run(
            [SELENIUM, script, port, how, str(width), str(height), tmp_path],
            capture_output=True,
            text=True,
            timeout=400,
            check=False,
        )
        assert played.returncode == 0, played.stderr
        result = json.loads(played.stdout.splitlines()[-1])
        assert result["ended"], (result, server.text)
        assert not result["errors"]
        assert not result["faults"]
        assert {"start", "rooms", "dialogue", "treasure", "thanks"} <= set(result["pages"])
    finally:
        server.stop()
        server.close()
    assert len(list((tmp_path / "served").glob("*.bag"))) == 1

"""Whole games in Debian's Chromium: by mouse, by keyboard alone, and by touch on a phone; axe-core judges each page."""

from pathlib import Path

import pytest

from tests.support.programs.processes import Program, until
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium

STUDY = "map: practice\ntemplates: practice\nrobots: 1\nrate: 6\n"

pytestmark = NEEDS_SELENIUM


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
        program = Path(__file__).with_name("hunt_in_chromium.py")
        result = seen_in_chromium(program, port, how, width, height, tmp_path, timeout=400)
        assert result["ended"], (result, server.text)
        assert not result["errors"]
        assert not result["faults"]
        assert {"start", "rooms", "dialogue", "treasure", "thanks"} <= set(result["pages"])
    finally:
        server.stop()
        server.close()
    assert len(list((tmp_path / "served").glob("*.bag"))) == 1

"""A person in Debian's Chromium comes to a study by a link, opens a second tab, and goes back to the service."""

import secrets
from pathlib import Path

from tests.support.programs.processes import Program, until
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium
from tests.support.studies.study_events import data_of
from thbridge.experiment.design.recruiting import add_codes
from thbridge.experiment.store.events import EventKind

STUDY = """\
title: In Chromium
base: {map: practice, templates: practice, robots: 1, server.port: 0}
recruiting: {codes: codes.txt, endings: {complete: 'https://service.invalid/done?pid={PROLIFIC_PID}'}}
consent_elsewhere: Participants agreed on paper.
steps:
  - {step: instructions, text: welcome.txt, name: welcome}
"""

pytestmark = NEEDS_SELENIUM


def test_a_person_comes_by_a_link_and_leaves_by_another(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "experiment.yaml").write_text(STUDY)
    (study / "welcome.txt").write_text("Please read this text.\n")
    (code,) = add_codes(study / "codes.txt", 1, secrets.randbelow)
    server = Program(tmp_path, "serve", "study", "--port", "0")
    try:
        until("the gateway", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
        port = server.text.split("127.0.0.1:")[1].split("/")[0]
        program = Path(__file__).with_name("entry_in_chromium.py")
        result = seen_in_chromium(program, port, code)
    finally:
        server.stop()
        server.close()
    assert not result["faults"]
    assert result["seen"] == {
        "address": "",
        "after reload": [],
        "ending": "https://service.invalid/done?pid=pid7",
    }
    assert len(data_of(study, EventKind.FAREWELL_READ)) == 1

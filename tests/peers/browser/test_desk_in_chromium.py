"""A researcher in Debian's Chromium sees two people, messages one of them and excludes the other."""

from pathlib import Path

from tests.support.programs.processes import Program, until
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent

STUDY = """\
title: "<script>window.pwned = 1</script> at the desk"
base: {map: practice, templates: practice, robots: 1, server.port: 0}
quota: 2
consent_elsewhere: Participants agreed on paper.
steps:
  - {step: instructions, text: welcome.md, name: welcome}
"""

pytestmark = NEEDS_SELENIUM


def test_the_researcher_messages_one_person_and_excludes_the_other(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "experiment.yaml").write_text(STUDY)
    (study / "welcome.md").write_text(
        "# Welcome\n\nRead this. <img src=x onerror='window.pwned = 1'> [x](javascript:pwned=1)\n"
    )
    server = Program(tmp_path, "serve", "study", "--port", "0")
    try:
        until("the gateway", lambda: "/desk#" in server.text or server.process.poll() is not None, [server])
        port = server.text.split("127.0.0.1:")[1].split("/")[0]
        key = server.text.split("/desk#")[1].split()[0]
        program = Path(__file__).with_name("desk_in_chromium.py")
        result = seen_in_chromium(program, port, key, tmp_path)
    finally:
        server.stop()
        server.close()
    assert not result["faults"]
    assert not result["errors"]
    (excluded, messaged) = result["seen"].pop("people")
    assert result["seen"] == {
        "address": "desk",
        "cells": 10,
        "cookie": "",
        "message": '<img src=x onerror="window.pwned = 1">Please continue.',
        "still reads": True,
        "lines of codes": [1],
        "closed": True,
        "foreign": [0, 0],
        "pwned": [None, None],
        "other reads": True,
    }
    entries = ExperimentFolder(study).entries()
    logged = {each.event.kind: each.event for each in entries if isinstance(each, LoggedEvent)}
    assert logged[EventKind.MESSAGE_SENT].participant == messaged
    assert logged[EventKind.MESSAGE_CLOSED].participant == messaged
    assert logged[EventKind.RUN_EXCLUDED].participant == excluded
    assert (logged[EventKind.RUN_EXCLUDED].data or {})["reason"] == "asked <svg onload='pwned = 1'> a friend"

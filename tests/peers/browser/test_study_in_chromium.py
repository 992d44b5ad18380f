"""A whole study in Debian's Chromium: by mouse, keyboard alone, and touch on a phone; axe-core judges each page."""

import csv
import json
from pathlib import Path

import pytest

from tests.support.programs.processes import Program, run_thbridge, until
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.recordings import journal_of

STUDY = """\
title: A whole study
seed: 3
base: {map: practice, templates: everyday-things, robots: 2, rate: 6, server.port: 0, dialogue.condition: collaborator}
quota: 2
steps:
  - {step: instructions, text: welcome.md}
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice, at_least: {moves: 1}}
  - {step: check, form: understood.yaml, name: understood, attempts: 2}
  - {step: trial, name: game, max_seconds: 1200}
  - {step: pause}
  - {step: form, form: after.yaml, name: after}
  - {step: debrief, text: debrief.md, results: true}
"""
FILES = {
    "welcome.md": "# Robots that argue\n\nYou play with *two* robots.\n\n- Press a room.\n- Talk with the robot.\n",
    "consent.txt": "We record what you do.\n",
    "debrief.md": "# What it was about\n\nIt was about robots that argue.\n",
    "understood.yaml": """\
title: Before the game
items:
  - {id: decides, text: Who decides?, scale: choice, options: [you, the robot, both together], correct: both together}
""",
    "after.yaml": """\
title: After the game
instructions: These questions are about the game.
page: 5
items:
  - {id: trust, text: I trusted the robots., low: not at all, high: completely, not_applicable: true}
  - {id: blame, text: It was my fault., points: 5, labels: [never, rarely, sometimes, often, always]}
  - {id: pleasure, scale: differential, low: boring, high: exciting, not_applicable: true}
  - {id: effort, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99, unit: years}
  - {id: again, text: Would you play again?, scale: choice, options: ['yes', 'no', perhaps]}
  - {id: helped, text: What helped you?, scale: choice, options: [the map, the reasons, the sound], several: true}
  - {id: why, text: Why?, scale: text}
  - {id: other, text: Anything else?, scale: text, required: false}
  - {id: quick, text: What is 17 times 23?, scale: number, maximum: 1000, seconds: 2}
""",
}
AGAIN = "They gave reasons, 'why' and 'why not'."
PAGES = [
    {"decides": "you"},
    {"decides": "both together"},
    {"trust": 6, "blame": 2, "pleasure": "not applicable", "effort": 0.7, "age": 41},
    {"again": "perhaps", "helped": ["the map", "the reasons"], "why": AGAIN, "other": None},
    {"quick": "timed out"},
]
EXPORTED = {
    **{"other": "", "quick": ""},
    **{"trust": "6", "blame": "2", "pleasure": "not applicable", "age": "41", "again": "perhaps"},
    **{"helped": "the map; the reasons", "why": AGAIN},
}
PARTS = {
    *(
        "Robots that argue",
        "Before you take part",
        "Once more",
        "form decides",
        "form trust",
        "form again",
        "form quick",
        "sheet 2",
        "end",
    ),
    *("practice rooms", "practice is done", "rules", "question", "trial dialogue", "trial treasure", "trial is over"),
}
"""Parts of the names of pages that a person needs to see."""
ONCE = (EventKind.RUN_BEGUN, EventKind.CONSENT_ANSWERED, EventKind.PRACTICE_PLAYED, EventKind.GAME_PLAYED)
LOSSES = {EventKind.GAME_BROKEN_OFF, EventKind.RECORDING_CUT_OFF, EventKind.ABSENT}

pytestmark = [
    pytest.mark.slow,
    NEEDS_SELENIUM,
]


@pytest.mark.parametrize(
    ("how", "width", "height"), [("mouse", 1280, 800), ("keyboard", 1024, 768), ("touch", 390, 844)]
)
def test_a_person_takes_part_in_a_whole_study(how: str, width: int, height: int, tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "experiment.yaml").write_text(STUDY)
    for name, text in FILES.items():
        (study / name).write_text(text)
    server = Program(tmp_path, "serve", "study", "--port", "0")
    try:
        until("the gateway", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
        port = server.text.split("127.0.0.1:")[1].split("/")[0]
        program = Path(__file__).with_name("study_in_chromium.py")
        result = seen_in_chromium(program, port, how, width, height, json.dumps(PAGES), tmp_path)
    finally:
        server.stop()
        server.close()
    assert result["faults"] == []
    assert result["errors"] == []
    assert len(result["code"]) > 0
    seen = " ".join(result["pages"])
    for part in PARTS:
        assert part in seen
    assert run_thbridge(tmp_path, "study", "export", "study", "--to", "export").returncode == 0
    _assert_everything_is_exported(tmp_path / "export" / "data", result["marks"]["effort"])
    _assert_the_log_is_whole(study)


def _assert_everything_is_exported(export: Path, effort: float) -> None:
    (participant,) = _rows(export, "participants")
    assert [participant[each] for each in ("front_end", "state", "agreed")] == ["browser", "complete", "true"]
    answers = _rows(export, "answers")
    assert [(row["attempt"], row["answer"], row["right"]) for row in answers if row["name"] == "understood"] == [
        ("1", "you", "false"),
        ("2", "both together", "true"),
    ]
    after = {row["item"]: row for row in answers if row["name"] == "after"}
    assert 60.0 <= effort <= 80.0
    assert {name: row["answer"] for name, row in after.items()} == {**EXPORTED, "effort": f"{effort:.0f}"}
    assert [name for name, row in after.items() if row["timed_out"] == "true"] == ["quick"]
    games = _rows(export, "DialogueGames")
    assert "disagreement" in {row["end"] for row in games}
    assert "robot" in {row["gave_in"] for row in games}, "no robot was persuaded"
    (trial,) = (row for row in _rows(export, "trials") if row["kind"] == "trial")
    assert [trial[each] for each in ("finished", "identified")] == ["true", "1"]


def _rows(export: Path, table: str) -> list[dict[str, str]]:
    (path,) = export.glob(f"*_description-{table}_data.csv")
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def _assert_the_log_is_whole(study: Path) -> None:
    events = [each.event for each in ExperimentFolder(study).entries() if isinstance(each, LoggedEvent)]
    kinds = [event.kind for event in events]
    assert [kinds.count(kind) for kind in ONCE] == [1] * len(ONCE)
    assert kinds.count(EventKind.STEP_BEGUN) == kinds.count(EventKind.STEP_ENDED) == 9, "eight steps, one of them twice"
    assert not LOSSES.intersection(kinds)
    assert [event.data["outcome"] for event in events if event.kind == EventKind.RUN_ENDED] == [RunState.COMPLETE]
    (played,) = (event.data for event in events if event.kind == EventKind.GAME_PLAYED)
    assert read_journal(journal_path(journal_of(study / str(played["bag"])), 1)).state.ended is not None

"""Studies and a recording that an older program wrote (`studies_of_0_1`, by 0.1.0 as studies with people began) go on.

Whatever changes: they run as they are, or the message says what to change.
"""

import re
import shutil
import sqlite3
from pathlib import Path

import pandas as pd
import pytest

from tests.support.programs.commands import invoke, output_of
from tests.support.studies.kiosk_without_screen import RehearsedGames, WindowOfTwo
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import Tombstone

OLD = Path(__file__).parent / "studies_of_0_1"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    shutil.copytree(OLD, tmp_path / "old")
    return tmp_path / "old"


@pytest.fixture
def study(old: Path) -> Path:
    """A study with two people who have taken part."""
    return old / "with-people"


def refused(*arguments: object) -> str:
    done = invoke(*arguments)
    assert done.exit_code == 2, done.output
    return " ".join(done.output.split())


def change(file: Path, was: str, now: str) -> None:
    text = file.read_text()
    assert was in text
    file.write_text(text.replace(was, now))


def test_a_study_file_with_every_key_of_then_has_no_faults_and_is_played(old: Path, tmp_path: Path) -> None:
    assert "no faults" in output_of("study", "check", old / "study.yaml")
    bag = tmp_path / "now.bag"
    short = ("--headless", "--rate", "0", "--max-seconds", "1", "--no-report", "--bag", bag)
    invoke("play", old / "study.yaml", *short)
    assert bag.exists()


def test_a_recorded_session_is_read_and_replayed(old: Path) -> None:
    assert "/thbridge/session" in output_of("bag", "info", old / "hunt.bag")
    said = invoke("replay", old / "hunt.bag").output
    # Another release may give something else for a seed; then it says where, and with what it was recorded.
    is_same = "are the same, bit for bit" in said
    assert is_same or ("First difference:" in said and "Recorded with other versions" in said), said


@pytest.mark.slow
def test_a_study_with_people_goes_on_where_it_was(study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "no faults" in output_of("study", "check", study)
    status = output_of("study", "status", study)
    assert "2 of 2 runs complete" in status
    people = re.findall(r"P-\w{5}", status)
    for name, instead in (
        ("WindowProcess", lambda *_: WindowOfTwo(people=1)),
        ("StudyGames", RehearsedGames),
        ("why_no_window", lambda: None),
    ):
        monkeypatch.setattr(f"ui.commands.study.run.{name}", instead)
    change(study / "experiment.yaml", "quota: 2", "quota: 3")
    output_of("study", "run", study)
    output_of("study", "export", study, "--to", tmp_path / "tables")
    table = pd.read_parquet(tmp_path / "tables" / "tables" / "participants.parquet")
    assert table.state.tolist() == ["complete"] * 3
    assert table.participant.tolist()[:2] == people
    output_of("study", "withdraw", study, people[0], "--yes")
    assert sum(isinstance(entry, Tombstone) for entry in read_log(study / "store" / "log")) > 100
    assert people[0] not in (tmp_path / "tables" / "manifest.json").read_text()


@pytest.mark.slow
def test_groups_go_on_where_they_were(old: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = old / "groups"
    said = " ".join(output_of("study", "check", study).split())
    assert "accepted with its faults, because people have taken part; 4 people in 2 groups" in said
    # No release ever showed this step.
    assert "A new study would be refused" in said and "feelings.calm is not an item with one chosen answer" in said
    assert "P-K2YEQ" in output_of("study", "status", study)
    for name, instead in (
        ("WindowProcess", lambda *_: WindowOfTwo(people=3)),
        ("StudyGames", RehearsedGames),
        ("why_no_window", lambda: None),
    ):
        monkeypatch.setattr(f"ui.commands.study.run.{name}", instead)
    output_of("study", "run", study)
    output_of("study", "export", study, "--to", tmp_path / "tables")
    people = pd.read_parquet(tmp_path / "tables" / "tables" / "participants.parquet").set_index("participant")
    ended = {"P-6MXVT": "complete", "P-EV85H": "declined", "P-2YWEF": "excluded", "P-NTT2R": "left"}
    assert people.state[list(ended)].to_dict() == ended
    assert people.state[["P-GASV9", "P-K2YEQ"]].tolist() == ["complete"] * 2
    trials = pd.read_parquet(tmp_path / "tables" / "tables" / "trials.parquet")
    assert trials[trials.participant == "P-GASV9"].score.count() == 2


@pytest.mark.parametrize(
    ("was", "now", "told"),
    [
        ("title: Robots", "title: All robots", ""),
        ("{step: trial, each", "{step: trial, name: game, each", "was trial_5, and is game"),
        ("collaborator", "adviser", "met dialogue.condition=collaborator, which is now dialogue.condition=adviser"),
        ("order: balanced", "order: fixed", "had other conditions, or another order of conditions"),
        ("  - {step: debrief, text: texts/debrief.txt}\n", "", "is in step 12 of 11"),
    ],
)
def test_a_changed_file_that_does_not_fit_its_log_is_told(study: Path, was: str, now: str, told: str) -> None:
    file = study / "experiment.yaml"
    change(file, was, now)
    if told == "":
        assert "experiment.yaml was changed" in output_of("study", "status", study)
        return
    for command in (("status", study), ("export", study, "--to", study / "tables"), ("withdraw", study, "P-6MXVT")):
        said = refused("study", *command)
        assert f"{file}: does not fit what is in the log: " in said
        assert told in said
        assert "Restore the files with which people took part" in said


def test_an_item_that_people_answered_and_that_is_gone_is_told(study: Path) -> None:
    change(study / "understood.yaml", "id: costs", "id: price")
    assert "which understood does not have" in refused("study", "export", study, "--to", study / "tables")


def test_a_log_of_another_layout_names_the_release_to_use(study: Path) -> None:
    with sqlite3.connect(study / "store" / "log") as database:
        database.execute("PRAGMA user_version=9")
    said = refused("study", "status", study)
    assert "the log has layout 9" in said
    assert "Use the release of thbridge that ran the study" in said

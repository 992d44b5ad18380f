"""What people do at the kiosk is in the tables of an export: consent, looking away, pasted text, split recordings."""

import hashlib
from datetime import datetime
from pathlib import Path

import pandas as pd
import pytest

from tests.support.studies.kiosk_without_screen import Laboratory, Person
from thbridge.experiment.export.tables import game_tables, log_tables, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.recordings import notes_on_leftovers
from thbridge.recording.bag.options import RecordingFormat
from ui.hosting.kiosk.games import StudyGames
from ui.model.kiosk import FocusNews, FormToFill, ItemNews, WentOn

STUDY = """\
title: A small study
base: {map: practice, templates: practice, robots: 1, rate: 50, server.port: 0, recording.split_duration: 1}
quota: 2
steps:
  - {step: consent, text: consent.txt}
  - {step: trial, name: first, max_seconds: 3}
  - {step: form, form: final.yaml, name: final}
"""


class Distracted(Person):
    """Somebody who looks away while they fill in a form, and pastes an answer."""

    def react(self, shown):
        if isinstance(shown, FormToFill):
            yield FocusNews(False, 1)
            yield FocusNews(True, 2)
            yield ItemNews(shown.page, "why", "shown", 3)
            yield ItemNews(shown.page, "why", "pasted", 4, None, 120)
            yield FocusNews(False, 5)
            yield FocusNews(True, 6)
            yield from (each for each in super().react(shown) if not isinstance(each, WentOn))
            yield WentOn(shown.page)
        else:
            yield from super().react(shown)


@pytest.mark.parametrize("form", RecordingFormat)
def test_consent_looking_away_and_pasting_are_in_the_tables_and_split_recordings_are_whole(
    tmp_path: Path, form: RecordingFormat
) -> None:
    study = STUDY.replace("robots: 1", f"robots: 1, recording.format: {form}")
    laboratory, folder = Laboratory(tmp_path, study), ExperimentFolder(tmp_path)
    laboratory.games = StudyGames(folder, laboratory.design)
    laboratory.run(Distracted())
    laboratory.run(Person(agrees=False))
    entries = folder.entries()
    records = records_of(laboratory.design, entries, folder.root)
    tables = {table.name: pd.DataFrame(table.rows) for table in log_tables(records)}

    agreed, declined = tables["participants"].to_dict("records")
    assert (agreed["agreed"], agreed["counts"], agreed["state"]) == (True, True, "complete")
    assert (declined["agreed"], declined["counts"], declined["state"]) == (False, False, "declined")
    assert declined["reason"] == "did not agree"
    shown = hashlib.sha256((tmp_path / "consent.txt").read_bytes()).hexdigest()
    assert agreed["consent_sha256"] == declined["consent_sha256"] == shown
    for person in (agreed, declined):
        assert person["began"] <= person["agreed_at"]
        datetime.fromisoformat(person["agreed_at"])

    away = tables["steps"].set_index("name").loc["final"]
    assert away.away == 2
    assert 0.0 < away.away_s < away.duration_s
    assert (tables["steps"].set_index("name").away.drop("final") == 0).all()
    pasted = tables["answers"].set_index("item")["pasted"]
    assert pasted.to_dict() == {"line": 0, "age": 0, "why": 120}

    (trial,) = tables["trials"].to_dict("records")
    parts = sorted(folder.recordings.rglob(f"*.{form}"))
    assert [part.name for part in parts[:2]] == [f"step-2_0.{form}", f"step-2_1.{form}"]
    assert (trial["recording"], Path(trial["bag"]).name) == ("as recorded", f"step-2.{form}")
    assert not any(isinstance(piece, str) for piece in game_tables(records))
    assert [*notes_on_leftovers(folder, Progress(laboratory.design).after(entries), entries)] == []
    parts[1].unlink()
    assert str(records_of(laboratory.design, entries, folder.root).trials[0].recording) == "changed"

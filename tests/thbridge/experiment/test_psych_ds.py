"""Exports are datasets as Psych-DS asks for them, with games and without, and what would not be one is noticed."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import WITH_GAMES
from tests.support.studies.rehearsed_studies import rehearse
from tests.thbridge.experiment.psych_ds_rules import problems
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.rehearsal.people import SimulatedPeople


@pytest.fixture(scope="module")
def exports(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Path]:
    """Exports of a rehearsal, by whether games were played."""
    made = {}
    for plays in (True, False):
        people = SimulatedPeople(drop_out=0.0, plays=plays)
        folder = rehearse(tmp_path_factory.mktemp("study"), people, 1, WITH_GAMES)
        made[plays] = folder.root / "exports" / "one"
        export_experiment(folder, folder.read(), folder.entries(), made[plays], {"thbridge": "1.0"}, None)
    return made


@pytest.mark.parametrize("plays", [True, False])
def test_an_export_is_a_dataset(exports: dict[bool, Path], plays: bool) -> None:
    names = {path.name.rpartition("_description-")[2] for path in (exports[plays] / "data").glob("*.csv")}
    assert ("fluency_data.csv" in names) == plays
    assert problems(exports[plays]) == []


def described(change: Callable[[dict], object]) -> Callable[[Path], None]:
    def damage(root: Path) -> None:
        file = root / "dataset_description.json"
        whole = json.loads(file.read_text())
        change(whole)
        file.write_text(json.dumps(whole))

    return damage


def a_file(ending: str, change: Callable[[Path], object]) -> Callable[[Path], None]:
    return lambda root: change(next(path for path in (root / "data").iterdir() if path.name.endswith(ending)))


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda root: (root / "dataset_description.json").write_text("{"), "no JSON"),
        (described(lambda whole: whole.update({"@context": "https://example.org"})), "not of schema.org"),
        (described(lambda whole: whole.update({"@type": "Thing"})), "no Dataset"),
        (described(lambda whole: whole.pop("schemaVersion")), "lacks schemaVersion"),
        (described(lambda whole: whole["variableMeasured"].append("shoe size")), "shoe size is no column"),
        (described(lambda whole: whole["variableMeasured"][0].update(colour="red")), "colour is nothing"),
        (lambda root: (root / "CHANGES.md").unlink(), "no CHANGES"),
        (lambda root: shutil.rmtree(root / "data"), "no data files"),
        (a_file("steps_data.csv", lambda path: path.rename(path.with_name("steps.csv"))), "no name of keywords"),
        (a_file("steps_data.csv", lambda path: path.write_text("")), "no header"),
        (a_file("steps_data.csv", lambda path: path.write_text(path.read_text() + "\n")), "has 0 values"),
        (
            a_file("steps_data.csv", lambda path: path.write_text(path.read_text().replace("outcome", "end", 1))),
            "a column end that nothing describes",
        ),
        (a_file("steps_data.json", lambda path: path.write_text("[]")), "no JSON"),
    ],
)
def test_what_is_no_dataset_is_noticed(
    exports: dict[bool, Path], tmp_path: Path, damage: Callable[[Path], None], told: str
) -> None:
    shutil.copytree(exports[False], tmp_path / "export")
    damage(tmp_path / "export")
    assert any(told in each for each in problems(tmp_path / "export"))

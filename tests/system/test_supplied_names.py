"""A name that a person, a file or another program supplied leads nowhere else, in each place where it becomes a path.

docs/explanation/security.md lists these places. What a place does with a file of its own, its own tests say.
"""

import hashlib
import json
import os
import random
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.participants import play_a_game
from thbridge.analysis.export.exporting import table_name
from thbridge.credentials import Right
from thbridge.experiment.backup import back_up
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import LONGEST_TITLE
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.export.manifest import exports_with
from thbridge.experiment.export.psych_ds import file_name
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import Clocks, EventKind
from thbridge.experiment.withdrawal import NobodyWithdraws, plan_withdrawal
from thbridge.files.disk.inside import LONGEST_NAME, path_inside
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import read_grid
from thbridge.files.keys.key_ring import KeyRing
from thbridge.files.resources import shipped
from thbridge.files.tables.table_files import Column, TableFiles, TableFormat
from thbridge.files.template_files import read_template_set
from thbridge.files.treasure_files import read_treasures_yaml
from thbridge.files.word_files import SHIPPED_LANGUAGES, read_language
from thbridge.recording.bag.ros2 import as_ros1
from thbridge.study.study_file import load_study
from ui.model.template_set.draft import template_draft

STUDY = "title: x\nquota: 3\nsteps:\n  - {step: trial}\n"
OUTSIDE = "outside"
LINK = "link"
"""Name of a link in each folder; it leads to the folder outside, and with a suffix to a file in it."""
SECRET = b"\x89PNG secret"
NAMES = {
    "up": f"../{OUTSIDE}",
    "up to a file": f"../{OUTSIDE}/secret",
    "parent": "..",
    "itself": ".",
    "absolute": "",  # filled in where the test knows its folder
    "empty": "",
    "blank": " \t",
    "NUL": f"a\0/../../{OUTSIDE}",
    "control": "a\x1b[2J",
    "too long": "x" * (LONGEST_NAME + 1),
    "link": LINK,
    "link to a file": f"{LINK}.file",
}

HARMLESS = {"os.symlink", "os.listdir", "os.scandir"}

touched: list[str] | None = None


def _heed(event: str, arguments: tuple[object, ...]) -> None:
    """Note the paths that are opened, removed or renamed; an audit hook stays for the life of its process."""
    kind = event.partition(".")[0]
    if touched is None or kind not in {"open", "os", "shutil", "sqlite3"} or event in HARMLESS:
        return
    paths = (each for each in arguments if isinstance(each, str | bytes) and b"\0" not in os.fsencode(each))
    touched.extend(os.path.realpath(os.fsdecode(path)) for path in paths)


sys.addaudithook(_heed)


@contextmanager
def untouched(folder: Path) -> Iterator[None]:
    """Fail where something in a folder is opened, changed or deleted meanwhile."""
    global touched  # noqa: PLW0603 - hooks are global
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    touched = []
    try:
        yield
        seen = touched
    finally:
        touched = None
    assert not [path for path in seen if Path(path).is_relative_to(folder)]
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def linked(folder: Path, outside: Path) -> Path:
    """Make a folder with links that lead outside."""
    folder.mkdir(parents=True, exist_ok=True)
    for link, target in ((LINK, outside), (f"{LINK}.file", outside / "secret")):
        (folder / link).symlink_to(target)
    return folder


def refused_if(is_so: bool) -> None:
    if is_so:
        raise BadFile(Path(), "refused", "Take another")


def of_person(root: Path, outside: Path, name: str) -> None:
    study = ExperimentFolder(root / "study")
    linked(study.recordings, outside)
    for path in (study.recordings_of, lambda name: study.bag(name, 1)):
        path(name)


def of_export(root: Path, outside: Path, name: str) -> None:
    study = ExperimentFolder(root / "study")
    linked(study.root / "exports", outside)
    study.export(name)


def of_event(root: Path, outside: Path, name: str) -> None:
    """A log says where a recording is: exports and backups look there."""
    study = ExperimentFolder(root / "study")
    shutil.copytree(root / "played", study.root)
    linked(study.recordings, outside)
    with ExperimentLog(study.log) as log:
        conductor = Conductor(study.read(), log, lambda: Clocks("2026-01-02T09:00:00Z", 0), random.Random(7).randrange)
        person = conductor.admit().participant
        digest = hashlib.sha256(SECRET).hexdigest()
        step = conductor.begin(person)
        data = {"bag": f"recordings/{name}", "sha256": digest}
        conductor.tell(EventKind.GAME_PLAYED, person, step, data, "program")
        conductor.end(person, step)
    written = export_experiment(study, study.read(), study.entries(), root / "export", {}, ())
    sentences = [*back_up(study, root / "backup"), *(note for note in written.notes if person in note)]
    refused_if(len(sentences) >= 2)


def of_withdrawal(root: Path, outside: Path, name: str) -> None:
    """What a person types as the id or code of who withdraws."""
    study = ExperimentFolder(root / "study")
    shutil.copytree(root / "played", study.root)
    linked(study.recordings, outside)
    with pytest.raises(NobodyWithdraws):
        plan_withdrawal(study, study.read(), name)
    study.recordings_of(name)


def of_list(root: Path, outside: Path, name: str) -> None:
    """A list of where exports are, which may be anywhere else: only by an absolute path."""
    study = ExperimentFolder(root / "study")
    study.log.parent.mkdir(parents=True)
    (study.log.parent / "exports.json").write_text(json.dumps([name]))
    refused_if(name.startswith((str(outside), LINK, ".")) and name != "..")
    exports_with(study, "P-1")


def of_picture(root: Path, outside: Path, name: str) -> None:
    folder = linked(root / "set" / "pictures", outside).parent
    shutil.copytree(shipped().root / "templates" / "practice", folder, dirs_exist_ok=True)
    treasure = f'  - {{name: "it", image: {json.dumps(name)}, points: 1}}\n'
    (folder / "treasures").unlink(missing_ok=True)
    (folder / "treasures.yaml").write_text(f"rooms: 8\ntreasures:\n{treasure}")
    refused_if(bool(template_draft(folder, {}, {}).faults))
    read_template_set(folder)
    read_treasures_yaml(folder / "treasures.yaml")


def of_language(root: Path, outside: Path, name: str) -> None:
    read_language((SHIPPED_LANGUAGES, linked(root / "words", outside)), name)


def of_fallback(root: Path, outside: Path, name: str) -> None:
    folder = linked(root / "words", outside)
    (folder / "xx").mkdir()
    (folder / "xx" / "x.yaml").write_text(f"language: {{title: X, falls_back_on: {json.dumps(name)}}}\n")
    read_language((SHIPPED_LANGUAGES, folder), "xx")


def of_key(root: Path, outside: Path, name: str) -> None:
    folder = linked(root / "keys", outside)
    (folder / f"{LINK}.key").symlink_to(outside / "secret")
    ring = KeyRing(folder, lambda: "2026-01-02T09:00:00Z")
    ring.add(name, [Right.WATCH], "s" * 16, None)


def of_table(root: Path, outside: Path, name: str) -> None:
    linked(root / "tables", outside)
    for suffix in TableFormat:
        (root / "tables" / f"{LINK}.{suffix}").symlink_to(outside / "secret")
    for kind in TableFormat:
        files = TableFiles(root / "tables", [kind])
        files.write(name, [Column("x", "float64")], [np.zeros(1)])
        files.finish(lambda *_: None)
        refused_if((root / "tables" / f"{name}.{kind}").is_file())  # in the folder, with dots and a suffix


def of_ros2(root: Path, outside: Path, name: str) -> None:
    folder = linked(root / "ros2", outside)
    told = {
        "version": 5,
        "storage_identifier": "sqlite3",
        "compression_format": "zstd",
        "compression_mode": "FILE",
        "relative_file_paths": [name],
        "topics_with_message_count": [],
    }
    (folder / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": told}))
    as_ros1(folder)


def of_map_image(root: Path, outside: Path, name: str) -> None:
    """An image of a map may be anywhere, so only what is no path at all is refused."""
    refused_if((OUTSIDE in name and "\0" not in name) or name.startswith(LINK))
    folder = root / "map"
    folder.mkdir()
    rest = "resolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    (folder / "map.yaml").write_text(f"image: {json.dumps(name)}\n{rest}")
    read_grid(folder / "map.yaml")


def of_study_path(root: Path, outside: Path, name: str) -> None:
    """Paths in a study file may lead anywhere, so only what is no path at all is refused."""
    refused_if((OUTSIDE in name and "\0" not in name) or name in ("..", ".") or name.startswith(LINK))
    (root / "study.yaml").write_text(f"participant: {{consent: {json.dumps(name)}}}\n")
    load_study(root / "study.yaml")


def of_resource(root: Path, outside: Path, name: str) -> None:
    """Maps and templates are found by name; what has a slash is a path, which may lead anywhere."""
    refused_if("/" in name and "\0" not in name)
    shipped().find("templates", name, linked(root / "beside", outside))


PLACES: dict[str, Callable[[Path, Path, str], None]] = {
    place.__name__.removeprefix("of_"): place
    for place in (
        of_person,
        of_export,
        of_event,
        of_withdrawal,
        of_list,
        of_picture,
        of_language,
        of_fallback,
        of_key,
        of_table,
        of_ros2,
        of_map_image,
        of_study_path,
        of_resource,
    )
}


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study in which somebody has played."""
    study = ExperimentFolder(tmp_path_factory.mktemp("played") / "study")
    study.log.parent.mkdir(parents=True)
    write_experiment(study.root, STUDY)
    play_a_game(study)
    return study.root


@pytest.mark.parametrize("place", PLACES)
def test_a_supplied_name_leads_nowhere_else(place: str, played: Path, tmp_path: Path) -> None:
    for number, (what, written) in enumerate(NAMES.items()):
        root, outside = tmp_path / str(number), tmp_path / str(number) / OUTSIDE
        (outside / "xx").mkdir(parents=True)
        (outside / "secret").write_bytes(SECRET)
        (outside / "xx" / "x.yaml").write_text("language: {title: Secret, falls_back_on: en}\n")
        if place in ("event", "withdrawal"):
            shutil.copytree(played, root / "played")
        name = str(outside / "secret") if what == "absolute" else written
        with untouched(outside), pytest.raises(BadFile) as refused:
            PLACES[place](root, outside, name)
        assert str(refused.value).isprintable(), what


@pytest.mark.parametrize("text", [*NAMES.values(), "/", "ä" * 400, "A title " * 60])
def test_titles_and_topics_become_names_that_files_can_have(text: str, tmp_path: Path) -> None:
    for name in (f"{table_name(text)}.parquet", file_name(text, "dialogue_games")):
        assert path_inside(tmp_path, name).parent == tmp_path
        (tmp_path / name).with_suffix(".json").touch()


def test_a_long_title_is_refused_by_the_check(tmp_path: Path) -> None:
    for title, is_right in (("x" * LONGEST_TITLE, True), ("x" * (LONGEST_TITLE + 1), False)):
        write_experiment(tmp_path, f"title: {title}\nquota: 3\nsteps:\n  - {{step: trial}}\n")
        if is_right:
            ExperimentFolder(tmp_path).read()
        else:
            with pytest.raises(BadFile, match="title"):
                ExperimentFolder(tmp_path).read()

"""People who take part in studies, and the traces that they leave."""

import hashlib
import random
import re
from pathlib import Path

import pandas as pd

from tests.support.programs.commands import output_of
from tests.support.studies.kiosk_without_screen import Laboratory, Person
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind, LoggedEvent


def play_a_game(folder: ExperimentFolder) -> str:
    """Let a person play a recorded game; return their id."""
    with ExperimentLog(folder.log) as log:
        draw = random.Random(len(log.read())).randrange
        conductor = Conductor(folder.read(), log, lambda: Clocks("2026-01-02T09:00:00Z", 0), draw)
        participant = conductor.admit().participant
        bag = folder.bag(participant, 1)
        bag.parent.mkdir(parents=True)
        bag.write_bytes(b"a game")
        data = {"bag": bag.relative_to(folder.root).as_posix(), "sha256": hashlib.sha256(b"a game").hexdigest()}
        conductor.tell(EventKind.GAME_PLAYED, participant, conductor.begin(participant), data, "program")
    return participant


def people(study: Path) -> list[str]:
    return re.findall(r"^  (P-\w+)  ", output_of("study", "status", study), re.MULTILINE)


def traces(root: Path, words: list[str]) -> list[str]:
    """Return a sentence for each word found in a file below a folder: in its name, its bytes or its table."""
    found = []
    for path in root.rglob("*"):
        inside = path.read_bytes() if path.is_file() else b""
        if path.suffix == ".parquet":
            inside += pd.read_parquet(path).to_csv().encode()
        found += [f"{word} in {path}" for word in words if word in path.name or word.encode() in inside]
    return found


STUDY = """\
title: A small study
base: {map: practice, templates: practice, robots: 1, server.port: 0}
quota: 9
steps:
  - {step: consent, text: consent.txt}
  - {step: form, form: final.yaml, name: final}
"""


def another_person(study: Path, why: str) -> str:
    """Let another person take part in a study with a recorded game; return their id."""
    log = study / "store" / "log"
    before = participants(log) if log.exists() else set()
    Laboratory(study, STUDY).run(Person({"why": why}))
    (new,) = participants(log) - before - {""}
    (study / "recordings" / new).mkdir(parents=True)
    (study / "recordings" / new / "step-9.bag").write_bytes(f"a game of {new}".encode())
    return new


def participants(log: Path) -> set[str]:
    return {entry.event.participant for entry in read_log(log) if isinstance(entry, LoggedEvent)}

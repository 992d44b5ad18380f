"""Logs with right digests and odd contents: no command ends in a traceback, reads without bounds or never ends."""

import hashlib
import json
import os
import shutil
import sqlite3
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import cache
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke
from tests.support.project import ROOT
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.tables import records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.decoding import LARGEST_EVENT
from thbridge.experiment.store.event_log import LARGEST_LOG, ExperimentLog, read_log
from thbridge.files.errors import BadFile
from ui.sources.experiment import ExperimentSource

OLDER = ROOT / "tests" / "system" / "studies_of_0_1" / "with-people"
NOW = "2026-01-02T12:00:00Z"
TABLE = """
CREATE TABLE events (
    sequence INTEGER PRIMARY KEY,
    salt BLOB,
    content TEXT,
    digest BLOB NOT NULL,
    chain BLOB NOT NULL
) STRICT
"""
NUMBERS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"

Contents = list[bytes]
Edit = Callable[[Contents], None]


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A study in which people took part."""
    return Path(shutil.copytree(OLDER, tmp_path / "study"))


def contents_of(study: Path) -> Contents:
    with closing(sqlite3.connect(study / "store" / "log")) as database:
        rows = database.execute("SELECT content FROM events ORDER BY sequence").fetchall()
    return [content.encode() for (content,) in rows]


def write_log(study: Path, contents: Sequence[bytes], table: Sequence[str] = (TABLE,)) -> None:
    """Write a log with right digests, chain and head."""
    log, chain = study / "store" / "log", hashlib.sha256(b"thbridge experiment log 1").digest()
    log.unlink()
    with closing(sqlite3.connect(log)) as database:
        for statement in ("PRAGMA application_id=1952998776", "PRAGMA user_version=1", *table):
            database.execute(statement)
        for number, content in enumerate(contents, start=1):
            salt = number.to_bytes(16, "big")
            digest = hashlib.sha256(salt + content).digest()
            chain = hashlib.sha256(chain + digest).digest()
            row = (number, salt, content, digest, chain)
            database.execute("INSERT INTO events VALUES (?, ?, CAST(? AS TEXT), ?, ?)", row)
        database.commit()
    line = f"{len(contents)} {chain.hex()}"
    (study / "store" / "log-head").write_text(f"{line} {hashlib.sha256(line.encode()).hexdigest()}\n")


@cache
def design() -> ExperimentDesign:
    return ExperimentFolder(OLDER).read()


def refused(study: Path) -> BadFile:
    """The fault with which tables and the state of all runs are refused."""
    with pytest.raises(BadFile) as refusal:
        records_of(design(), read_log(study / "store" / "log"), study)
    return refusal.value


def first(contents: Contents, kind: str) -> int:
    return next(number for number, content in enumerate(contents) if json.loads(content)["kind"] == kind)


def of_event(kind: str, /, **keys: object) -> Edit:
    """Set keys of the first event of a kind; None of `...` deletes one."""

    def edit(contents: Contents) -> None:
        number = first(contents, kind)
        contents[number] = json.dumps(_set(json.loads(contents[number]), keys)).encode()

    return edit


def of_data(kind: str, /, **keys: object) -> Edit:
    """Set keys in the data of the first event of a kind, or delete them by `...`."""

    def edit(contents: Contents) -> None:
        number = first(contents, kind)
        event = json.loads(contents[number])
        contents[number] = json.dumps({**event, "data": _set(event["data"], keys)}).encode()

    return edit


def _set(values: dict[str, object], keys: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in {**values, **keys}.items() if value is not ...}


def further(kind: str, data: object, /, **keys: object) -> Edit:
    """Append an event of the first person."""

    def edit(contents: Contents) -> None:
        event = json.loads(contents[first(contents, "run-begun")])
        contents.append(json.dumps({**event, "kind": kind, "data": data, **keys}).encode())

    return edit


def as_text(text: bytes) -> Edit:
    """Put a text in the place of the first event of a person."""

    def edit(contents: Contents) -> None:
        contents[first(contents, "step-begun")] = text

    return edit


def replaced(old: bytes, new: bytes) -> Edit:
    def edit(contents: Contents) -> None:
        number = first(contents, "step-begun")
        assert old in contents[number]
        contents[number] = contents[number].replace(old, new, 1)

    return edit


def nested(levels: int) -> object:
    value: object = 1
    for _ in range(levels):
        value = [value]
    return value


ODD: dict[str, Edit] = {
    "no JSON": as_text(b"zebra"),
    "JSON that is cut off": as_text(b'{"kind": "note"'),
    "a list": as_text(b"[1, 2]"),
    "100,000 brackets": as_text(b"[" * 100_000),
    "text that is not UTF-8": as_text(b'{"kind": "\xff\xfe"}'),
    "a lone surrogate": replaced(b'"step-begun"', b'"\\ud800"'),
    "a time that is not a number": replaced(b'"simulated":null', b'"simulated":NaN'),
    "a time without an end": replaced(b'"simulated":null', b'"simulated":1e999'),
    "5000 digits": replaced(b'"cause":0', b'"cause":' + b"9" * 5000),
    "data in 500 levels": further("note", {"text": "", "more": nested(500)}),
    "a kind that is a number": of_event("step-begun", kind=5),
    "no kind": of_event("step-begun", kind=...),
    "an unknown actor": of_event("step-begun", actor="zebra"),
    "a wall time that is none": of_event("step-begun", wall="noon"),
    "a wall time of nowhere": of_event("step-begun", wall="2026-01-02T12:00:00"),
    "no wall time": of_event("step-begun", wall=None),
    "a clock beyond 64 bits": of_event("step-begun", monotonic_ns=2**70),
    "a clock with a fraction": of_event("step-begun", monotonic_ns=0.5),
    "another recorder's clock as text": of_event("step-begun", lsl="noon"),
    "a step before the first": of_event("step-begun", step=-1),
    "a step as text": of_event("step-begun", step="one"),
    "a step of none": of_event("step-begun", step=0),
    "a step beyond the last, after the end": further("step-begun", {"name": "debrief"}, step=99),
    "an item that no form has, after the end": further("item-given", {"item": "zebra", "answer": 1}, step=4),
    "a participant that is a list": of_event("step-begun", participant=[]),
    "data that is a list": of_event("step-begun", data=[]),
    "no data": of_event("step-begun", data=None),
    "a run that begins twice": further("run-begun", {"place": 0}),
    "a place as text": of_data("run-begun", place="one"),
    "a place that is true": of_data("run-begun", place=True),
    "a place before the first": of_data("run-begun", place=-1),
    "a place out of range": of_data("run-begun", place=10**30),
    "no place": of_data("run-begun", place=...),
    "an unknown end of a step": of_data("step-ended", outcome="zebra"),
    "no end of a step": of_data("step-ended", outcome=...),
    "an unknown end of a run": of_data("run-ended", outcome="zebra"),
    "a run that ends under way": of_data("run-ended", outcome="under way"),
    "an answer to nothing": of_data("item-given", item=...),
    "an item that is a list": of_data("item-given", item=[1]),
    "no answer": of_data("item-given", answer=...),
    "an answer that is an object": of_data("item-given", answer={"a": 1}),
    "an answer of 400 digits": of_data("item-given", answer=10**400),
    "a huge answer": of_data("item-given", answer=1e300),
    "a number of letters as text": further("text-pasted", {"item": "a", "characters": "many"}, step=4),
    "a game with a score beyond 64 bits": further("game-played", {"bag": "a", "score": 2**70}, step=4),
    "a game whose recording is a number": further("game-played", {"bag": 5}, step=4),
    "a recording without a name": further("recording-cut-off", {}, step=4),
    "an exclusion without a reason": further("run-excluded", {}),
    "a consent in words": further("consent-answered", {"agrees": "yes"}, step=1),
    "a withdrawal of nothing": further("withdrawn", {}),
    "a withdrawal of words": further("withdrawn", {"sequences": ["one"]}),
    "a note that is a number": further("note", {"text": 5}),
    "a seed that is a list": further("rehearsed", {"seed": []}),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_contents_are_refused_in_words(study: Path, name: str) -> None:
    contents = contents_of(study)
    ODD[name](contents)
    write_log(study, contents)
    assert len(str(refused(study))) < 800


@pytest.mark.parametrize("name", ["100,000 brackets", "no end of a step", "a place out of range", "an unknown actor"])
def test_every_command_that_reads_a_log_refuses_odd_contents_in_one_line(
    study: Path, tmp_path: Path, name: str
) -> None:
    contents = contents_of(study)
    ODD[name](contents)
    write_log(study, contents)
    for arguments in (["status"], ["export", "--to", tmp_path / "tables"], ["backup", "--to", tmp_path / "copy"]):
        done = invoke("study", arguments[0], study, *arguments[1:])
        assert isinstance(done.exception, SystemExit), done.exception
        assert (done.exit_code, done.output.count("\n")) == (2, 1), done.output
        assert "store/log: event " in done.output
    watched = ExperimentSource(ExperimentFolder(study), lambda: NOW)
    watched.poll()
    assert "store/log: event " in "".join(watched.state("").troubles)


def test_what_a_later_release_may_add_is_read(study: Path) -> None:
    contents = contents_of(study)
    further("applauded", {"hands": 2, "where": {"room": [1, None]}}, color="red")(contents)
    of_data("step-begun", mood="good")(contents)
    write_log(study, contents)
    records = records_of(design(), read_log(study / "store" / "log"), study)
    assert records.events[-1].event.kind == "applauded"


# Databases

SCHEMAS: dict[str, tuple[str, ...]] = {
    "a view over an endless query": (
        f"CREATE VIEW events AS {NUMBERS} SELECT i AS sequence, NULL AS salt, NULL AS content, NULL AS digest, "
        "NULL AS chain FROM n",
    ),
    "another table besides": (TABLE, "CREATE TABLE others (a)"),
    "a trigger": (TABLE, "CREATE TRIGGER t AFTER INSERT ON events BEGIN DELETE FROM events; END"),
    "an index": (TABLE, "CREATE INDEX i ON events (content)"),
    "a computed column": (TABLE.replace("salt BLOB", "salt BLOB AS (zeroblob(1000000000))"),),
    "no table": (),
}


@pytest.mark.parametrize("name", SCHEMAS)
def test_another_schema_is_refused(study: Path, name: str) -> None:
    write_log(study, [], SCHEMAS[name])
    assert "schema is different" in str(refused(study))


def test_an_endless_view_without_a_head_is_refused_where_it_is_opened_to_be_written(study: Path) -> None:
    write_log(study, [], SCHEMAS["a view over an endless query"])
    (study / "store" / "log-head").unlink()
    with pytest.raises(BadFile, match="schema is different"):
        ExperimentLog(study / "store" / "log")


def test_an_event_larger_than_any_is_refused(study: Path) -> None:
    contents = contents_of(study)
    further("note", {"text": "zebra " * (LARGEST_EVENT // 6)})(contents)
    write_log(study, contents)
    assert "too big" in str(refused(study))


@pytest.mark.parametrize("name", ["log", "log-wal"])
def test_a_file_larger_than_any_log_is_refused_without_reading_it(study: Path, name: str) -> None:
    with (study / "store" / name).open("ab") as file:
        file.truncate(LARGEST_LOG + 1)
    assert f"{name}: the file has more than {LARGEST_LOG} bytes" in str(refused(study))


@pytest.mark.parametrize("name", ["log", "log-head"])
def test_a_pipe_in_the_place_of_a_file_is_refused_without_waiting_for_it(study: Path, name: str) -> None:
    (study / "store" / name).unlink()
    os.mkfifo(study / "store" / name)
    assert "a pipe" in str(refused(study))


@pytest.mark.parametrize(
    "content",
    ["[]", "null", "{", "[" * 100_000, '{"digest": "a", "files": [], "versions": {}}', '{"digest": 1, "files": {}}'],
)
def test_an_odd_freeze_is_refused(study: Path, content: str) -> None:
    (study / "freeze.json").write_text(content)
    done = invoke("study", "status", study)
    assert isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == 2
    assert "freeze.json: the file is damaged or was changed" in done.output

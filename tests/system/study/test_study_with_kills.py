"""A whole study survives anything: real programs, killed again and again, and the power cut under them."""

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.project import ROOT
from tests.system.study.checks import analysed, check_recordings, check_run
from tests.system.study.power_cut import cut_power
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, LoggedEvent, NewEvent, RunState

FILES = {
    "experiment.yaml": """\
title: Robots that argue
seed: 11
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
within: {dialogue.condition: [supervisor, collaborator]}
between: {noise.preset: [none, bad wheels]}
quota: QUOTA
steps:
  - {step: consent, text: consent.txt}
  - {step: check, form: understood.yaml, attempts: 3}
  - {step: trial, each_condition: true, max_seconds: 10}
  - {step: form, form: workload, each_condition: true}
  - {step: form, form: feelings.yaml, name: feelings, each_condition: true}
  - {step: debrief, text: debrief.txt}
""",
    "rehearsal.yaml": """\
drop_out: 0.01
effects: [{score: workload, shift: 0.2, where: {dialogue.condition: collaborator}}]
""",
    "consent.txt": "We record what you do.\n",
    "debrief.txt": "It was about robots.\n",
    "understood.yaml": """\
title: Before we begin
items:
  - {id: who, text: Who decides?, scale: choice, options: [you, they], correct: you}
  - {id: played, text: Have you played before?, scale: choice, options: ['yes', 'no']}
""",
    "feelings.yaml": """\
title: How you feel
shuffle: true
page: 2
like: {scale: likert, points: 7, low: not at all, high: very much, subscale: feelings}
items:
  - {id: calm, text: I feel calm.}
  - {id: quick, text: I was quick.}
  - {id: sure, text: I felt sure.}
""",
}
HOST = """\
import sys
from pathlib import Path
from typer import Exit
from ui.commands.study.run import run_study
try:
    run_study(Path(sys.argv[1]), "system", windowed=False, desk=False, program=tuple(sys.argv[2:]))
except Exit as ended:
    sys.exit(ended.exit_code)
"""
PATIENCE = 120.0


@dataclass(frozen=True)
class Kill:
    """A kill once the log has so many events, and so many seconds later."""

    events: int
    seconds: float
    target: str


class StudyUnderFire:
    """A study in a folder with its programs: the host, which opens the window of people, and the researcher's."""

    def __init__(self, folder: Path, quota: int) -> None:
        self.folder = folder
        folder.mkdir()
        for name, content in FILES.items():
            (folder / name).write_text(content.replace("QUOTA", str(quota)))
        self.people, self.researcher = folder.parent / "people.jsonl", folder.parent / "researcher.jsonl"
        self._printed = (folder.parent / "printed.txt").open("ab")
        self._programs: dict[str, subprocess.Popen[bytes]] = {}
        for target in ("host", "researcher"):
            self._start(target)

    def _start(self, target: str) -> None:
        module, ledger = ("window", self.people) if target == "host" else ("watcher", self.researcher)
        program = [sys.executable, "-m", f"tests.system.study.{module}", str(self.folder), str(ledger)]
        self._programs[target] = subprocess.Popen(
            [sys.executable, "-c", HOST, str(self.folder), *program] if target == "host" else program,
            env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"},
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=self._printed,
            stderr=subprocess.STDOUT,
        )

    def until(self, what: str, condition: Callable[[], bool]) -> None:
        """Wait for something; a host that gave up because its window died too often is started again."""
        known, end = -1, 0.0
        while not condition():
            if (events := self.events) != known:
                known, end = events, time.monotonic() + PATIENCE
            if time.monotonic() > end:
                raise TimeoutError(f"{PATIENCE} s without an event, waiting for {what}\n{self.printed}")
            if self._programs["host"].poll() not in {None, 0}:
                self._start("host")
            assert self._programs["researcher"].poll() is None, self.printed
            time.sleep(0.01)

    @property
    def events(self) -> int:
        with suppress(FileNotFoundError):
            return int((self.folder / "store" / "log-head").read_text().split()[0])
        return 0

    @property
    def printed(self) -> str:
        return (self.folder.parent / "printed.txt").read_text(errors="replace")

    def kill(self, target: str, chance: random.Random) -> None:
        """Kill one program, or all of them at once as a power cut does, and start what nobody else does."""
        if target == "window":
            self._kill_window()
            return
        targets = ["host", "researcher"] if target == "power" else [target]
        for each in targets:
            self._programs[each].kill()
        if target == "power":
            self._kill_window()
        for each in targets:
            self._programs[each].wait()
        if target == "power":
            cut_power(self.folder, chance)
            read_log(self.folder / "store" / "log")
        for each in targets:
            self._start(each)

    def _kill_window(self) -> None:
        opened = [line["opened"] for line in lines(self.people) if "opened" in line]
        with suppress(ProcessLookupError):
            os.kill(opened[-1], signal.SIGKILL)

    def ended(self) -> bool:
        return self._programs["host"].poll() == 0

    def close(self) -> None:
        for program in self._programs.values():
            program.kill()
            program.wait()
        self._printed.close()


def lines(ledger: Path) -> list[dict]:
    return [json.loads(line) for line in ledger.read_bytes().splitlines(keepends=True) if line.endswith(b"\n")]


def go_through(folder: Path, quota: int, kills: Sequence[Kill], chance: random.Random) -> StudyUnderFire:
    study = StudyUnderFire(folder, quota)
    try:
        for kill in kills:
            study.until(f"event {kill.events}", lambda kill=kill: study.events >= kill.events)
            time.sleep(kill.seconds)
            study.kill(kill.target, chance)
        study.until("the end", study.ended)
        last = len(read_log(folder / "store" / "log"))
        study.until("the researcher to know", lambda: lines(study.researcher)[-1]["known"] == last)
    finally:
        study.close()
    return study


def check_answers(study: StudyUnderFire, events: Sequence[NewEvent]) -> None:
    """No answer that the window was told is kept is lost, and none is there twice."""
    changed = {EventKind.ITEM_CHANGED, EventKind.ITEM_GIVEN}
    told = [event for event in events if event.kind in changed]
    in_log = {(e.participant, e.step, e.data["item"], json.dumps(e.data["answer"])) for e in told}
    kept: dict[tuple[str, int, str], object] = {}
    count = 0
    for line in lines(study.people):
        if "kept" in line:
            count += 1
            key = (line["participant"], line["step"], line["kept"])
            assert (*key, json.dumps(line["answer"])) in in_log, "an answer that was kept is lost"
            kept[key] = line["answer"]
        elif "page" in line:
            for item in line["items"]:
                was = kept.get((line["participant"], line["step"], item), line["answers"].get(item))
                assert line["attempt"] > 1 or line["answers"].get(item) == was, "people see what they have answered"
    assert count > 100
    by_attempt: Counter[tuple[str, int]] = Counter()
    before: dict[tuple[str, int, int, str], object] = {}
    given: set[tuple[str, int, int, str]] = set()
    for event in events:
        place = (event.participant, event.step)
        if event.kind == EventKind.STEP_BEGUN:
            by_attempt[place] += 1
        if event.kind in changed:
            item = (*place, by_attempt[place], str(event.data["item"]))
            if event.kind == EventKind.ITEM_GIVEN:
                assert item not in given, "an answer is given twice"
                given.add(item)
            else:
                assert before.get(item) != event.data["answer"], "a change is told twice"
                before[item] = event.data["answer"]


def check_pages(study: StudyUnderFire, runs: Iterable[Run]) -> None:
    """Nobody sees a page of a step again unless a program died there, nor one of a step before; all steps are seen."""
    seen: dict[str, list[int]] = {run.participant: [] for run in runs}
    shown: set[tuple[object, ...]] = set()
    for line in lines(study.people):
        if "opened" in line:
            shown.clear()
        if "page" in line:
            page = tuple(str(line[key]) for key in ("page", "told", "participant", "step", "attempt", "items"))
            assert page not in shown, f"seen twice: {page}"
            shown.add(page)
            seen[line["participant"]].append(line["step"])
    for run in runs:
        assert seen[run.participant] == sorted(seen[run.participant]), "nobody is sent back"
        if run.state is RunState.COMPLETE:
            assert {*seen[run.participant]} >= {step.number for step in run.plan}


def check_researcher(study: StudyUnderFire, entries: Sequence[LoggedEvent]) -> None:
    """All that the researcher ever read was the beginning of what there is in the end."""
    digest = hashlib.sha256()
    digests = [digest.hexdigest()]
    for entry in entries:
        digest.update(repr(entry).encode())
        digests.append(digest.hexdigest())
    looks = lines(study.researcher)
    assert len(looks) > 50
    assert all(look["digest"] == digests[look["known"]] and not look["troubles"] for look in looks)


def check_study(study: StudyUnderFire, quota: int) -> ExperimentFolder:
    folder = ExperimentFolder(study.folder)
    design, entries = folder.read(), read_log(folder.log)
    events = [entry.event for entry in entries]
    runs = Progress(design).after(entries).runs.values()
    complete = [run for run in runs if run.state is RunState.COMPLETE]
    assert sorted(run.place.number for run in complete) == list(range(2 * quota))
    assert set(Counter((run.place.cell, run.place.order) for run in complete).values()) == {quota // 2}
    check_answers(study, events)
    for run in complete:
        own = [event for event in events if event.participant == run.participant]
        check_run(run, own, lambda step: len(design.forms[step.index].items))
    check_pages(study, list(runs))
    check_researcher(study, entries)
    check_recordings(folder, events)
    return folder


@pytest.mark.slow
def test_a_study_whose_programs_die_and_whose_power_is_cut_loses_and_doubles_nothing(tmp_path: Path) -> None:
    chance, quota = random.Random(5), 12
    targets = ["window"] * 8 + ["host"] * 7 + ["researcher"] * 4 + ["power"] * 5
    chance.shuffle(targets)
    at = sorted(chance.sample(range(3, 80 * 2 * quota), len(targets)))
    kills = [Kill(events, chance.uniform(0.0, 1.0), target) for events, target in zip(at, targets, strict=True)]
    study = go_through(tmp_path / "study", quota, kills, chance)
    tests = analysed(check_study(study, quota))
    found = tests[(tests.outcome == "workload") & (tests.test == "paired t")].iloc[0]
    assert found.p < 0.001
    assert found.low < 20.0 < found.high
    nothing = tests[(tests.outcome == "feelings") | ((tests.outcome == "workload") & (tests.test != "paired t"))]
    assert len(nothing) == 5
    assert (nothing.p > 0.05 / len(nothing)).all()

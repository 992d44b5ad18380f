"""Whole studies in browsers: people who reload, lose their connection, decline and drop out, and programs that die."""

import asyncio
import itertools
import json
import os
import random
import signal
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType

import pytest

from tests.support.programs.browser_person import BrowserPerson, Manner
from tests.support.programs.commands import output_of
from tests.support.studies.served_program import ServedProgram
from tests.support.studies.served_study import served
from tests.system.study.checks import analysed, check_recordings, check_run
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.events import EventKind, NewEvent, RunState

FILES = {
    "experiment.yaml": """\
title: Robots that argue
seed: 11
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
within: {dialogue.condition: [supervisor, collaborator]}
between: {noise.preset: [none, bad wheels]}
quota: QUOTA
steps:
  - {step: instructions, text: welcome.md}
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice}
  - {step: check, form: understood.yaml, attempts: 3}
  - {step: trial, each_condition: true, max_seconds: 60}
  - {step: form, form: workload, each_condition: true}
  - {step: form, form: feelings.yaml, name: feelings, each_condition: true}
  - {step: form, form: person.yaml, name: person}
  - {step: debrief, text: debrief.txt}
""",
    "welcome.md": "# Robots\n\nYou send **robots** through rooms.\n",
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
like: {scale: likert, points: 7, low: not at all, high: very much, subscale: feelings, not_applicable: true}
items:
  - {id: calm, text: I feel calm.}
  - {id: quick, text: I was quick.}
  - {id: sure, text: I felt sure.}
""",
    "person.yaml": """\
title: About you
items:
  - {id: line, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
  - {id: warm, scale: differential, points: 5, low: cold, high: warm}
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99, unit: years}
  - {id: used, text: Which do you know?, scale: choice, several: true, options: [drones, arms]}
  - {id: why, text: Anything else?, scale: text, required: false}
""",
}


ONE_GAME = {"within: {dialogue.condition: [supervisor, collaborator]}\n": "", ", each_condition: true": ""}


def write_study(folder: Path, quota: int, changes: Mapping[str, str] = MappingProxyType({})) -> ExperimentFolder:
    """Write the study, with this number of people in each of its two groups, and with changes of its text."""
    folder.mkdir()
    for name, content in FILES.items():
        text = content.replace("QUOTA", str(quota))
        for before, after in changes.items():
            text = text.replace(before, after)
        (folder / name).write_text(text)
    return ExperimentFolder(folder)


def check_study(folder: ExperimentFolder, people: Sequence[BrowserPerson]) -> list[Run]:
    """Check the log, the recordings, and that each answer is the one that its person has given; return all runs."""
    design, entries = folder.read(), folder.entries()
    events = [entry.event for entry in entries]
    assert [entry.sequence for entry in entries] == list(range(1, len(entries) + 1))
    runs = list(Progress(design).after(entries).runs.values())
    complete = [run for run in runs if run.state is RunState.COMPLETE]
    by_code = {person.code: person for person in people if person.code}
    assert sorted(by_code) == sorted(run.code for run in complete)
    for run in complete:
        own = [event for event in events if event.participant == run.participant]
        check_run(run, own, lambda step: len(design.forms[step.index].items))
        check_answers(own, by_code[run.code])
    check_recordings(folder, events)
    return runs


def check_answers(events: Sequence[NewEvent], person: BrowserPerson) -> None:
    """The log has the answers that a person has given, form by form."""
    given: dict[int | None, dict[str, object]] = {}
    for event in events:
        if event.kind == EventKind.ITEM_GIVEN:
            given.setdefault(event.step, {})[str(event.data["item"])] = event.data["answer"]
    assert [*given.values()] == [*person.given.values()]


def test_people_go_through_a_whole_study_reload_lose_connections_decline_and_stop(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "study", 2, ONE_GAME)
    faultless = SimulatedPeople(drop_out=0.0, wrong=0.5)

    async def run() -> tuple[list[BrowserPerson], list[str]]:
        async with served(folder.root) as (port, _):
            people = [
                BrowserPerson(port, folder.read(), Manner(faultless, reloads=0.1, losses=0.1), 4),
                BrowserPerson(port, folder.read(), Manner(faultless, agrees=False), 2),
                BrowserPerson(port, folder.read(), Manner(SimulatedPeople(drop_out=0.5)), 3),
            ]
            return people, await asyncio.gather(*(person.go_through() for person in people))

    people, last = asyncio.run(asyncio.wait_for(run(), 240))
    assert last == ["Thank you"] * 3
    assert people[0].interruptions > 2
    states = [run.state for run in check_study(folder, people)]
    assert sorted(states) == [RunState.COMPLETE, RunState.DECLINED, RunState.LEFT]
    assert {"Before you take part", "Before we begin", "About you"} <= {*people[0].pages}


KILLS = ("game",) * 8 + ("server",) * 4
"""Programs that are killed during the rehearsal, in random order, one after each further group of events."""


@pytest.mark.slow
def test_a_study_with_two_groups_and_24_people_survives_crashes_and_loses_nothing(tmp_path: Path) -> None:
    folder, drawn = write_study(tmp_path / "study", 12), random.Random(5)
    design, seeds = folder.read(), itertools.count()
    manner = Manner(SimulatedPeople(drop_out=0.01), acts=4, reloads=0.02, losses=0.02)
    people: list[BrowserPerson] = []

    async def come_one_after_the_other(port: int) -> None:
        """Let people take part until the study is full."""
        while True:
            person = BrowserPerson(port, design, manner, next(seeds))
            people.append(person)
            await person.go_through()
            if not person.has_begun:
                return

    async def kill(server: ServedProgram) -> None:
        """Kill programs; the server is started again by its parent."""
        events = 0
        for kind in drawn.sample(KILLS, len(KILLS)):
            events += drawn.randrange(50, 200)
            while known_events(folder) < events or (kind == "game" and not server.workers):
                await asyncio.sleep(0.1)
            process = server.child if kind == "server" else drawn.choice([*server.workers.values()])
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    async def run(server: ServedProgram) -> None:
        killing = asyncio.create_task(kill(server))
        await asyncio.gather(*(come_one_after_the_other(server.port) for _ in range(8)))
        assert killing.done()
        await killing

    with ServedProgram(folder.root, "--games", "8") as server:
        try:
            asyncio.run(asyncio.wait_for(run(server), 550))
        except BaseException:
            print(server.program.text)
            raise
    runs = check_study(folder, people)
    complete = [run for run in runs if run.state is RunState.COMPLETE]
    assert sorted(run.place.number for run in complete) == list(range(24))
    assert set(Counter((run.place.cell, run.place.order) for run in complete).values()) == {6}
    assert {run.state for run in runs} <= {RunState.COMPLETE, RunState.LEFT, RunState.EXCLUDED}
    assert sum(person.interruptions for person in people) > 10
    status = json.loads(output_of("study", "status", folder.root, "--json"))
    assert (status["planned"], status["complete"]) == (24, 24)
    analysed(folder)


def known_events(folder: ExperimentFolder) -> int:
    """Return the number of events in the log."""
    with suppress(FileNotFoundError):
        return int(folder.log.with_name("log-head").read_text().split()[0])
    return 0

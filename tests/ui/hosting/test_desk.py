"""The desk as a process: told of each event, heard when it asks, and never in the way of the study."""

import asyncio
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.programs.commands import output_of
from tests.support.studies.rehearsed_studies import RehearsedStudy, clocks, rehearsed_study
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import RunState
from ui.command_line.terminal import THBRIDGE
from ui.commands.study.run import _keep_desk
from ui.commands.study.withdrawal import withdraw_during
from ui.hosting.desk import Desk
from ui.hosting.window_process import WindowProcess
from ui.model.desk.messages import DESK, DeskState


class RunningStudy:
    """A study that is carried on by its conductor alone."""

    changed: Callable[[], None]
    kiosk = "the first page"
    troubles: tuple[str, ...] = ()

    def __init__(self, study: RehearsedStudy, log: ExperimentLog) -> None:
        self.conductor = Conductor(study.design, log, lambda: clocks(20_000), iter(range(10_000)).__next__)
        self.conductor._draw = lambda most: 7 % most

    def admit_next(self) -> str | None:
        self.troubles = ("somebody came in",)
        self.changed()
        return "There is no place."

    def note(self, text: str, participant: str) -> None:
        self.conductor.note(text, participant)
        self.changed()

    def exclude(self, participant: str, reason: str) -> None:
        self.conductor.exclude(participant, reason)
        self.changed()

    def busy_with(self, participant: str) -> str | None:
        run = self.conductor.progress.runs.get(participant)
        return f"{participant} is still at the kiosk." if run and run.state is RunState.UNDER_WAY else None

    def end_run(self, participant: str, reason: str) -> None:
        self.conductor.leave(participant, reason)
        self.changed()


SCRIPT = """
import json, sys
def hear(wanted):
    for line in sys.stdin:
        state = json.loads(line)
        if wanted(state):
            return state
def say(kind, **fields):
    print(json.dumps({"type": kind, **fields}), flush=True)
state = hear(lambda state: state["runs"])
person = state["runs"][-1]["participant"]
say("ShowRun", participant=person)
assert hear(lambda state: state["shown"] == person)["events"]
say("WriteNote", text="it rains")
hear(lambda state: state["notes"][-1]["text"] == "it rains")
say("ExcludeRun", participant=person, reason="knew the study")
hear(lambda state: state["runs"][-1]["state"] == "excluded")
say("NextParticipant")
state = hear(lambda state: len(state["troubles"]) == 3)
assert state["troubles"] == ["somebody came in", "no markers", "There is no place."], state["troubles"]
assert state["kiosk"] == "the first page"
say("EndRun", participant=person, reason="it is over already")
hear(lambda state: len(state["troubles"]) == 2)
say("DeskClosed")
"""


@pytest.fixture
def study(tmp_path: Path) -> RehearsedStudy:
    root = tmp_path / "study"
    root.mkdir()
    return rehearsed_study(root)


def test_what_the_desk_asks_is_done_and_told(study: RehearsedStudy, tmp_path: Path) -> None:
    script = tmp_path / "window.py"
    script.write_text(SCRIPT)

    async def program() -> None:
        desk = Desk(running, study.folder, troubles=lambda: ("no markers",), command=(sys.executable, str(script)))
        await asyncio.wait_for(desk.run(), 60)

    with ExperimentLog(study.folder.log) as log:
        running = RunningStudy(study, log)
        asyncio.run(program())
        assert list(running.conductor.progress.runs.values())[-1].state is RunState.EXCLUDED


def test_a_desk_that_crashes_whenever_it_is_opened_is_told(
    study: RehearsedStudy, capfd: pytest.CaptureFixture[str]
) -> None:
    with ExperimentLog(study.folder.log) as log:
        desk = Desk(RunningStudy(study, log), study.folder, command=(sys.executable, "-c", "raise SystemExit(1)"))
        asyncio.run(asyncio.wait_for(_keep_desk(desk, study.folder.root), 60))
    told = capfd.readouterr().err
    assert "The desk has crashed, and is opened again." in told
    assert "The desk has failed: it crashes each time it is opened. The study continues without it." in told
    assert "thbridge study watch" in told


def test_the_window_itself_opens_and_goes_with_its_host(study: RehearsedStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    state = DeskState("Robots that argue", 8, 0)

    async def program() -> int | None:
        window = WindowProcess((*THBRIDGE, "study", "watch", str(study.folder.root), "--hosted"), DESK)
        async with window.opened():
            await window.send(state)
            while window._process is None:
                await asyncio.sleep(0)
            process = window._process
            assert process.stdin is not None
            process.stdin.close()
            await asyncio.wait_for(process.wait(), 60)
            return process.returncode

    assert asyncio.run(program()) == 0


WITHDRAWS = """
import json, sys
def hear(wanted):
    for line in sys.stdin:
        state = json.loads(line)
        if wanted(state):
            return state
def say(kind, **fields):
    print(json.dumps({"type": kind, **fields}), flush=True)
state = hear(lambda state: state["runs"])
person = next(run["participant"] for run in state["runs"] if run["state"] == "complete")
say("WithdrawRun", participant=person)
hear(lambda state: person not in [run["participant"] for run in state["runs"]])
# Once more, as by a double click.
say("WithdrawRun", participant=person)
say("WriteNote", text="withdrawn")
state = hear(lambda state: state["notes"] and state["notes"][-1]["text"] == "withdrawn")
say("DeskClosed")
"""


def test_somebody_withdraws_while_the_study_is_run(study: RehearsedStudy) -> None:
    place = study.folder
    export = place.export("first")
    output_of("study", "export", place.root, "--to", export)
    before = {run.participant for run in Progress(study.design).after(read_log(place.log)).runs.values()}
    with ExperimentLog(place.log) as log:
        running = RunningStudy(study, log)
        desk = Desk(
            running,
            place,
            command=(sys.executable, "-c", WITHDRAWS),
            withdraw=lambda participant: withdraw_during(place, running.conductor, log, participant),
        )
        asyncio.run(asyncio.wait_for(desk.run(), 120))
        after = set(running.conductor.progress.runs)
        (gone,) = before - after
    assert gone not in {run.participant for run in Progress(study.design).after(read_log(place.log)).runs.values()}
    assert gone not in (export / "manifest.json").read_text()
    assert place.pending_withdrawals.read() == ()

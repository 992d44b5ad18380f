"""Researcher's window: on a recording, and on a running session with a wizard who speaks for a robot."""

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtWidgets import QApplication, QDialog, QDockWidget, QMessageBox

from pictured.shot import Shot, Story
from sim.common.geometry import Pose2
from sim.inputs import KidnapRobot, KillRobot, PutThing
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast, Listener
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import Request, WizardAdvice, WizardMode
from thbridge.roles.shared.view import AnswerDialogue, ParticipantRequest, View
from thbridge.ros.topics import RosMessage
from thbridge.study.built_in import STANDARD
from thbridge.study.study_file import DialogueSection, Study
from thbridge.text_protocol.wire import legacy
from thbridge.watching.sockets.client import WatchClient, WatchConnected, WatchEvent
from thbridge.watching.wire import STATUS, SessionMessage, WatchStatus
from ui.model.shared.theme import LIGHT
from ui.model.watching.tools import obstacle
from ui.windows.researcher.docks.displays import MapDisplay
from ui.windows.researcher.feeds import session
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.window import ResearcherWindow

STUDY = replace(STANDARD, seed=7, robots=3)
TICKS = 1500
REQUESTS: Mapping[int, Request] = {
    100: PutThing(obstacle("crate", "box", Pose2(0.0, 0.0, 0.0), 0.5)),
    900: KidnapRobot(2, Pose2(-2.869, -2.97, 0.0)),
    1300: KillRobot(1),
}
"""Requests to the robots of the recorded hunt, by tick."""
ARGUED_MS = 250
"""Milliseconds after which robot 1 has received a reason that does not convince the robot."""
SPOKEN_FOR: Mapping[int, Request] = {
    0: WizardMode(0, on=True),
    1: WizardMode(1, on=True),
    40: WizardAdvice(0, 4),
}
"""Requests of a wizard, by tick: robot 1 was sent to a room and must answer; robot 2 is asked for advice."""


ARGUED = Study(seed=7, robots=2, dialogue=DialogueSection(condition=DialogueCondition.COLLABORATOR))
"""Study of the hunt with robots that argue."""


INSISTS = 5
"""Number of turns after which the participant only repeats their wish."""


class _Doubter:
    """Participant who wants the nearest rooms. If a robot prefers another room, the participant asks for reasons."""

    def __init__(self, setting: StudySetting) -> None:
        self._bot = build_bot(setting.templates, BotStrategy.NEAREST, setting.study.seed)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the next requests.

        If several replies are possible, choose the second reply in the first `INSISTS` turns.
        """
        doubted = {each.dialogue for each in view.dialogues if len(each.choices) > 2 and each.turn < INSISTS}
        return [
            AnswerDialogue(asked.dialogue, asked.turn, 1)
            if isinstance(asked, AnswerDialogue) and asked.dialogue in doubted
            else asked
            for asked in self._bot.requests(view)
        ]


def play(listeners: Sequence[Listener], ticks: int, requests: Mapping[int, Request], study: Study = STUDY) -> None:
    """Play the beginning of a hunt with a simulated participant, who doubts the robots if they argue."""
    setting = read_setting(study, Path())
    doubts = study.dialogue.condition.argues
    bot = _Doubter(setting) if doubts else build_bot(setting.templates, study.participant.strategy, study.seed)
    participant = TabUI(bot)
    record = build_record(setting, PLAY, [legacy.SIMR, legacy.HIDER, legacy.TABUI], "suggestion")
    recorder = BagRecorder(Broadcast(build_publisher(setting), record, setting.map.grid, listeners))
    roles = [build_simr(setting), build_hider(setting.templates, setting.study.seed)]
    hunt = Session(build_keeper(setting), roles, [recorder], [participant])
    for tick in range(ticks):
        if tick in requests:
            hunt.ask("watch", requests[tick])
        hunt.step()


# A recording ----------------------------------------------------------------------------------------------------------


def recorded() -> Iterator[Shot]:
    """Yield a recording of half a minute with three robots; robot 3 has just been kidnapped."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "hunt.bag"
        with build_writer(read_setting(STUDY, Path()), bag) as writer:
            play([writer], TICKS, REQUESTS)
        window = ResearcherWindow(RecordingFeed(BagOpener(bag)), "hunt.bag", LIGHT, lambda: 0.0)
        window.show()
        _wait(lambda: window.playback.state.text() == "recording")
        window.playback.timeline.setValue(19_200)
        window.select(2)
        _refreshed(window)
        yield shot("recording", window)
        for display in (MapDisplay.GLOBAL_COSTMAP, MapDisplay.LOCAL_COSTMAP):
            window.displays.toggle(display)
        window.select(0)
        window.playback.timeline.setValue(8_000)
        _raise(window, "Dialogue")
        _refreshed(window)
        yield shot("recording-costmaps", window)
        window.show_keys()
        sheet = window.findChild(QDialog)
        yield shot("researcher-keys", window, sheet)
        if sheet is not None:
            sheet.close()
        window.close()


# A session under way --------------------------------------------------------------------------------------------------


class _RecordedClient(WatchClient):
    """Watch client with all events already received."""

    def __init__(self, events: list[WatchEvent]) -> None:
        super().__init__("", 0)
        self._recorded = events

    def take(self) -> list[WatchEvent]:
        """Return all events at once."""
        events, self._recorded = self._recorded, []
        return events

    def send(self, line: bytes) -> bool:
        """Drop the line, because there is no server."""
        return True


class _Connection(session.WatchConnection):
    """Connection without a thread and without a network."""

    def __init__(self, client: WatchClient) -> None:
        self.client = client

    def close(self) -> None:
        """Do nothing: nothing is open."""


class _MessageCollector:
    """Collector of the messages of a session, in the form in which a watch client receives them."""

    def __init__(self) -> None:
        self.events: list[WatchEvent] = [WatchConnected()]

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """Store the messages."""
        self.events += [
            SessionMessage(each.topic.name, each.topic.msgtype, each.stamp_ns, each.data) for each in messages
        ]


def live() -> Iterator[Shot]:
    """Yield a session in which the researcher speaks for robots 1 and 2."""
    collector = _MessageCollector()
    play([collector], 700, SPOKEN_FOR)
    status = WatchStatus(paused=False, rate=1.0, lag=0.0, watchers=1, dropped=0)
    collector.events.append(SessionMessage(STATUS, "std_msgs/String", 14_000_000_000, status.data()))
    feed = session.SessionFeed(_Connection(_RecordedClient(collector.events)), "127.0.0.1:6010")
    window = ResearcherWindow(feed, "127.0.0.1:6010", LIGHT, lambda: 0.0)
    window.show()
    _raise(window, "Wizard")
    _refreshed(window)
    yield shot("live-wizard", window)
    window.kill.emit()
    box = window.findChild(QMessageBox)
    yield shot("kill", window, box)
    if box is not None:
        box.close()
    window.close()


def argued() -> Iterator[Shot]:
    """Yield two robots that prefer other rooms than the participant, who has asked robot 1 for its reasons."""
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "hunt.bag"
        with build_writer(read_setting(ARGUED, Path()), bag) as writer:
            play([writer], 50, {}, ARGUED)
        window = ResearcherWindow(RecordingFeed(BagOpener(bag)), "hunt.bag", LIGHT, lambda: 0.0)
        window.show()
        _wait(lambda: window.playback.state.text() == "recording")
        window.playback.timeline.setValue(ARGUED_MS)
        _raise(window, "Dialogue")
        _raise(window, "Arguments")
        _refreshed(window)
        yield shot("recording-arguments", window)
        window.close()


def shot(name: str, window: ResearcherWindow, over: QDialog | None = None) -> Shot:
    """Return a picture of the window."""
    return Shot(name, window, window.set_palette, over)


def _raise(window: ResearcherWindow, title: str) -> None:
    for dock in window.findChildren(QDockWidget):
        if dock.windowTitle() == title:
            dock.raise_()


def _refreshed(window: ResearcherWindow) -> None:
    """Refresh the window several times, because lists and plots are not updated in every frame."""
    for _ in range(12):
        window.refresh()
        QApplication.processEvents()


def _wait(holds: Callable[[], bool]) -> None:
    while not holds():
        QApplication.processEvents()


STORIES = (
    Story(
        "The researcher: a recording",
        {
            "recording": "A recording: robot 3 was kidnapped and still believes its old pose",
            "recording-costmaps": "Costmaps of robot 1, and the dialogue",
            "researcher-keys": "The researcher's keyboard shortcuts (F1)",
        },
        recorded,
    ),
    Story(
        "The researcher: robots that argue",
        {"recording-arguments": "Robot 1 disagrees with the room that the participant chose, and has given its reason"},
        argued,
    ),
    Story(
        "The researcher: a running session",
        {
            "live-wizard": "A running session; the researcher speaks for robots 1 and 2",
            "kill": "The question before a robot is killed",
        },
        live,
    ),
)

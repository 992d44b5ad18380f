from pathlib import Path

from tests.ui.sources.scanned_bags import STUDY, record, scanned
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.shared.robot_requests import Request, WizardMode
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.tools import Tools


def last(bag: Path) -> Scene:
    source = scanned(bag)
    return source.scene(source.end_ns, ShownLayers())


def test_a_person_sees_what_waits_and_what_was_said_instead(tmp_path: Path) -> None:
    """Each run is the one before, and one answer more."""
    done: dict[int, Request] = {0: WizardMode(0, True)}
    record(tmp_path / "asked.bag", STUDY, 20, done)
    asked = last(tmp_path / "asked.bag")
    (advice,) = asked.wizard.advice
    assert (asked.wizard.puppets, advice.robot) == ((0,), 0)
    room = next(room for room, _ in reversed(advice.costs) if room != advice.suggestion)
    done[20] = _granted(Tools().advise(asked, 0, room))

    record(tmp_path / "waits.bag", STUDY, 40, done)
    waits = last(tmp_path / "waits.bag")
    (turn,) = waits.wizard.turns
    assert (turn.robot, turn.room, waits.wizard.advice) == (0, room, ())
    done[40] = _granted(Tools().speak(waits, turn, 0, "As you like"))

    record(tmp_path / "spoken.bag", STUDY, 50, done)
    entries = [entry for entry in scanned(tmp_path / "spoken.bag").log.entries("said") if entry.text == "As you like"]
    assert [(entry.who, entry.robot) for entry in entries] == [("robot 1 (wizard)", 0)]


def _granted(request: Request | RequestRefused) -> Request:
    assert not isinstance(request, RequestRefused)
    return request

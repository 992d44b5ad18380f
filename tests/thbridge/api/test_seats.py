"""Sessions of `thbridge.api` with several seats: the caller plays one, some or all of them."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.programs.commands import thbridge
from thbridge import api
from thbridge.dialogue.portrait import read_portrait
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros import names
from thbridge.ros.messages import unpack

SEATS = [
    {"name": "driver", "label": "the driver", "robots": [1, 2], "names_treasures": False},
    {"name": "namer", "label": "the namer", "takes_over": True},
]
STUDY = api.HuntStudy(
    robots=2, seed=3, game={"energy": 30}, dialogue={"condition": "supervisor"}, seats=SEATS,
    team={"agreement": {"send": "all", "end": "one"}},
)  # fmt: skip


def until(session: api.HuntSession, condition: Callable[[], bool]) -> None:
    """Run until a condition is true."""
    for _ in range(500):
        if condition():
            return
        session.step()
    pytest.fail(str(session.events[-5:]))


def test_the_caller_plays_all_seats_which_vote_talk_and_hand_over(tmp_path: Path) -> None:
    bag = tmp_path / "hunt.bag"
    with api.HuntSession(STUDY, record=bag) as session:
        driver, namer = session.seat("driver"), session.seat("namer")
        until(session, lambda: bool(namer.view and namer.view.ready and session.ready))
        assert (session.participant.seat, namer.view.commanded.tolist()) == ("driver", [False, False])
        driver.say("To room 3?", to="namer")
        driver.select(1, 3)
        until(session, lambda: bool(driver.view.agreements))
        driver.send(1, 3)
        until(session, lambda: bool(namer.view.votes))
        (vote,) = namer.view.votes
        assert (vote.kind, vote.robot, vote.room, vote.needs, vote.agree) == ("send", 1, 3, 2, ("driver",))
        namer.vote(vote.decision, agrees=True, reason="near")
        until(session, lambda: driver.view.bound_for.tolist() == [3, 0])
        namer.ask_for(2)
        until(session, lambda: driver.view.asked_for == {2: "namer"})
        driver.hand_over(2, "namer")
        until(session, lambda: namer.view.commanded.tolist() == [False, True])
        namer.select(1, 4)
        until(session, lambda: namer.view.refusal is not None)
        assert namer.view.refusal == "Robot 1 is commanded by the driver just now."
        assert driver.view.refusal is None
    happened = [(event.kind, event.data.get("seat")) for event in session.events]
    for each in (("personsaid", "driver"), ("voted", "namer"), ("departed", "driver"), ("askedback", "namer")):
        assert each in happened
    replayed = thbridge(tmp_path, "replay", "hunt.bag", "--json")
    assert replayed.exit_code == 0, replayed.output


def test_a_seat_that_follows_a_dialogue_objects_and_the_commander_reads_it(tmp_path: Path) -> None:
    bag = tmp_path / "hunt.bag"
    seats = [SEATS[0], SEATS[1] | {"objects": True}]
    study = api.HuntStudy(robots=2, seed=3, dialogue={"condition": "collaborator"}, seats=seats)
    with api.HuntSession(study, record=bag) as session:
        driver, namer = session.seat("driver"), session.seat("namer")
        until(session, lambda: bool(namer.view and namer.view.ready and session.ready))
        driver.select(1, 3)
        until(session, lambda: bool(namer.view.dialogues))
        with pytest.raises(api.HuntError, match="there is no reason 'ugly'"):
            namer.object_to(1, "ugly")
        with pytest.raises(api.HuntError, match="no dialogue with robot 2 is open"):
            namer.object_to(2, "too-far")
        namer.object_to(1, "too-far", "Look at the wall.")
        until(session, lambda: bool(driver.view.dialogues[0].objections))
        assert driver.view.dialogues[0].objections == (api.HuntObjection("namer", "too-far", "Look at the wall."),)
        (event,) = [event for event in session.events if event.kind == "objected"]
        assert (event.robot, event.room, event.data["seat"]) == (1, 3, "namer")
    states = [read_portrait(unpack.dialogue_state(each.data).json) for each in messages(bag, [names.DIALOGUE_STATES])]
    assert "namer" not in str(states[0].arguments)
    (objection,) = [each for each in states[-1].arguments if each.sides == ("namer",)]
    assert (objection.support, objection.conclusion) == (("objected(namer, too_far)",), "not next(Robot1, Room3)")
    replayed = thbridge(tmp_path, "replay", "hunt.bag", "--json")
    assert replayed.exit_code == 0, replayed.output


def test_simulated_participants_play_the_other_seats() -> None:
    with api.HuntSession(STUDY, seats=["namer"]) as session:
        assert session.participant.seat == "namer"
        until(session, lambda: bool(session.view is not None and session.view.votes))
        (vote, *_) = session.view.votes
        assert vote.seat == "driver"
        with pytest.raises(api.HuntError, match="a simulated participant plays driver"):
            session.seat("driver").send(1, 3)


def test_a_sceptical_simulated_participant_objects_and_the_others_decide() -> None:
    critic = {"name": "critic", "takes_over": False, "names_treasures": False, "objects": True, "attitude": "sceptical"}
    study = api.HuntStudy(robots=2, seed=3, dialogue={"condition": "collaborator"}, seats=[
        {"name": "driver", "robots": [1, 2]}, critic,
    ])  # fmt: skip
    with api.HuntSession(study, seats=["driver"]) as session:
        driver = session.seat("driver")
        until(session, lambda: bool(driver.view and driver.view.ready and session.ready))
        for room in (3, 4, 5, 6, 7, 8) * 3:
            driver.select(1, room)
            session.run(0.2)
        raised = [event for event in session.events if event.kind == "objected"]
        assert raised and {event.data["seat"] for event in raised} == {"critic"}
        assert not any(event.kind == "departed" for event in session.events)


@pytest.mark.parametrize(
    ("study", "seats", "said"),
    [
        (STUDY, ["pilot"], "the study has no seat 'pilot'. Write one of these: driver, namer"),
        (api.HuntStudy(), ["driver"], "the study has no seat 'driver'. Omit the argument"),
    ],
)
def test_unknown_seats_are_refused(study: api.HuntStudy, seats: list[str], said: str) -> None:
    with pytest.raises(api.HuntError, match=said):
        api.HuntSession(study, seats=seats)

"""What a window tells from its view alone, the keeper says too: a random games, with any requests now and then."""

from copy import deepcopy
from dataclasses import replace
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import ScriptedPlayer
from thbridge.hunt.events import Condition
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.participant_lines import encode_request_line
from thbridge.roles.shared.participant_rules import judge, revealed
from thbridge.roles.shared.robot_requests import ReleaseCommand, StationSend, TakeCommand
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    IdentifyTreasure,
    LeaveTreasure,
    OpenDialogue,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    View,
)
from thbridge.text_protocol.wire.notice_format import Notice, parse_notice

ROBOTS, ROOMS = range(2), range(1, 9)


def any_request(chance, view):
    """Any request, more often than not about a room that a robot has to do with."""
    robot = chance.choice(ROBOTS)
    mover = view.robots[robot]
    room = chance.choice([*ROOMS, *[mover.moving_to or mover.place or 1] * 8])
    matter = chance.choice(("take-picture", "take-treasure"))
    return chance.choice(
        (
            *(SelectRoom(robot, room), OpenDialogue(robot, matter, room)) * 2,
            *(RequestSuggestion(robot), StopRobot(robot), RequestHandback(robot)),
            *(LeaveTreasure(room), TakeUpTreasure(room), EndGame(1)),
        )
    )


def any_step(chance, view):
    robot = chance.choice(ROBOTS)
    request = any_request(chance, view)
    return chance.choice(
        (
            *("go along",) * 16,
            *("go along" if isinstance(request, EndGame) else request,) * 8,
            *("refuse", "slow", "fast", "fast"),
            *((TakeCommand(robot, "QGC"),), *((ReleaseCommand(robot),),) * 3),
            *((TakeCommand(robot, "QGC"), StationSend(robot, chance.choice(ROOMS)), ReleaseCommand(robot)),) * 2,
            *((robot, chance.choice(list(Condition))), *((robot, Condition.WELL),) * 3),
            *((robot, "/rviz"), *((robot, None),) * 3),
        )
    )


def play(hunt, player, step):
    view, puppets = hunt.view(), hunt.puppets
    player.wish = ()
    match step:
        case "slow" | "fast":
            puppets.ticks = 400 if step == "slow" else 5
        case "go along" | "refuse":
            choice = 0 if step == "go along" else -1
            player.wish = (
                *(
                    AnswerDialogue(talk.dialogue, talk.turn, choice % len(talk.choices))
                    for talk in view.dialogues
                    if talk.choices
                ),
                *(SenseTreasure(room.room) for room in view.rooms if room.undecided and not room.sensed),
                *(agreed_request(consent) for consent in view.consents),
            )
        case (TakeCommand() | ReleaseCommand(), *_):
            for request in step:
                hunt.session.ask("station", request)
        case (robot, Condition() as condition):
            puppets.conditions[robot] = condition
        case (robot, researcher):
            puppets.researchers = tuple(researcher if number == robot else None for number in ROBOTS)
        case _:
            player.wish = (step,)
    hunt.tabui.poll_player()
    hunt.run(12)
    player.wish = ()
    hunt.tabui.poll_player()
    hunt.run(50)


def agreed_request(consent):
    match consent.matter:
        case "select-room":
            return SendRobot(consent.robot, consent.room)
        case "take-picture":
            return TakePicture(consent.room)
        case "take-treasure":
            return IdentifyTreasure(consent.room, "Pink can")


def keeper_refuses(hunt, request):
    """Reason for which the keeper refuses a request now, or None; the game goes on as if nobody had asked."""
    asked = deepcopy(hunt.keeper)
    notices = [parse_notice(line) for line in asked.step(len(hunt.tick_records), [encode_request_line(request)])]
    views = [View.of_notice(each) for each in notices if isinstance(each, Notice) and each.kind == "View"]
    assert len(views) < 2
    refusal = views[0].refusal if views else hunt.view().refusal
    return None if refusal == hunt.view().refusal else refusal.reason


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**9), st.sampled_from((25.0, 60.0, 100.0)))
def test_what_the_view_says_is_possible_the_keeper_grants_and_nothing_else(seed, energy):
    chance = Random(seed)
    player = ScriptedPlayer()
    hunt = HuntWithoutSimulator(participant=TabUI(player), rules=replace(RULES, energy=energy))
    hunt.run(60)
    for _ in range(40):
        play(hunt, player, any_step(chance, hunt.view()))
        known = revealed(hunt.view())
        for _ in range(3):
            request = any_request(chance, hunt.view())
            ruling = judge(known, request)
            reason = ruling.reason if isinstance(ruling, RequestRefused) else None
            assert keeper_refuses(hunt, request) == reason, request

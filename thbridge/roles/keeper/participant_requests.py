"""What the participant wishes beyond the lines of 2016: talking, giving up a treasure, calling a robot back."""

from thbridge.dialogue.moves import Scenario
from thbridge.hunt import rules
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.outcomes import Refused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import suggest
from thbridge.roles.keeper.dialogues import MATTERS
from thbridge.roles.keeper.open_game import Book, Reason
from thbridge.roles.notices import heard
from thbridge.roles.view import Agree, Answer, AskBack, CallBack, Discuss, GiveUp, Leave, Select, Unsure
from thbridge.wire.notice import Notice


def grant(book: Book, state: GameState, notice: Notice, *, awaits_treasures: bool) -> None:
    """Grant a wish, or remember why not; a notice that is no wish changes nothing.

    Args:
        book: of the game.
        state: the game as it stands.
        notice: what was said.
        awaits_treasures: Hider is about to hide them; nobody is sent before.
    """
    if heard(notice, Agree) is not None:
        book.take(Agree.__name__, rules.agree(state))
    elif (asked := heard(notice, Select)) is not None:
        _select(book, state, asked, awaits_treasures)
    elif (unsure := heard(notice, Unsure)) is not None:
        _suggest(book, state, unsure.robot, awaits_treasures)
    elif (discuss := heard(notice, Discuss)) is not None:
        _discuss(book, state, discuss)
    elif (answer := heard(notice, Answer)) is not None:
        refused = book.talks.answer(answer.dialogue, answer.turn, answer.choice)
        if refused is not None:
            book.refuse(Answer.__name__, refused)
    elif (leave := heard(notice, Leave)) is not None:
        book.take(Leave.__name__, rules.leave(state, _room(leave.room)))
    elif (end := heard(notice, GiveUp)) is not None:
        if end.game == state.started.game:
            book.take(GiveUp.__name__, rules.give_up(state))
    elif (back := heard(notice, CallBack)) is not None:
        _call_back(book, state, back.robot)
    elif (plea := heard(notice, AskBack)) is not None and plea.robot not in book.pleas.fresh:
        book.take(AskBack.__name__, rules.ask_back(state, plea.robot))


def _call_back(book: Book, state: GameState, robot: int) -> None:
    is_under_way = state.has_robot(robot) and state.robots[robot].bound_for is not None
    refused = rules.commanded_by_other(state, robot, Commander.PARTICIPANT) if is_under_way else None
    if refused is not None:
        book.refuse(CallBack.__name__, refused)
    elif is_under_way:
        book.recall(robot)
    else:
        book.take(CallBack.__name__, rules.fail(state, robot, "", 0.0))


def _select(book: Book, state: GameState, asked: Select, awaits_treasures: bool) -> None:
    room = _room(asked.room)
    ruling = _immovable(state, asked.robot, awaits_treasures) or rules.move(state, asked.robot, room)
    other = book.talks.spoken_for(room, asked.robot)
    if isinstance(ruling, tuple) and other is not None:
        name = rules.robot_name(other)
        ruling = Refused(Reason.UNDER_DISCUSSION, f"You are talking with {name} about {room}.")
    _open(book, state, ruling, Scenario.SPECIFIC_ROOM, asked.robot, room)


def _suggest(book: Book, state: GameState, number: int, awaits_treasures: bool) -> None:
    refused = _immovable(state, number, awaits_treasures)
    if refused is not None:
        book.refuse(Unsure.__name__, refused)
        return
    say_where_to_go(book, state, number)


def say_where_to_go(book: Book, state: GameState, number: int) -> None:
    """A robot that could go somewhere suggests a room; or whoever speaks in its place is waited for."""
    room = tour_of(book, state, number)
    if isinstance(room, Refused):
        book.refuse(Unsure.__name__, room)
    elif number in book.talks.puppets:
        book.talks.await_advice(number)
    else:
        advise(book, state, number, room)


def advise(book: Book, state: GameState, number: int, room: Room) -> None:
    """A robot suggests a room."""
    _open(book, state, (), Scenario.DONT_KNOW, number, room)


def tour_of(book: Book, state: GameState, number: int) -> Room | Refused:
    """Where a robot itself would suggest to go: rooms that are talked about with others are left to those."""
    robot = state.robots[number]
    free = [room for room in state.free_rooms if book.talks.spoken_for(room, number) is None]
    return suggest(state.started.costs, robot.at, free, robot.energy, state.started.identify_cost)


def _discuss(book: Book, state: GameState, discuss: Discuss) -> None:
    room = _room(discuss.room)
    scenario = Scenario.TAKE_PICTURE if discuss.matter == "take-picture" else Scenario.TAKE_TREASURE
    ruling: rules.Ruling
    if not state.has_room(room) or state.decider(room) != discuss.robot:
        ruling = Refused(rules.Reason.NOBODY_THERE, f"This robot does not stand in {room}.")
    elif scenario is Scenario.TAKE_PICTURE:
        ruling = rules.picture(state, room)
    else:
        # The name is still open; whether naming is allowed and can be paid is not.
        ruling = rules.identify(state, room, "", 0)
    _open(book, state, ruling, scenario, discuss.robot, room)


def _open(book: Book, state: GameState, ruling: rules.Ruling, scenario: Scenario, robot: int, room: Room) -> None:
    """Open a dialogue about something that the rules would allow."""
    refused = ruling if isinstance(ruling, Refused) else book.talks.open(state, scenario, robot, room)
    if refused is not None:
        book.refuse(MATTERS[scenario], refused)


def _immovable(state: GameState, robot: int, awaits_treasures: bool) -> Refused | None:
    """Why this robot cannot be talked into any move, or None."""
    if awaits_treasures:
        return Refused(Reason.NOT_READY, "The treasures are not hidden yet.")
    ruling = rules.move(state, robot, next(iter(state.free_rooms), Room(1)))
    about_the_room = {rules.Reason.NOT_ENOUGH_ENERGY, rules.Reason.ALREADY_VISITED, rules.Reason.NOT_A_MOVE}
    return ruling if isinstance(ruling, Refused) and ruling.reason not in about_the_room else None


def _room(number: int) -> Room:
    """The room people call this number. A negative one becomes the corridor, which every rule refuses."""
    return Room(max(number, 0))

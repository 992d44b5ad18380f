"""What a new view changes in what is remembered."""

from collections.abc import Iterator

from thbridge.hunt.events import Condition
from thbridge.hunt.rules import robot_name
from thbridge.roles.view import (
    Answer,
    Discuss,
    Identify,
    RobotView,
    RoomView,
    Select,
    SendRobot,
    Sense,
    TakePicture,
    View,
    Wish,
)
from ui.model.playing.history import History
from ui.model.playing.possible import (
    decider,
    standing_in,
    talks,
    why_not_command,
    why_not_end,
    why_not_go,
    why_not_name,
)
from ui.model.playing.queue import Find, Item, Talk
from ui.model.playing.state import End, Hunt, Memory, MoveOn, Reroute
from ui.model.playing.words import how_it_comes_back, place_name, titled

NOTE = 6.0
"""Seconds for which a sentence is shown."""


def note(memory: Memory, sentence: str, now: float) -> None:
    """Show a sentence for a while, and have it read out."""
    memory.note = (sentence, now + NOTE)
    memory.history.announce(sentence)


def hear_view(memory: Memory, view: View, now: float) -> None:
    """Take in how things stand now; another game begins anew, the same one goes on where it was."""
    hunt = memory.hunt
    if hunt is None or not _goes_on(hunt.view, view):
        _begin(memory, view)
        return
    before, hunt.view = hunt.view, view
    hunt.richest = max([hunt.richest, *(robot.energy for robot in view.robots)])
    memory.history.hear(before, view)
    _hear_rooms(memory, hunt, before, now)
    _hear_commanders(memory, hunt, before, now)
    _hear_refusal(memory, hunt, now)
    for reason in hunt.asked.hear(view):
        if reason:
            note(memory, reason, now)
    _reroute(memory, hunt, now)
    _doubt(memory, hunt, now)
    settle(hunt)


def settle(hunt: Hunt) -> None:
    """Bring up to date what follows from the view and from what was asked for."""
    view = hunt.view
    hunt.named = {room: name for room, name in hunt.named.items() if _is_talked_over(hunt, room)}
    hunt.requests = {
        robot: said
        for robot, said in hunt.requests.items()
        if hunt.talk(robot) is not None or hunt.asked.going(robot) is not None
    }
    hunt.popups.update(tuple(_items(hunt)) if view.over is None else ())


def wishes(hunt: Hunt) -> tuple[Wish, ...]:
    """Everything wanted now: what was asked for, and what follows from agreements or needs no decision."""
    view = hunt.view
    if view.over is not None or view.consent is not None:
        return hunt.asked.wishes
    agreed: list[Wish] = []
    for consent in view.consents:
        match consent.matter:
            case "select-room":
                agreed.append(SendRobot(consent.robot, consent.room))
            case "take-picture":
                agreed.append(TakePicture(consent.room))
            case "take-treasure" if consent.room in hunt.named:
                agreed.append(Identify(consent.room, hunt.named[consent.room]))
    sense = [Sense(room.room) for room in view.rooms if room.undecided and not room.sensed and _can_look(view, room)]
    return (*hunt.asked.wishes, *agreed, *sense)


def _can_look(view: View, room: RoomView) -> bool:
    """Whether a robot stands in a room that would tell what it sees."""
    stander = standing_in(view, room.room)
    return stander is not None and view.robots[stander].condition is not Condition.SILENT


def _begin(memory: Memory, view: View) -> None:
    hunt = Hunt(view)
    hunt.richest = max((robot.energy for robot in view.robots), default=0.0)
    if memory.hunt is not None:
        memory.history = History()
        if memory.hunt.view.game == view.game:
            memory.pictures.forget()
    memory.hunt = hunt
    memory.typed, memory.hovered, memory.note = "", None, None
    memory.selected = min(memory.selected, max(len(view.robots) - 1, 0))
    memory.followed = None if memory.followed is None else memory.selected
    memory.motions = ()
    memory.refusals = 0 if view.refusal is None else view.refusal.number
    memory.history.hear(None, view)
    settle(hunt)


def _goes_on(before: View, view: View) -> bool:
    """Whether a view is of the same game: what was found out in it is never unknown again."""
    return (
        before.game == view.game
        and before.costs == view.costs
        and len(before.robots) == len(view.robots)
        and (before.over is None or view.over is not None)
        and all(
            new.state == "visited" and (old.verdict is None or old.verdict == new.verdict)
            for old, new in zip(before.rooms, view.rooms, strict=True)
            if old.state == "visited"
        )
    )


def _hear_rooms(memory: Memory, hunt: Hunt, before: View, now: float) -> None:
    for old, new in zip(before.rooms, hunt.view.rooms, strict=True):
        if new.picture is not None and old.picture is None:
            hunt.pictured[new.room] = now
        if new.verdict is not None and old.verdict is None:
            hunt.gained = new.verdict.points
            stander = standing_in(hunt.view, new.room)
            worker = decider(before, new.room) if stander is None else stander
            if worker is not None:
                hunt.verdicts[new.room] = worker
        finder = standing_in(before, new.room)
        gone = standing_in(hunt.view, new.room) is None and decider(hunt.view, new.room) == finder
        if finder is not None and gone and hunt.view.over is None:
            yours = why_not_name(hunt.view, finder, new.room) or "You may still say what it is."
            sentence = f"{titled(finder)} was sent on, and what it found stays in room {new.room}. {yours}"
            _told(memory, sentence, hunt.view.robots[finder], now)


def _hear_commanders(memory: Memory, hunt: Hunt, before: View, now: float) -> None:
    """Tell that a robot is not the participant's any more, and what becomes of a talk on its way; or that it is.

    And that whoever commands it was asked for it.
    """
    for was, robot in zip(before.robots, hunt.view.robots, strict=True):
        if robot.asked_back and not was.asked_back:
            _told(memory, f"You have asked {robot.other_commander} for {robot_name(robot.robot)} back.", robot, now)
        if (was.commander, was.commander_name) == (robot.commander, robot.commander_name):
            continue
        name, other = titled(robot.robot), robot.other_commander
        if not other:
            sentence = f"{name} is yours again."
        else:
            sentence = f"{name} is commanded by {other} now. {how_it_comes_back(robot)}"
            if any((talking, matter) == (robot.robot, "select-room") for talking, matter, _ in talks(before)):
                sentence += " Where it should go need not be talked over any more."
        _told(memory, sentence, robot, now)


def _told(memory: Memory, sentence: str, robot: RobotView, now: float) -> None:
    memory.history.happened(sentence, robot.robot)
    memory.note = (sentence, now + NOTE)


def _hear_refusal(memory: Memory, hunt: Hunt, now: float) -> None:
    refusal = hunt.view.refusal
    number = 0 if refusal is None else refusal.number
    if number == memory.refusals:
        return
    memory.refusals = number
    if refusal is None:
        return
    memory.note = (refusal.sentence, now + NOTE)
    memory.history.happened(refusal.sentence)
    hunt.asked.refused(refusal)
    if refusal.wish == Identify.__name__:
        hunt.named.clear()


def _reroute(memory: Memory, hunt: Hunt, now: float) -> None:
    """Ask robots that were called back for where they shall go instead, once they stand."""
    for robot, room in list(hunt.reroutes.items()):
        mover = hunt.view.robots[robot]
        if mover.moving_to is not None:
            continue
        del hunt.reroutes[robot]
        refused = why_not_go(hunt.view, robot, room)
        if hunt.view.over is not None:
            continue
        if mover.place > 0 and hunt.view.room(mover.place).undecided:
            note(memory, f"{titled(robot)} was already in {place_name(mover.place)} when you called it back.", now)
        elif refused is not None:
            note(memory, refused, now)
        else:
            memory.history.requested(robot, hunt.ask_to_go(Select(robot, room)))


def _doubt(memory: Memory, hunt: Hunt, now: float) -> None:
    """Take back a question that is none any more."""
    match hunt.doubt:
        case Reroute(robot, room):
            place = hunt.view.robots[robot].place
            arrived = hunt.view.robots[robot].moving_to is None
            reason = (
                f"{titled(robot)} is in {place_name(place)} now." if arrived else why_not_go(hunt.view, robot, room)
            )
        case MoveOn(wish, room):
            decided = not hunt.view.room(room).undecided or standing_in(hunt.view, room) != wish.robot
            reason = why_not_command(hunt.view, wish.robot) or ("That is decided by now." if decided else None)
        case End():
            reason = why_not_end(hunt.view)
        case None:
            return
    if reason is not None:
        hunt.doubt = None
        note(memory, reason, now)


def _is_talked_over(hunt: Hunt, room: int) -> bool:
    """Whether naming what is in a room is still asked for, talked over or agreed."""
    if not hunt.view.room(room).undecided:
        return False
    asked = any(
        isinstance(wish, Discuss) and (wish.matter, wish.room) == ("take-treasure", room) for wish in hunt.asked.wishes
    )
    return asked or any((matter, about) == ("take-treasure", room) for _, matter, about in talks(hunt.view))


def _items(hunt: Hunt) -> Iterator[Item]:
    """What is to be looked at, in no order that matters: what is new is put behind what was there."""
    view = hunt.view
    for robot in view.robots:
        if hunt.talk(robot.robot) is not None or hunt.asked.going(robot.robot) is not None:
            yield Talk(robot.robot)
    for room in view.rooms:
        worker = decider(view, room.room)
        if room.undecided and worker is not None:
            yield Find(worker, room.room)
        elif room.room in hunt.verdicts:
            yield Find(hunt.verdicts[room.room], room.room)


def is_open(view: View, answer: Answer) -> bool:
    """Whether a dialogue waits for an answer at just this turn."""
    return any(
        (talk.dialogue, talk.turn) == (answer.dialogue, answer.turn) and 0 <= answer.choice < len(talk.choices)
        for talk in view.dialogues
    )

"""What the participant's acts do. Each is judged against what was on the screen when it was done."""

from thbridge.hunt.rules import robot_name
from thbridge.roles.view import (
    Agree,
    Answer,
    AskBack,
    CallBack,
    Discuss,
    GiveUp,
    Leave,
    PlayAgain,
    Select,
    Unsure,
    View,
)
from ui.model.playing.cards import described
from ui.model.playing.hearing import is_open, note, settle
from ui.model.playing.possible import (
    undecided_beside,
    why_not_ask,
    why_not_command,
    why_not_end,
    why_not_go,
    why_not_name,
    why_not_picture,
    why_not_work,
)
from ui.model.playing.queue import Find, Talk
from ui.model.playing.state import Doubt, End, Hunt, Memory, MoveOn, Reroute
from ui.model.screen import (
    Act,
    AgreeToTakePart,
    AnotherGame,
    AskForRobot,
    ChooseRobot,
    ChooseRoom,
    ConsiderRoom,
    DontKnow,
    EndGame,
    FinishNumber,
    FitMap,
    FollowRobot,
    GiveAnswer,
    LeaveIt,
    Meant,
    NameIt,
    NextRobot,
    NotYet,
    PickName,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    StopRobot,
    TakeThePicture,
    TypeDigit,
)

TYPING = 4.0
"""Seconds after which a digit waits no longer for the next one."""


def do(memory: Memory, act: Act, now: float) -> None:
    """Do what the participant asked for."""
    match act:
        case ShowHelp():
            memory.helping = not memory.helping
        case FitMap():
            memory.followed = None
        case ConsiderRoom(room):
            memory.hovered = room
        case _ if memory.hunt is not None and memory.hunt.view.game == memory.drawn.game:
            _in_game(memory, memory.hunt, act, now)
            settle(memory.hunt)


def _in_game(memory: Memory, hunt: Hunt, act: Act, now: float) -> None:
    match act:
        case AgreeToTakePart():
            if hunt.view.consent is not None:
                hunt.asked.ask(Agree(), hunt.view)
        case AnotherGame():
            if hunt.view.over is not None:
                hunt.asked.ask(PlayAgain(hunt.view.game), hunt.view)
        case FollowRobot():
            memory.followed = memory.selected if memory.followed is None else None
        case ChooseRobot(robot):
            _select(memory, hunt, robot)
        case NextRobot(step):
            _select(memory, hunt, (memory.selected + step) % len(hunt.view.robots))
        case _ if hunt.view.over is None and hunt.view.consent is None:
            _in_play(memory, hunt, act, now)


def _in_play(memory: Memory, hunt: Hunt, act: Act, now: float) -> None:
    match act:
        case Meant():
            if hunt.doubt is not None and hunt.doubt == memory.drawn.doubt:
                _meant(memory, hunt, hunt.doubt)
        case NotYet():
            _take_back(memory, hunt)
        case _ if hunt.doubt is not None:
            note(memory, "Please answer the question first.", now)
        case ChooseRoom(room):
            _choose(memory, hunt, room, now)
        case TypeDigit(digit):
            _type(memory, hunt, digit, now)
        case FinishNumber():
            _finish(memory, hunt, now)
        case DontKnow():
            _ask_advice(memory, hunt, now)
        case StopRobot(robot):
            _stop(memory, hunt, memory.selected if robot is None else robot, now)
        case AskForRobot(robot):
            _ask_back(memory, hunt, memory.selected if robot is None else robot, now)
        case ShowNext():
            _put_aside(memory, hunt)
        case ShowWaiting(robot, room):
            _show(hunt, robot, room)
        case EndGame():
            if not _refused(memory, why_not_end(hunt.view), now):
                hunt.doubt = End()
        case _:
            _in_popup(memory, hunt, act, now)


def _in_popup(memory: Memory, hunt: Hunt, act: Act, now: float) -> None:
    """What is meant for the pop-up that was on the screen, if it is still the same."""
    item = memory.drawn.item
    if item is None or item != hunt.popups.shown:
        return
    if isinstance(act, GiveAnswer):
        _answer(memory, hunt, act.choice)
    elif isinstance(item, Find) and hunt.talk_about(item) is None and hunt.view.room(item.room).undecided:
        _with_treasure(memory, hunt, item, act, now)


def _with_treasure(memory: Memory, hunt: Hunt, item: Find, act: Act, now: float) -> None:
    view, room = hunt.view, item.room
    match act:
        case PickName(name):
            if room in hunt.named:
                return
            if name is None:
                hunt.picked.pop(room, None)
            elif name in view.names:
                hunt.picked[room] = name
                memory.history.announce(f"{name} is picked.")
        case TakeThePicture():
            if view.room(room).picture is None and not _refused(memory, why_not_picture(view, item.robot, room), now):
                _discuss(hunt, Discuss(item.robot, "take-picture", room))
        case NameIt():
            name = hunt.picked.get(room)
            if name is None:
                note(memory, "Pick a name from the list first.", now)
            elif not _refused(memory, why_not_name(view, item.robot, room), now):
                hunt.named[room] = name
                _discuss(hunt, Discuss(item.robot, "take-treasure", room))
        case LeaveIt():
            hunt.asked.ask(Leave(room), view)
        case _:
            pass


def _discuss(hunt: Hunt, wish: Discuss) -> None:
    """Talk it over, unless that is agreed on already."""
    if all((consent.matter, consent.room) != (wish.matter, wish.room) for consent in hunt.view.consents):
        hunt.asked.ask(wish, hunt.view)


def _answer(memory: Memory, hunt: Hunt, choice: int) -> None:
    if memory.drawn.dialogue is None:
        return
    answer = Answer(*memory.drawn.dialogue, choice)
    if not is_open(hunt.view, answer) or hunt.asked.answer(answer.dialogue, answer.turn) is not None:
        return
    hunt.asked.ask(answer, hunt.view)
    dialogue = next(talk for talk in hunt.view.dialogues if talk.dialogue == answer.dialogue)
    memory.history.answered(dialogue, choice)


def _select(memory: Memory, hunt: Hunt, robot: int) -> None:
    if not 0 <= robot < len(hunt.view.robots) or robot == memory.selected:
        return
    memory.selected = robot
    memory.typed = ""
    if memory.followed is not None:
        memory.followed = robot
    memory.history.announce(described(memory, hunt, robot))


def _choose(memory: Memory, hunt: Hunt, room: int, now: float) -> None:
    view, robot = hunt.view, memory.selected
    memory.typed = ""
    if not 0 < room <= len(view.rooms):
        note(memory, f"There is no room {room}. The rooms are 1 to {len(view.rooms)}.", now)
    elif hunt.goal_considered(robot) == room:
        if Talk(robot) in (*hunt.popups.waiting, hunt.popups.shown):
            hunt.popups.show(Talk(robot))
    elif not _refused(memory, why_not_go(view, robot, room), now):
        if view.robots[robot].moving_to is not None:
            hunt.doubt = Reroute(robot, room)
        else:
            _ask_to_go(memory, hunt, Select(robot, room))


def _ask_advice(memory: Memory, hunt: Hunt, now: float) -> None:
    robot = memory.selected
    already = isinstance(hunt.asked.going(robot), Unsure)
    if not already and not _refused(memory, why_not_ask(hunt.view, robot), now):
        _ask_to_go(memory, hunt, Unsure(robot))


def _ask_to_go(memory: Memory, hunt: Hunt, wish: Select | Unsure) -> None:
    """Talk about where to go, unless the robot would leave something behind that it can still name."""
    view, robot = hunt.view, wish.robot
    room = undecided_beside(view, robot)
    if room is not None and view.room(room).sensed and why_not_name(view, robot, room) is None:
        hunt.doubt = MoveOn(wish, room)
    else:
        memory.history.requested(robot, hunt.ask_to_go(wish))


def _meant(memory: Memory, hunt: Hunt, doubt: Doubt) -> None:
    hunt.doubt = None
    match doubt:
        case Reroute(robot, room):
            hunt.reroutes[robot] = room
            hunt.asked.ask(CallBack(robot), hunt.view)
        case MoveOn(wish, _):
            memory.history.requested(wish.robot, hunt.ask_to_go(wish))
        case End():
            hunt.asked.ask(GiveUp(hunt.view.game), hunt.view)


def _take_back(memory: Memory, hunt: Hunt) -> None:
    if hunt.doubt is not None:
        if hunt.doubt == memory.drawn.doubt:
            hunt.doubt = None
    else:
        memory.typed = ""


def _type(memory: Memory, hunt: Hunt, digit: int, now: float) -> None:
    memory.typed += str(digit)
    memory.typed_until = now + TYPING
    if len(memory.typed) >= len(str(len(hunt.view.rooms))):
        _finish(memory, hunt, now)
    else:
        memory.history.announce(f"{memory.typed}, and another digit, or Enter.")


def _finish(memory: Memory, hunt: Hunt, now: float) -> None:
    if memory.typed:
        _choose(memory, hunt, int(memory.typed), now)


def _stop(memory: Memory, hunt: Hunt, robot: int, now: float) -> None:
    if not 0 <= robot < len(hunt.view.robots):
        return
    if hunt.view.robots[robot].moving_to is None:
        note(memory, _stands(hunt.view, robot), now)
        return
    if _refused(memory, why_not_command(hunt.view, robot), now):
        return
    hunt.reroutes.pop(robot, None)
    hunt.asked.ask(CallBack(robot), hunt.view)


def _ask_back(memory: Memory, hunt: Hunt, robot: int, now: float) -> None:
    if not 0 <= robot < len(hunt.view.robots):
        return
    asked = hunt.view.robots[robot]
    if not asked.other_commander:
        note(memory, f"You command {robot_name(robot)} yourself.", now)
    elif asked.asked_back:
        note(memory, f"You have just asked for {robot_name(robot)}. You can ask again in some seconds.", now)
    else:
        hunt.asked.ask(AskBack(robot), hunt.view)


def _stands(view: View, robot: int) -> str:
    return why_not_work(view, robot) or "This robot is not on its way."


def _put_aside(memory: Memory, hunt: Hunt) -> None:
    item = hunt.popups.shown
    if item != memory.drawn.item:
        return
    if isinstance(item, Find):
        hunt.verdicts.pop(item.room, None)
    if isinstance(item, Talk) and hunt.asked.going(item.robot) is not None:
        hunt.asked.forget_going(item.robot)
    else:
        hunt.popups.put_aside()


def _show(hunt: Hunt, robot: int, room: int | None) -> None:
    of_robot = (item for item in hunt.popups.waiting if item.robot == robot)
    item = next((item for item in of_robot if room is None or item == Find(robot, room)), None)
    if item is not None:
        hunt.popups.show(item)


def _refused(memory: Memory, reason: str | None, now: float) -> bool:
    """Say why something is not possible just now; whether it is not."""
    if reason is None:
        return False
    note(memory, reason, now)
    return True

"""The whole screen, out of what is remembered."""

from thbridge.hunt.events import Condition
from thbridge.hunt.rules import robot_name
from thbridge.roles.view import Agree
from ui.model.keys import HELP, help_lines, key_of
from ui.model.playing.cards import cards
from ui.model.playing.popups.ending import ending
from ui.model.playing.popups.finds import PATIENCE, find
from ui.model.playing.popups.questions import question
from ui.model.playing.popups.talks import going, title
from ui.model.playing.possible import standing_in
from ui.model.playing.queue import Find, Item, Talk
from ui.model.playing.state import Hunt, Memory
from ui.model.playing.tiles import dont_know, end, tiles
from ui.model.playing.words import titled, verdict_words
from ui.model.screen import (
    Action,
    AgreeToTakePart,
    Banner,
    DialoguePop,
    DontKnow,
    EndGame,
    FitMap,
    FollowRobot,
    Phase,
    Screen,
    ShowHelp,
    ShowWaiting,
    TreasurePop,
    Waiting,
)

WAITING_KEY = "W"
"""The second key of `ShowNext`: for a button that shows what waits, "Esc" would be a riddle."""


def compose(memory: Memory, now: float) -> Screen:
    """What is shown at this moment; what is to be read out is not in it yet."""
    hunt = memory.hunt
    phase = phase_of(memory)
    playing = hunt if phase is Phase.PLAYING else None
    return Screen(
        phase=phase,
        waiting_for=_waiting_for(memory) if phase is Phase.CONNECTING else "",
        consent="" if hunt is None or hunt.view.consent is None else hunt.view.consent,
        agree=_agree(hunt),
        banner=_banner(memory, now),
        game=0 if hunt is None else hunt.view.game,
        score=0 if hunt is None else hunt.view.score,
        gained=None if hunt is None else hunt.gained,
        cards=() if hunt is None else cards(memory, hunt),
        tiles=() if hunt is None else tiles(memory, hunt),
        dont_know=_not_now(DontKnow(), "Don't know") if playing is None else dont_know(memory, playing),
        end=_not_now(EndGame(), "End the game") if playing is None else end(playing),
        tools=_tools(memory, phase),
        pop=None if playing is None else _pop(memory, playing, now),
        question=None if playing is None else question(memory, playing),
        waiting=() if playing is None else _waiting(playing),
        history=memory.history.lines,
        ending=ending(hunt) if hunt is not None and phase is Phase.OVER else None,
        help=help_lines(0 if hunt is None else len(hunt.view.rooms)) if memory.helping else (),
        typed=memory.typed,
        announcement="",
        announced=0,
    )


def phase_of(memory: Memory) -> Phase:
    """Which page is to be shown."""
    if memory.hunt is None:
        return Phase.CONNECTING
    if memory.hunt.view.consent is not None:
        return Phase.CONSENT
    return Phase.PLAYING if memory.hunt.view.over is None else Phase.OVER


def changes(memory: Memory, now: float) -> float:
    """When the screen will be another if nothing happens until then."""
    due = [memory.connection.changes(now), memory.typed_until]
    if memory.note is not None:
        due.append(memory.note[1])
    if memory.hunt is not None:
        due += [since + PATIENCE for since in memory.hunt.pictured.values()]
    return min((time for time in due if time > now), default=float("inf"))


def _waiting_for(memory: Memory) -> str:
    if memory.connection.is_lost:
        return "The game cannot be reached. It is tried again by itself."
    if memory.connection.is_there:
        return "The game is there. Its robots are getting ready."
    return "Looking for the game."


def _banner(memory: Memory, now: float) -> Banner | None:
    trouble = memory.connection.trouble(now)
    view = None if memory.hunt is None else memory.hunt.view
    if trouble is not None and memory.connection.is_lost:
        return Banner(trouble, "bad")
    if view is not None and not view.ready:
        return Banner("The robots are not there just now. The game goes on as soon as they are.", "bad")
    if trouble is not None and view is not None and view.over is None:
        return Banner(trouble, "bad")
    if memory.note is not None and now < memory.note[1]:
        return Banner(memory.note[0], "note")
    if view is not None and view.over is None and all(robot.condition is Condition.SILENT for robot in view.robots):
        return Banner("No robot answers. Wait for one to answer again, or end the game.", "bad")
    if view is not None and view.over is None and all(robot.other_commander for robot in view.robots):
        return Banner("Others command all robots just now. You name what they find, and may ask for them back.", "note")
    return None


def _agree(hunt: Hunt | None) -> Action:
    act = AgreeToTakePart()
    if hunt is None or hunt.view.consent is None:
        return _not_now(act, "I agree")
    busy = Agree() in hunt.asked
    return Action(act, "I agree", key_of(act), not busy, "You take part in the study.", busy)


def _not_now(act: AgreeToTakePart | DontKnow | EndGame, label: str) -> Action:
    return Action(act, label, key_of(act), enabled=False, hint="Not just now.")


def _tools(memory: Memory, phase: Phase) -> tuple[Action, ...]:
    sheet = Action(ShowHelp(), "Close help" if memory.helping else "Help", HELP.keys[0], hint="All keys on one sheet.")
    if phase is not Phase.PLAYING:
        return (sheet,)
    robot = robot_name(memory.selected)
    follow = f"Follow {robot}" if memory.followed is None else f"Stop following {robot}"
    return (
        Action(FollowRobot(), follow, key_of(FollowRobot()), hint="Keeps it in the middle of the map."),
        Action(FitMap(), "Whole map", key_of(FitMap()), hint="Shows all of the map."),
        sheet,
    )


def _pop(memory: Memory, hunt: Hunt, now: float) -> DialoguePop | TreasurePop | None:
    match hunt.popups.shown:
        case Talk() as talk:
            return going(hunt, talk)
        case Find() as found:
            return find(hunt, memory.pictures, found, now)
        case None:
            return None


def _waiting(hunt: Hunt) -> tuple[Waiting, ...]:
    first = hunt.popups.next
    return tuple(
        Waiting(
            item.robot,
            _waits(hunt, item),
            Action(_showing(item), "Show", WAITING_KEY if item == first else "", hint=_waits(hunt, item)),
        )
        for item in hunt.popups.waiting
    )


def _showing(item: Item) -> ShowWaiting:
    return ShowWaiting(item.robot, item.room) if isinstance(item, Find) else ShowWaiting(item.robot)


def _waits(hunt: Hunt, item: Item) -> str:
    name = titled(item.robot)
    if isinstance(item, Talk):
        dialogue = hunt.talk(item.robot)
        return f"{name} is being asked" if dialogue is None else title(hunt, dialogue)
    about = hunt.talk_about(item)
    if about is not None:
        return title(hunt, about)
    room = hunt.view.room(item.room)
    if room.verdict is not None:
        return f"Room {item.room}: {verdict_words(room.verdict.name, room.verdict.points)}"
    if standing_in(hunt.view, item.room) is None:
        return f"{name} found something in room {item.room}"
    return f"{name} is in room {item.room}" + (" and found something" if room.sensed else "")

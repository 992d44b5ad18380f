"""The whole screen, made from the participant's memory."""

from dataclasses import replace

from sim.common.robot_numbers import robot_name
from thbridge.hunt.events import Condition
from thbridge.roles.view import GiveConsent
from ui.model.keys import HELP, WAITING_KEY, help_lines, is_letter, keyed
from ui.model.playing.cards import cards, nothing_waits
from ui.model.playing.memory.popup_queue import DestinationItem, PopupItem, TreasureItem
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.popups.confirmations import confirmation
from ui.model.playing.popups.dialogues import destination_popup, dialogue_title
from ui.model.playing.popups.game_over import game_over_page
from ui.model.playing.popups.treasures import PICTURE_TIMEOUT, treasure_popup
from ui.model.playing.sounds import why_silent
from ui.model.playing.tiles import dont_know, end, tiles
from ui.model.playing.words import outcome_of, progress_of, titled, verdict_words
from ui.model.rules_sheet import rules_of
from ui.model.screen import (
    Action,
    AgreeToTakePart,
    AskAdvice,
    Banner,
    DeclineToTakePart,
    DialoguePopup,
    EndGame,
    FitMap,
    FollowRobot,
    Phase,
    Screen,
    ShowHelp,
    ShowWaiting,
    SwitchSound,
    TreasurePopup,
    WaitingItem,
)


def compose(memory: ParticipantMemory, now: float) -> Screen:
    """The screen at this moment; announcements are not in it yet."""
    hunt = memory.hunt
    phase = phase_of(memory)
    playing = hunt if phase is Phase.PLAYING else None
    team = () if hunt is None else cards(memory, hunt)
    screen = Screen(
        phase=phase,
        waiting_for=_waiting_for(memory) if phase is Phase.CONNECTING else "",
        consent="" if hunt is None or hunt.view.consent is None else hunt.view.consent,
        agree=_agree(hunt),
        decline=keyed(DeclineToTakePart(), "I do not take part", hint="The window thanks you and ends."),
        banner=_banner(memory, now),
        game=0 if hunt is None or memory.once else hunt.view.game,
        score=0 if hunt is None else hunt.view.score,
        progress="" if hunt is None else _progress(hunt),
        cards=team,
        tiles=() if hunt is None else tiles(memory, hunt),
        ask_advice=_not_now(AskAdvice(), "Don't know") if playing is None else dont_know(memory, playing),
        end=_not_now(EndGame(), "End game") if playing is None else end(playing),
        tools=_tools(memory, playing),
        popup=None if playing is None else _popup(memory, playing, now),
        confirmation=None if playing is None else confirmation(memory, playing),
        waiting=() if playing is None else _waiting(playing),
        history=memory.history.lines,
        ending=game_over_page(hunt, memory.once) if hunt is not None and phase is Phase.OVER else None,
        help=_help(memory, hunt) if memory.help_open else (),
        typed=memory.typed,
        announcement="",
        announcement_number=0,
        rules=rules_of(hunt.view) if hunt is not None and memory.help_open else (),
        nothing_waits="" if playing is None else nothing_waits(team, answering=playing.popups.shown is not None),
    )
    screen = replace(screen, enlarged=_enlarged(hunt, screen))
    match screen.popup:
        case TreasurePopup(asks_for_name=True):
            return _without_letters(screen)
        case DialoguePopup(numbered=True):
            return _without_digits(screen)
        case _:
            return screen


def _progress(hunt: HuntMemory) -> str:
    left = sum(room.state != "visited" for room in hunt.view.rooms)
    return progress_of(hunt.seconds, left, len(hunt.view.rooms))


def _enlarged(hunt: HuntMemory | None, screen: Screen) -> bytes | None:
    """The picture of the pop-up, if it is to be shown large and nothing else lies above it."""
    if hunt is None or hunt.enlarged is None or screen.popup is None or screen.confirmation is not None or screen.help:
        return None
    return screen.popup.picture


def _without_digits(screen: Screen) -> Screen:
    """The screen without the numbers of rooms printed as keys: its pop-up has the digits for its answers."""
    return replace(screen, tiles=tuple(replace(tile, choose=replace(tile.choose, key="")) for tile in screen.tiles))


def _without_letters(screen: Screen) -> Screen:
    """The screen without letters printed beside its pop-up, which has the letters for its list of names."""

    def bare(action: Action) -> Action:
        return replace(action, key="") if is_letter(action.key) else action

    return replace(
        screen,
        cards=tuple(
            replace(card, stop=card.stop and bare(card.stop), ask_back=card.ask_back and bare(card.ask_back))
            for card in screen.cards
        ),
        ask_advice=bare(screen.ask_advice),
        end=bare(screen.end),
        tools=tuple(bare(tool) for tool in screen.tools),
        waiting=tuple(replace(item, show=bare(item.show)) for item in screen.waiting),
    )


def phase_of(memory: ParticipantMemory) -> Phase:
    """The page to be shown."""
    if memory.hunt is None:
        return Phase.CONNECTING
    if memory.hunt.view.consent is not None:
        return Phase.CONSENT
    return Phase.PLAYING if memory.hunt.view.over is None else Phase.OVER


def next_change(memory: ParticipantMemory, now: float) -> float:
    """Time at which the screen changes if nothing happens until then; infinite if never."""
    due = [memory.connection.next_change(now), memory.typed_until]
    if memory.note is not None:
        due.append(memory.note[1])
    if memory.hunt is not None:
        due += [since + PICTURE_TIMEOUT for since in memory.hunt.picture_times.values()]
        due += [memory.hunt.choice.until] if memory.hunt.choice is not None else []
    return min((time for time in due if time > now), default=float("inf"))


def _waiting_for(memory: ParticipantMemory) -> str:
    if memory.connection.is_lost:
        why = memory.connection.why_lost
        return f"The game cannot be reached. {why}{' ' if why else ''}It is tried again by itself."
    if memory.connection.is_there:
        return "The game is there. Its robots are getting ready."
    return "Looking for the game."


def _banner(memory: ParticipantMemory, now: float) -> Banner | None:
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


def _agree(hunt: HuntMemory | None) -> Action:
    act = AgreeToTakePart()
    if hunt is None or hunt.view.consent is None:
        return _not_now(act, "I agree")
    busy = hunt.pending.has_kind(GiveConsent)
    return keyed(act, "I agree", not busy, "You take part in the study.", busy)


def _not_now(act: AgreeToTakePart | AskAdvice | EndGame, label: str) -> Action:
    return keyed(act, label, enabled=False, hint="Not just now.")


def _help(memory: ParticipantMemory, hunt: HuntMemory | None) -> tuple[tuple[str, str], ...]:
    if hunt is None:
        return help_lines(memory.texts, 0)
    properties = any(not each.is_found for each in hunt.view.properties)
    argues = hunt.view.has_last_word is not None
    return help_lines(
        hunt.texts, len(hunt.view.rooms), why_silent(memory, hunt), properties=properties, numbered=argues
    )


def _sound(memory: ParticipantMemory, hunt: HuntMemory) -> tuple[Action, ...]:
    """The switch of the sound; none where the study is without sound."""
    if not hunt.view.sound:
        return ()
    why_not = why_silent(memory, hunt)
    hint = "Arrivals, finds, questions and points sound. All of it is also seen."
    return (keyed(SwitchSound(), "Mute" if memory.sound_on else "Unmute", not why_not, why_not or hint),)


def _tools(memory: ParticipantMemory, hunt: HuntMemory | None) -> tuple[Action, ...]:
    sheet = Action(ShowHelp(), "Help", HELP.keys[0], hint="Rules and keys on one sheet.")
    if hunt is None:
        return (sheet,)
    robot = robot_name(memory.selected)
    follow = "Follow" if memory.followed is None else "Unfollow"
    return (
        keyed(FollowRobot(), follow, hint=f"Keeps {robot} in the middle of the map."),
        keyed(FitMap(), "Whole map", hint="Shows all of the map."),
        *_sound(memory, hunt),
        sheet,
    )


def _popup(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> DialoguePopup | TreasurePopup | None:
    match hunt.popups.shown:
        case DestinationItem() as item:
            return destination_popup(hunt, item)
        case TreasureItem() as find:
            return treasure_popup(hunt, memory.pictures, find, now)
        case None:
            return None


def _waiting(hunt: HuntMemory) -> tuple[WaitingItem, ...]:
    first = hunt.popups.next
    return tuple(
        WaitingItem(
            item.robot,
            _waits(hunt, item),
            Action(_showing(item), "Show", WAITING_KEY if item == first else "", hint=_waits(hunt, item)),
        )
        for item in hunt.popups.waiting
    )


def _showing(item: PopupItem) -> ShowWaiting:
    return ShowWaiting(item.robot, item.room) if isinstance(item, TreasureItem) else ShowWaiting(item.robot)


def _waits(hunt: HuntMemory, item: PopupItem) -> str:
    name = titled(item.robot)
    if isinstance(item, DestinationItem):
        dialogue = hunt.destination_dialogue(item.robot)
        if dialogue is not None:
            return dialogue_title(hunt, dialogue)
        words = hunt.unread_words(item.robot)
        return f"{name} is being asked" if words is None else outcome_of(words)
    about = hunt.treasure_dialogue(item)
    if about is not None:
        return dialogue_title(hunt, about)
    room = hunt.view.room(item.room)
    if room.verdict is not None:
        return f"Room {item.room}: {verdict_words(room.verdict.name, room.verdict.points)}"
    if hunt.robot_in_room(item.room) is None:
        return f"{name} found something in room {item.room}"
    return f"{name} is in room {item.room}" + (" and found something" if room.found else "")

"""Pop-up of a treasure that a robot found, with the acts that are possible on it."""

from collections.abc import Sequence
from dataclasses import replace

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import TreasureIdentified, TreasureLeft
from thbridge.hunt.properties import Teller, TreasureProperty, value_in_words
from thbridge.hunt.rooms import Room
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import Consent, GiveUpTreasure, MeasureProperty, OpenDialogue, RoomView, View
from ui.model.keys import keyed
from ui.model.playing.memory.history import spoken
from ui.model.playing.memory.pictures import Pictures
from ui.model.playing.memory.popup_queue import TreasureItem
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.popups.dialogues import dialogue_popup
from ui.model.playing.possible import (
    ends_game,
    is_allowed,
    why_not_name,
    why_not_picture,
    why_not_request,
    why_not_work,
)
from ui.model.playing.words import counted, outcome_of, percent, titled, verdict_words
from ui.model.screen import (
    Action,
    AskWhatItIs,
    DialoguePopup,
    EnlargePicture,
    LeaveTreasure,
    SenseMore,
    ShowNext,
    SubmitName,
    TakeThePicture,
    TellOfIt,
    TreasureFact,
    TreasurePopup,
)

PICTURE_TIMEOUT = 5.0
"""Seconds after which a picture that was taken will not come any more; its sender may not have it."""


def treasure_popup(
    hunt: HuntMemory, pictures: Pictures, item: TreasureItem, now: float
) -> DialoguePopup | TreasurePopup:
    """The dialogue about a treasure if one is open, with what is known of it; else the treasure with its acts."""
    dialogue = hunt.treasure_dialogue(item)
    find = _treasure(hunt, pictures, item, now)
    if dialogue is None:
        return find
    talk = dialogue_popup(hunt, dialogue)
    return replace(talk, facts=_without_acts(find.facts or ()), picture=find.picture, enlarge=find.enlarge)


def _treasure(hunt: HuntMemory, pictures: Pictures, item: TreasureItem, now: float) -> TreasurePopup:
    view, room = hunt.view, hunt.view.room(item.room)
    picture = None if room.picture is None else pictures.of(view.game, item.room)
    later = keyed(ShowNext(), "Later", hint="It waits for you.")
    close = keyed(ShowNext(), "Close")
    return TreasurePopup(
        robot=item.robot,
        room=item.room,
        title=_title(hunt, item, room),
        facts=_facts(hunt, item, room) if room.found else None,
        take_picture=_take_picture(hunt, item, room),
        picture=picture,
        names=view.names,
        picked=hunt.submitted_names.get(item.room) or hunt.picked,
        name_it=_name_it(hunt, item),
        leave=_leave(hunt, item),
        verdict=_verdict(hunt, item, room),
        points=None if room.verdict is None else room.verdict.points,
        aside=later if room.undecided else close,
        picture_note=_picture_note(hunt, room, now) if picture is None else "",
        typed="" if hunt.choice is None else hunt.choice.typed(now),
        worth=view.worth,
        talk=_talk(hunt, item),
        unsure=_unsure(hunt, item),
        enlarge=None if picture is None else keyed(EnlargePicture(), "Enlarge", hint="Shows the picture large."),
        longest_name_it=max((_name_it(hunt, item, name) for name in view.names), key=_length, default=None),
    )


def _length(action: Action) -> int:
    return len(action.label) + len(action.hint)


def _verdict(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> str | None:
    """Outcome of a name; robots that decide in the end may have given it by themselves."""
    if room.verdict is None:
        return None
    words = verdict_words(room.verdict.name, room.verdict.points)
    decides = hunt.view.has_last_word == "robot" and not hunt.view.robots[item.robot].other_commander
    alone = decides and item.room not in hunt.named
    return f"{titled(item.robot)} has named it by itself. {words}" if alone else words


def _talk(hunt: HuntMemory, item: TreasureItem) -> str:
    """The end of a dialogue about this: what is left to do of an agreement, or what the robot said last."""
    words = hunt.last_words(item.robot)
    if words is None or words.matter == "select-room" or words.room != item.room:
        return ""
    if words.agreed:
        nameless = Consent(item.robot, "take-treasure", item.room) in hunt.view.consents
        open_name = nameless and item.room not in hunt.submitted_names
        return "You have agreed to name it. Pick what it is." if open_name else ""
    said = [sentence for speaker, sentence in spoken(words) if speaker == "robot"]
    # That nothing is done it has said as well, and it is said here anyhow.
    said = said[: -1 if words.is_told else None]
    return f"{outcome_of(words)} It said: {said[-1]}" if said else outcome_of(words)


def _facts(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> tuple[TreasureFact, ...]:
    """A line for each property that is known, can be sensed for energy, or is the participant's to tell."""
    facts = []
    for number, each in enumerate(hunt.view.properties, start=1):
        value, key = room.known.get(each.name, ""), f"Ctrl+{number}" if number < 10 else ""
        sense = _sense(hunt, item, room, each, value, key) if each.is_measured else None
        tell = _tell(hunt, room, each, value, key) if each.told_by is Teller.PERSON else ()
        if value or sense is not None or tell:
            facts.append(TreasureFact(each.label, value, each.drawn, sense, tell))
    return tuple(facts)


def _sense(
    hunt: HuntMemory, item: TreasureItem, room: RoomView, measured: TreasureProperty, value: str, key: str
) -> Action | None:
    """The act stays when the value is known: else what is below it would move under the pointer."""
    if not room.undecided or hunt.robot_in_room(item.room) is None:
        return None
    request = MeasureProperty(item.room, measured.name)
    busy = request in hunt.pending
    refused = why_not_request(hunt.known, item.robot, request)
    energy, cost = hunt.view.robots[item.robot].energy, energy_text(measured.cost)
    by = f", with its {measured.sensor}" if measured.sensor else ""
    hint = refused or f"Costs {cost} of {energy_text(energy)} energy{by}."
    if refused is None and energy - measured.cost < hunt.view.identify_cost <= energy:
        hint += " Then too little is left to name what it is."
    label = f"Sense the {measured.label.lower()}"
    if value:
        return Action(SenseMore(measured.name), label, key, enabled=False, hint=f"It is {value_in_words(value)}.")
    return Action(SenseMore(measured.name), label, key, refused is None and not busy, hint, busy)


def _tell(hunt: HuntMemory, room: RoomView, told: TreasureProperty, value: str, key: str) -> tuple[Action, ...]:
    """The values that the participant may say once there is a picture, the next one with the key."""
    if not room.undecided:
        return ()
    seen = room.picture is not None
    hint = "" if seen else "Take a picture first."
    after = (told.values.index(value) + 1) % len(told.values) if value in told.values else 0
    return tuple(
        Action(TellOfIt(told.name, each), each, key if number == after else "", each != value and seen, hint)
        for number, each in enumerate(told.values)
    )


def _without_acts(facts: Sequence[TreasureFact]) -> tuple[TreasureFact, ...]:
    return tuple(TreasureFact(fact.label, fact.value, fact.drawn) for fact in facts if fact.value)


def _title(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> str:
    name = titled(item.robot)
    gone = hunt.robot_in_room(item.room) is None
    if not room.undecided:
        return f"What {robot_name(item.robot)} found in room {item.room}" if gone else f"{name} in room {item.room}"
    if gone:
        return f"{name} found something in room {item.room} and was sent on"
    return f"{name} found something in room {item.room}" if room.found else f"{name} looks around in room {item.room}"


def _picture_note(hunt: HuntMemory, room: RoomView, now: float) -> str:
    if room.picture is None:
        return "" if hunt.robot_in_room(room.room) is not None or not room.undecided else "No picture was taken."
    if now < hunt.picture_times.get(room.room, now) + PICTURE_TIMEOUT:
        return "The picture is on its way."
    return "The picture cannot be shown here."


def _take_picture(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> Action | None:
    view, robot = hunt.view, hunt.view.robots[item.robot]
    if room.picture is not None or not room.undecided:
        return None
    asked = OpenDialogue(item.robot, "take-picture", item.room) in hunt.pending or any(
        (consent.matter, consent.room) == ("take-picture", item.room) for consent in view.consents
    )
    refused = why_not_picture(hunt.known, item.robot, item.room)
    hint = refused or f"Costs {energy_text(view.picture_cost)} of {energy_text(robot.energy)} energy."
    if refused is None and robot.energy - view.picture_cost < view.identify_cost <= robot.energy:
        hint += " Then too little is left to name what it is."
    return keyed(TakeThePicture(), "Take a picture", refused is None and not asked, hint, asked)


def _name_it(hunt: HuntMemory, item: TreasureItem, name: str | None = None) -> Action:
    """The act that names it as picked, or as it were for another name."""
    view = hunt.view
    picked = name or hunt.submitted_names.get(item.room) or hunt.picked
    busy = item.room in hunt.submitted_names
    refused = why_not_name(hunt.known, item.robot, item.room)
    if refused is None and picked is None:
        refused = "Pick a name first." if view.names else "Wait until it is known what it may be called."
    cost = f"Costs {energy_text(view.identify_cost)} energy. {_stakes(view, picked)}"
    if ends_game(hunt.known, TreasureIdentified(Room(item.room), item.robot, "", 0, view.identify_cost)):
        cost += " Then the game ends."
    label = "Name it" if picked is None else f"Name it {name_in_words(picked)}"
    return keyed(SubmitName(), label, refused is None and not busy, refused or cost, busy)


def _unsure(hunt: HuntMemory, item: TreasureItem) -> Action | None:
    if hunt.view.has_last_word is None:
        return None
    busy = OpenDialogue(item.robot, "take-treasure", item.room, "") in hunt.pending
    refused = why_not_name(hunt.known, item.robot, item.room)
    possible = refused is None and not busy and item.room not in hunt.submitted_names
    return keyed(AskWhatItIs(), "I don't know", possible, refused or "Asks the robot what it is; free.", busy)


def _stakes(view: View, picked: str | None) -> str:
    """The points that a name may win and lose, with their number where it is told."""
    worth = dict(zip(view.names, view.worth, strict=False)).get(picked or "")
    match view.wrong_share:
        case None:
            wrong = "may lose some"
        case 0.0:
            wrong = "loses none"
        case 1.0:
            wrong = "loses the points of what it is"
        case share:
            wrong = f"loses {percent(share)} of the points of what it is"
    right = "A right name wins points" if worth is None else f"If it is right, it wins {counted(worth, 'point')}"
    return f"{right}; a wrong one {wrong}."


def _leave(hunt: HuntMemory, item: TreasureItem) -> Action:
    busy = GiveUpTreasure(item.room) in hunt.pending
    possible = is_allowed(hunt.known, GiveUpTreasure(item.room))
    silent = why_not_work(hunt.known, item.robot)
    if not possible:
        hint = "This is decided."
    elif ends_game(hunt.known, TreasureLeft(Room(item.room))):
        hint = "Ends the game."
    else:
        hint = "Free, but for good." if hunt.robot_in_room(item.room) is None else "Free; can be undone."
    told = f"{silent} {hint}" if silent else hint
    return keyed(LeaveTreasure(), "Leave it", possible and not busy, told, busy)

"""Pop-up of a treasure that a robot found, with the possible acts."""

from collections.abc import Sequence
from dataclasses import replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import TreasureIdentified, TreasureLeft
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.view import Consent, LeaveTreasure, MeasureProperty, OpenDialogue, RoomView, View
from ui.model.playing.keys import keyed
from ui.model.playing.memory.history import spoken
from ui.model.playing.memory.pictures import Pictures
from ui.model.playing.memory.popup_queue import TreasureItem
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.popups.dialogues import dialogue_popup
from ui.model.playing.possible import (
    ends_game,
    is_allowed,
    why_not_find_out,
    why_not_name,
    why_not_picture,
    why_not_work,
)
from ui.model.playing.screen import (
    Action,
    AskWhatItIs,
    DialoguePopup,
    EnlargePicture,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    MeasurePropertyAct,
    ShowNext,
    TakePictureAct,
    TellPropertyAct,
    TreasureFact,
    TreasurePopup,
)
from ui.model.playing.seat_view import either, may_name, sees_energy, sees_score, teammates_who_name
from ui.model.playing.votes import vote_on_name
from ui.model.playing.words import outcome_of, percent, verdict_words

PICTURE_TIMEOUT = 5.0
"""Seconds after which the window stops waiting for a picture that may never arrive."""


def treasure_popup(
    hunt: HuntMemory, pictures: Pictures, item: TreasureItem, now: float
) -> DialoguePopup | TreasurePopup:
    """Return the pop-up of the open dialogue about a treasure; if there is none, return the treasure with its acts."""
    dialogue = hunt.treasure_dialogue(item)
    find = _treasure(hunt, pictures, item, now)
    if dialogue is None:
        return find
    talk = dialogue_popup(hunt, dialogue)
    return replace(talk, facts=_without_acts(find.facts or ()), picture=find.picture, enlarge=find.enlarge)


def _treasure(hunt: HuntMemory, pictures: Pictures, item: TreasureItem, now: float) -> TreasurePopup:
    texts, view, room = hunt.texts, hunt.view, hunt.view.room(item.room)
    picture = None if room.picture is None else pictures.of(view.game, item.room)
    later = keyed(ShowNext(), texts.text("popups.later"), hint=texts.text("popups.decide_later_hint"))
    close = keyed(ShowNext(), texts.text("popups.close"))
    enlarge = keyed(EnlargePicture(), texts.text("popups.enlarge"), hint=texts.text("popups.enlarge_hint"))
    named_here = may_name(view)
    return TreasurePopup(
        robot=item.robot,
        room=item.room,
        title=_title(hunt, item, room),
        facts=_facts(hunt, item, room) if room.found else None,
        take_picture=_take_picture(hunt, item, room),
        picture=picture,
        names=view.names if named_here else (),
        called=tuple(map(view.word_for, view.names)) if named_here else (),
        picked=hunt.submitted_names.get(item.room) or hunt.picked,
        name_it=_name_it(hunt, item),
        leave=_leave(hunt, item),
        verdict=_verdict(hunt, item, room),
        points=None if room.verdict is None or not sees_score(view) else room.verdict.points,
        aside=later if room.undecided else close,
        picture_note=_picture_note(hunt, room, now) if picture is None else "",
        typed="" if hunt.choice is None else hunt.choice.typed(now),
        worth=view.worth if named_here else (),
        talk=vote_on_name(hunt, item.room) or _others(hunt, room) or _talk(hunt, item),
        unsure=_unsure(hunt, item),
        enlarge=None if picture is None else enlarge,
        longest_name_it=max((_name_it(hunt, item, name) for name in view.names), key=_length, default=None),
        may_name=named_here,
    )


def _others(hunt: HuntMemory, room: RoomView) -> str:
    """Return a sentence that says which teammates may name an undecided treasure; empty if the participant may."""
    if may_name(hunt.view) or not room.undecided:
        return ""
    able = list(teammates_who_name(hunt.view))
    return hunt.texts.text("seats.who_names", seats=either(hunt.texts, able)) if able else ""


def _length(action: Action) -> int:
    return len(action.label) + len(action.hint)


def _verdict(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> str | None:
    """Return the result of naming a treasure, in words.

    If robots have the last word, a robot may have named the treasure alone; the result then says so.
    """
    if room.verdict is None:
        return None
    word = hunt.view.word_for(room.verdict.name)
    words = verdict_words(hunt.texts, word, room.verdict.points, shows_points=sees_score(hunt.view))
    decides = hunt.view.has_last_word == "robot" and not hunt.view.robots[item.robot].has_other_commander
    alone = decides and item.room not in hunt.named and hunt.view.team is None
    return f"{hunt.texts.text('popups.named_by_itself', robot=item.robot)} {words}" if alone else words


def _talk(hunt: HuntMemory, item: TreasureItem) -> str:
    """Return the result of the dialogue about a treasure: the next step after an agreement, or the last sentence."""
    words = hunt.last_words(item.robot)
    if words is None or words.matter == "select-room" or words.room != item.room:
        return ""
    if words.agreed:
        nameless = Consent(item.robot, "take-treasure", item.room) in hunt.view.consents
        open_name = nameless and item.room not in hunt.submitted_names
        return hunt.texts.text("popups.agreed_to_name") if open_name else ""
    said = [sentence for speaker, sentence in spoken(words) if speaker == "robot"]
    # If the robot's last sentence says that nothing is done, it is omitted, because the result says the same.
    said = said[: -1 if words.is_told else None]
    outcome = outcome_of(hunt.texts, words)
    return f"{outcome} {hunt.texts.text('popups.it_said', sentence=said[-1])}" if said else outcome


def _facts(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> tuple[TreasureFact, ...]:
    """Return a line for each property that is known, or can be sensed by the robot or reported by the participant."""
    facts = []
    for number, each in enumerate(hunt.view.properties, start=1):
        value, key = room.known.get(each.name, ""), f"Ctrl+{number}" if number < 10 else ""
        sense = _sense(hunt, item, room, each, value, key) if each.is_measured else None
        tell = _tell(hunt, room, each, value, key) if each.told_by is Teller.PERSON else ()
        if value or sense is not None or tell:
            facts.append(TreasureFact(each.label, value, each.drawn, sense, tell, each.shown(value)))
    return tuple(facts)


def _sense(
    hunt: HuntMemory, item: TreasureItem, room: RoomView, measured: TreasureProperty, value: str, key: str
) -> Action | None:
    """Return the button that senses a property.

    It stays when the value becomes known; otherwise the lines below would move away from the pointer.
    """
    if not room.undecided or hunt.robot_in_room(item.room) is None:
        return None
    request = MeasureProperty(item.room, measured.name)
    busy = request in hunt.pending
    texts, refused = hunt.texts, why_not_find_out(hunt.texts, hunt.known, request)
    hint = refused or _cost(hunt, item.robot, measured.cost, measured.sensor)
    label = texts.text("popups.sense", property=texts.noun(measured.label))
    if value:
        is_value = texts.text("popups.sensed", value=measured.word(value))
        return Action(MeasurePropertyAct(measured.name), label, key, enabled=False, hint=is_value)
    return Action(MeasurePropertyAct(measured.name), label, key, refused is None and not busy, hint, busy)


def _cost(hunt: HuntMemory, robot: int, cost: float, sensor: str = "") -> str:
    """Return the cost of sensing a property, with a warning if too little energy would remain to name the treasure."""
    texts, energy = hunt.texts, hunt.view.robots[robot].energy
    if not sees_energy(hunt.view):
        return ""
    hint = (
        texts.text("popups.costs_with", cost=cost, energy=energy, sensor=sensor)
        if sensor
        else texts.text("popups.costs", cost=cost, energy=energy)
    )
    if energy - cost < hunt.view.identify_cost <= energy:
        hint += f" {texts.text('popups.too_little_to_name')}"
    return hint


def _tell(hunt: HuntMemory, room: RoomView, told: TreasureProperty, value: str, key: str) -> tuple[Action, ...]:
    """Return a button for each value that the participant can report after a picture was taken.

    The key is printed on the button of the next value.
    """
    if not room.undecided or not may_name(hunt.view):
        return ()
    seen = room.picture is not None
    hint = "" if seen else hunt.texts.text("hints.picture_first")
    after = (told.values.index(value) + 1) % len(told.values) if value in told.values else 0
    return tuple(
        Action(
            TellPropertyAct(told.name, each),
            told.shown(each),
            key if number == after else "",
            each != value and seen,
            hint,
        )
        for number, each in enumerate(told.values)
    )


def _without_acts(facts: Sequence[TreasureFact]) -> tuple[TreasureFact, ...]:
    return tuple(TreasureFact(fact.label, fact.value, fact.drawn, words=fact.words) for fact in facts if fact.value)


def _title(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> str:
    if hunt.robot_in_room(item.room) is None:
        title = "found_and_sent_on" if room.undecided else "was_found"
    elif room.undecided:
        title = "found" if room.found else "looks"
    else:
        title = "decided"
    return hunt.texts.text(f"popups.{title}", robot=item.robot, room=item.room)


def _picture_note(hunt: HuntMemory, room: RoomView, now: float) -> str:
    if room.picture is None:
        is_over = hunt.robot_in_room(room.room) is None and room.undecided
        return hunt.texts.text("popups.no_picture") if is_over else ""
    is_late = now >= hunt.picture_times.get(room.room, now) + PICTURE_TIMEOUT
    return hunt.texts.text("popups.picture_lost" if is_late else "popups.picture_comes")


def _take_picture(hunt: HuntMemory, item: TreasureItem, room: RoomView) -> Action | None:
    view = hunt.view
    if room.picture is not None or not room.undecided:
        return None
    asked = OpenDialogue(item.robot, "take-picture", item.room) in hunt.pending or any(
        (consent.matter, consent.room) == ("take-picture", item.room) for consent in view.consents
    )
    refused = why_not_picture(hunt.texts, hunt.known, item.robot, item.room)
    hint = refused or _cost(hunt, item.robot, view.picture_cost)
    return keyed(TakePictureAct(), hunt.texts.text("popups.take_picture"), refused is None and not asked, hint, asked)


def _name_it(hunt: HuntMemory, item: TreasureItem, name: str | None = None) -> Action:
    """Return the button that gives the treasure the selected name or, if `name` is given, this name."""
    texts, view = hunt.texts, hunt.view
    picked = name or hunt.submitted_names.get(item.room) or hunt.picked
    busy = item.room in hunt.submitted_names
    refused = why_not_name(texts, hunt.known, item.robot, item.room) or vote_on_name(hunt, item.room)
    if refused is None and picked is None:
        refused = texts.text("hints.pick_first" if view.names else "hints.names_unknown")
    cost = texts.text("popups.naming_costs", cost=view.identify_cost) if sees_energy(view) else ""
    if sees_score(view):
        cost += f" {_stakes(texts, view, picked)}"
    if ends_game(hunt.known, TreasureIdentified(Room(item.room), item.robot, "", 0, view.identify_cost)):
        cost += f" {texts.text('popups.then_ends')}"
    cost = cost.strip()
    label = (
        texts.text("popups.name_it") if picked is None else texts.text("popups.name_it_so", name=view.word_for(picked))
    )
    return keyed(IdentifyTreasureAct(), label, refused is None and not busy, refused or cost, busy)


def _unsure(hunt: HuntMemory, item: TreasureItem) -> Action | None:
    if hunt.view.has_last_word is None:
        return None
    texts, busy = hunt.texts, OpenDialogue(item.robot, "take-treasure", item.room, "") in hunt.pending
    refused = why_not_name(texts, hunt.known, item.robot, item.room) or vote_on_name(hunt, item.room)
    possible = refused is None and not busy and item.room not in hunt.submitted_names
    hint = refused or texts.text("popups.unsure_hint")
    return keyed(AskWhatItIs(), texts.text("popups.unsure"), possible, hint, busy)


def _stakes(texts: Texts, view: View, picked: str | None) -> str:
    """Return a text on the points that a name can win and lose, with numbers if the study reveals them."""
    worth = dict(zip(view.names, view.worth, strict=False)).get(picked or "")
    right = texts.text("popups.right_wins") if worth is None else texts.text("popups.right_wins_points", count=worth)
    return f"{right} {_wrong(texts, view.wrong_share)}"


def _wrong(texts: Texts, share: float | None) -> str:
    match share:
        case None:
            return texts.text("popups.wrong_may_lose")
        case 0.0:
            return texts.text("popups.wrong_loses_none")
        case 1.0:
            return texts.text("popups.wrong_loses_all")
        case _:
            return texts.text("popups.wrong_loses_share", share=percent(texts, share))


def _leave(hunt: HuntMemory, item: TreasureItem) -> Action:
    texts, busy = hunt.texts, LeaveTreasure(item.room) in hunt.pending
    possible = is_allowed(hunt.known, LeaveTreasure(item.room))
    silent = why_not_work(texts, hunt.known, item.robot)
    if not possible:
        hint = texts.text("hints.refused_already_decided")
    elif ends_game(hunt.known, TreasureLeft(Room(item.room))):
        hint = texts.text("popups.leave_ends")
    else:
        gone = hunt.robot_in_room(item.room) is None
        hint = texts.text("popups.leave_for_good" if gone else "popups.leave_for_now")
    told = f"{silent} {hint}" if silent else hint
    return keyed(LeaveTreasureAct(), texts.text("popups.leave"), possible and not busy, told, busy)

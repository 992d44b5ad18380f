"""Effects of the participant's acts. Each act refers to the screen that the participant saw at that moment."""

from thbridge.hunt.events import Commander, ObjectionReason, TreasureLeft
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.team_notices import LONGEST_REASON, RaiseObjection, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    GiveConsent,
    HandOver,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    PlayAgain,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
    View,
)
from ui.model.playing.cards import card_sentence
from ui.model.playing.keys import shown_key
from ui.model.playing.memory.name_choice import NameChoice
from ui.model.playing.memory.popup_queue import DestinationItem, TreasureItem
from ui.model.playing.memory.state import (
    DepartUndecided,
    EndGameEarly,
    HandOverStep,
    HuntMemory,
    LeaveLastTreasure,
    LeaveWindow,
    ObjectionStep,
    ParticipantMemory,
    PendingStep,
    Reroute,
)
from ui.model.playing.objections import object_button
from ui.model.playing.people import do_with_people
from ui.model.playing.possible import (
    ends_game,
    left_beside,
    undecided_beside,
    why_not_ask,
    why_not_command,
    why_not_end,
    why_not_find_out,
    why_not_go,
    why_not_name,
    why_not_picture,
    why_not_stop,
)
from ui.model.playing.screen import (
    Act,
    AnswerDialogueAct,
    AskWhatItIs,
    Cancel,
    ChooseAddressee,
    ChooseRobot,
    CloseWindow,
    Confirm,
    ConsiderRoom,
    EndGameAct,
    EnlargePicture,
    FinishNumber,
    FitMap,
    FollowRobot,
    GiveConsentAct,
    HandOverAct,
    HandOverTo,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    MarkReadAct,
    MeasurePropertyAct,
    NextRobot,
    ObjectBecause,
    PickName,
    PlayAgainAct,
    RaiseObjectionAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    SayToPeopleAct,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowWaiting,
    StopRobotAct,
    SwitchSound,
    TakePictureAct,
    TakeUpTreasureAct,
    TellPropertyAct,
    TypeDigit,
    TypeLetter,
    VoteAct,
    WriteText,
)
from ui.model.playing.seat_view import decisions, may_name, takers, teammates_who_name
from ui.model.playing.sounds import why_silent
from ui.model.playing.view_update import is_open, note, settle
from ui.model.playing.votes import vote_on_end, vote_on_name

TYPING = 4.0
"""Seconds after which a typed digit is dropped if no other digit follows."""


def do(memory: ParticipantMemory, act: Act, now: float) -> None:
    """Carry out an act of the participant."""
    match act:
        case ShowHelp():
            memory.help_open = not memory.help_open
        case FitMap():
            memory.followed = None
        case ConsiderRoom(room):
            memory.hovered = room
        case SwitchSound():
            _switch_sound(memory, now)
        case ChooseAddressee() | WriteText() | SayToPeopleAct() | MarkReadAct() if memory.hunt is not None:
            do_with_people(memory, memory.hunt, act, now)
        case _ if memory.hunt is not None and memory.hunt.view.game == memory.last_drawn.game:
            _in_game(memory, memory.hunt, act, now)
            settle(memory, memory.hunt)


def _switch_sound(memory: ParticipantMemory, now: float) -> None:
    if memory.hunt is None:
        return
    why_not = why_silent(memory, memory.hunt)
    if why_not:
        note(memory, why_not, now)
        return
    memory.sound_on = not memory.sound_on
    note(memory, memory.texts.text("game.sound_on" if memory.sound_on else "game.sound_off"), now)


def _in_game(memory: ParticipantMemory, hunt: HuntMemory, act: Act, now: float) -> None:
    match act:
        case GiveConsentAct():
            if hunt.view.consent is not None and not hunt.pending.has_kind(GiveConsent):
                hunt.pending.ask(GiveConsent(memory.time_of_day()), hunt.view)
        case PlayAgainAct():
            if hunt.view.over is not None:
                hunt.pending.ask(PlayAgain(hunt.view.game), hunt.view)
        case FollowRobot():
            memory.followed = memory.selected if memory.followed is None else None
        case ChooseRobot(robot):
            _select(memory, hunt, robot)
        case NextRobot(step):
            _select(memory, hunt, (memory.selected + step) % len(hunt.view.robots))
        case _ if hunt.view.over is None and hunt.view.consent is None:
            _in_play(memory, hunt, act, now)


def _in_play(memory: ParticipantMemory, hunt: HuntMemory, act: Act, now: float) -> None:
    match act:
        case Confirm():
            if hunt.pending_step is not None and hunt.pending_step == memory.last_drawn.pending_step:
                _carry_out(memory, hunt, hunt.pending_step)
        case Cancel():
            _cancel(memory, hunt)
        case CloseWindow(ends):
            # The help sheet and other questions use the same keys as the answers, so this question replaces them.
            hunt.pending_step, memory.help_open = LeaveWindow(ends), False
        case HandOverTo(seat):
            _hand_over(memory, hunt, seat)
        case ObjectBecause(reason):
            _object(memory, hunt, reason)
        case VoteAct():
            _vote(hunt, act)
        case _ if hunt.pending_step is not None:
            note(memory, hunt.texts.text("hints.answer_first"), now)
        case SelectRoomAct(room):
            _choose(memory, hunt, room, now)
        case TypeDigit(digit):
            _type(memory, hunt, digit, now)
        case FinishNumber():
            _finish(memory, hunt, now)
        case RequestSuggestionAct():
            _ask_advice(memory, hunt, now)
        case StopRobotAct(robot):
            _stop(memory, hunt, memory.selected if robot is None else robot, now)
        case RequestHandbackAct(robot):
            _ask_back(memory, hunt, memory.selected if robot is None else robot, now)
        case HandOverAct(robot):
            _choose_taker(memory, hunt, memory.selected if robot is None else robot, now)
        case RaiseObjectionAct(text):
            _choose_reason(memory, hunt, text, now)
        case TakeUpTreasureAct(robot):
            _take_up(memory, hunt, memory.selected if robot is None else robot, now)
        case ShowNext():
            _put_aside(memory, hunt)
        case ShowWaiting(robot, room):
            _show(hunt, robot, room)
        case EnlargePicture():
            hunt.enlarged = None if hunt.enlarged is not None else hunt.popups.shown
        case EndGameAct():
            if not _refused(memory, why_not_end(hunt.texts, hunt.known) or vote_on_end(hunt), now):
                hunt.pending_step = EndGameEarly()
        case _:
            _in_popup(memory, hunt, act, now)


def _in_popup(memory: ParticipantMemory, hunt: HuntMemory, act: Act, now: float) -> None:
    """Carry out an act on the pop-up that the participant saw, if this pop-up is still shown."""
    item = memory.last_drawn.item
    if item is None or item != hunt.popups.shown:
        return
    if isinstance(act, AnswerDialogueAct):
        _answer(memory, hunt, act.choice)
    elif (
        isinstance(item, TreasureItem) and hunt.treasure_dialogue(item) is None and hunt.view.room(item.room).undecided
    ):
        _with_treasure(memory, hunt, item, act, now)


def _with_treasure(memory: ParticipantMemory, hunt: HuntMemory, item: TreasureItem, act: Act, now: float) -> None:
    view, room = hunt.view, item.room
    match act:
        case PickName(name):
            if room in hunt.submitted_names:
                return
            if name is None or name in view.names:
                _pick(memory, hunt, NameChoice(item, name))
        case TypeLetter(letter):
            if room not in hunt.submitted_names and view.names:
                choice = (hunt.choice or NameChoice(item)).typing(
                    letter, {name: view.word_for(name) for name in view.names}, now
                )
                _pick(memory, hunt, choice)
                if choice.name is None:
                    note(memory, hunt.texts.text("hints.no_such_name", letters=choice.letters), now, item)
        case TakePictureAct():
            if view.room(room).picture is None and not _refused(
                memory, why_not_picture(hunt.texts, hunt.known, item.robot, room), now
            ):
                _discuss(hunt, OpenDialogue(item.robot, "take-picture", room))
        case MeasurePropertyAct(name):
            asked = MeasureProperty(room, name)
            if not _refused(memory, why_not_find_out(hunt.texts, hunt.known, asked), now):
                hunt.pending.ask(asked, view)
        case TellPropertyAct(name, value):
            told = TellProperty(room, name, value)
            if not _refused(memory, why_not_find_out(hunt.texts, hunt.known, told), now):
                hunt.pending.ask(told, view)
        case IdentifyTreasureAct():
            name = hunt.picked
            if name is None:
                note(memory, hunt.texts.text("hints.pick_first"), now, item)
            elif name != memory.last_drawn.picked:
                return
            elif not _refused(memory, _why_not_name(hunt, item), now):
                hunt.submitted_names[room] = name
                hunt.named.add(room)
                memory.history.add_request(item.robot, hunt.texts.text("popups.say_name", name=view.word_for(name)))
                _discuss(hunt, OpenDialogue(item.robot, "take-treasure", room, name if _argues(view) else None))
        case AskWhatItIs():
            if _argues(view) and not _refused(memory, _why_not_name(hunt, item), now):
                memory.history.add_request(item.robot, hunt.texts.text("popups.say_unsure"))
                _discuss(hunt, OpenDialogue(item.robot, "take-treasure", room, ""))
        case LeaveTreasureAct() if not may_name(view):
            pass
        case LeaveTreasureAct():
            if ends_game(hunt.known, TreasureLeft(Room(room))):
                hunt.pending_step = LeaveLastTreasure(room)
            else:
                hunt.pending.ask(LeaveTreasure(room), view)
        case _:
            pass


def _why_not_name(hunt: HuntMemory, item: TreasureItem) -> str | None:
    return why_not_name(hunt.texts, hunt.known, item.robot, item.room) or vote_on_name(hunt, item.room)


def _pick(memory: ParticipantMemory, hunt: HuntMemory, choice: NameChoice) -> None:
    if choice.name is not None and choice.name != hunt.picked:
        memory.history.announce(hunt.texts.text("game.picked", name=hunt.view.word_for(choice.name)))
    hunt.choice = choice


def _argues(view: View) -> bool:
    """Return True if robots argue."""
    return view.has_last_word is not None


def _discuss(hunt: HuntMemory, request: OpenDialogue) -> None:
    """Request a dialogue about a matter, unless both sides already agree on the matter."""
    agreed = [each for each in hunt.view.consents if (each.matter, each.room) == (request.matter, request.room)]
    # An earlier agreement on another name does not count.
    if all(each.name not in {"", request.name} for each in agreed):
        hunt.pending.ask(request, hunt.view)


def _answer(memory: ParticipantMemory, hunt: HuntMemory, choice: int) -> None:
    if memory.last_drawn.dialogue is None:
        return
    answer = AnswerDialogue(*memory.last_drawn.dialogue, choice)
    if not is_open(hunt.view, answer) or hunt.pending.answer(answer.dialogue, answer.turn) is not None:
        return
    hunt.pending.ask(answer, hunt.view)
    dialogue = next(each for each in hunt.view.dialogues if each.dialogue == answer.dialogue)
    memory.history.add_answer(dialogue, choice)


def _select(memory: ParticipantMemory, hunt: HuntMemory, robot: int) -> None:
    if not 0 <= robot < len(hunt.view.robots):
        return
    if robot == memory.selected:
        hunt.popups.turn_to(robot)
        return
    memory.selected, memory.turned = robot, True
    memory.typed = ""
    hunt.popups.turn_to(robot)
    if hunt.view.has_last_word is not None:
        _show_talk(hunt, robot)
    if memory.followed is not None:
        memory.followed = robot
    memory.history.announce(card_sentence(memory, hunt, robot))


def _show_talk(hunt: HuntMemory, robot: int) -> None:
    """Show the dialogue with a robot that argues; if none is open, show the end of the last dialogue."""
    words = hunt.last_words(robot)
    if words is not None:
        hunt.read.discard(words.dialogue)
    if DestinationItem(robot) in hunt.popups.waiting or hunt.unread_words(robot) is not None:
        hunt.popups.show(DestinationItem(robot))


def _choose(memory: ParticipantMemory, hunt: HuntMemory, room: int, now: float) -> None:
    view, robot = hunt.view, memory.selected
    memory.typed = ""
    if not 0 < room <= len(view.rooms):
        note(memory, hunt.texts.text("hints.no_such_room", number=room, last=len(view.rooms)), now)
    elif hunt.destination_considered(robot) == room:
        if DestinationItem(robot) in (*hunt.popups.waiting, hunt.popups.shown):
            hunt.popups.show(DestinationItem(robot))
    elif not _refused(memory, why_not_go(hunt.texts, hunt.known, robot, room), now):
        if view.robots[robot].moving_to is not None:
            hunt.pending_step = Reroute(robot, room)
        else:
            _ask_to_go(memory, hunt, SelectRoom(robot, room))


def _ask_advice(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> None:
    robot = memory.selected
    already = isinstance(hunt.pending.destination_request(robot), RequestSuggestion)
    talk = hunt.destination_dialogue(robot)
    if talk is not None and talk.suggested:
        hunt.popups.show(DestinationItem(robot))
    elif not already and not _refused(memory, why_not_ask(hunt.texts, hunt.known, robot), now):
        _ask_to_go(memory, hunt, RequestSuggestion(robot))


def _ask_to_go(memory: ParticipantMemory, hunt: HuntMemory, request: SelectRoom | RequestSuggestion) -> None:
    """Ask a robot to go to a room, or to suggest a room.

    If the treasure in the robot's present room is not named yet, ask the participant for confirmation first.
    """
    view, robot = hunt.view, request.robot
    room = undecided_beside(hunt.known, robot)
    nameable = room is not None and (
        why_not_name(hunt.texts, hunt.known, robot, room) is None or any(teammates_who_name(view))
    )
    if room is not None and view.room(room).found and nameable:
        hunt.pending_step = DepartUndecided(request, room)
    else:
        memory.history.add_request(robot, hunt.ask_to_go(request))


def _carry_out(memory: ParticipantMemory, hunt: HuntMemory, step: PendingStep) -> None:
    hunt.pending_step = None
    match step:
        case Reroute(robot, room):
            hunt.reroutes[robot] = room
            hunt.pending.ask(StopRobot(robot), hunt.view)
        case DepartUndecided(request, _):
            memory.history.add_request(request.robot, hunt.ask_to_go(request))
        case EndGameEarly():
            hunt.pending.ask(EndGame(hunt.view.game), hunt.view)
        case LeaveWindow():
            memory.leaving = True
        case LeaveLastTreasure(room):
            hunt.pending.ask(LeaveTreasure(room), hunt.view)
        case HandOverStep() | ObjectionStep():
            pass  # Only the choice of a teammate, or of a reason, carries it out.


def _cancel(memory: ParticipantMemory, hunt: HuntMemory) -> None:
    if hunt.pending_step is not None:
        if hunt.pending_step == memory.last_drawn.pending_step:
            hunt.pending_step = None
    else:
        memory.typed = ""


def _type(memory: ParticipantMemory, hunt: HuntMemory, digit: int, now: float) -> None:
    memory.typed += str(digit)
    memory.typed_until = now + TYPING
    if len(memory.typed) >= len(str(len(hunt.view.rooms))):
        _finish(memory, hunt, now)
    else:
        memory.history.announce(
            hunt.texts.text("game.next_digit", digits=memory.typed, key=shown_key(hunt.texts, "Enter"))
        )


def _finish(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> None:
    if memory.typed:
        _choose(memory, hunt, int(memory.typed), now)


def _stop(memory: ParticipantMemory, hunt: HuntMemory, robot: int, now: float) -> None:
    if not 0 <= robot < len(hunt.view.robots) or _refused(memory, why_not_stop(hunt.texts, hunt.known, robot), now):
        return
    hunt.reroutes.pop(robot, None)
    hunt.pending.ask(StopRobot(robot), hunt.view)


def _ask_back(memory: ParticipantMemory, hunt: HuntMemory, robot: int, now: float) -> None:
    if not 0 <= robot < len(hunt.view.robots):
        return
    asked = hunt.view.robots[robot]
    if not asked.has_other_commander:
        note(memory, hunt.texts.text("hints.you_command", robot=robot), now)
    elif asked.commander is Commander.TEAMMATE and hunt.known.seat is not None and not hunt.known.seat.can_take_over:
        note(memory, hunt.texts.text("seats.not_yours"), now)
    elif asked.asked_back:
        note(memory, hunt.texts.text("hints.asked_already", robot=robot), now)
    else:
        hunt.pending.ask(RequestHandback(robot), hunt.view)


def _choose_taker(memory: ParticipantMemory, hunt: HuntMemory, robot: int, now: float) -> None:
    """Ask the participant to whom they hand over a robot."""
    if not 0 <= robot < len(hunt.view.robots) or _refused(memory, why_not_command(hunt.texts, hunt.known, robot), now):
        return
    if not takers(hunt.view):
        note(memory, hunt.texts.text("seats.no_taker"), now)
    else:
        hunt.pending_step, memory.help_open = HandOverStep(robot), False


def _hand_over(memory: ParticipantMemory, hunt: HuntMemory, seat: str) -> None:
    step = hunt.pending_step
    if isinstance(step, HandOverStep) and step == memory.last_drawn.pending_step:
        hunt.pending_step = None
        hunt.pending.ask(HandOver(step.robot, seat), hunt.view)


def _choose_reason(memory: ParticipantMemory, hunt: HuntMemory, text: str, now: float) -> None:
    """Ask the participant for the reason of an objection in the dialogue that they saw."""
    seen = memory.last_drawn.dialogue
    dialogue = next((each for each in hunt.view.dialogues if seen is not None and each.dialogue == seen[0]), None)
    if dialogue is None:
        note(memory, hunt.texts.text("objections.ended"), now)
        return
    button = object_button(hunt, dialogue)
    if button is not None and button.enabled:
        step = ObjectionStep(dialogue.dialogue, text.strip()[:LONGEST_REASON])
        hunt.pending_step, memory.help_open = step, False
    elif button is not None:
        note(memory, button.hint, now)


def _object(memory: ParticipantMemory, hunt: HuntMemory, reason: ObjectionReason) -> None:
    step = hunt.pending_step
    if isinstance(step, ObjectionStep) and step == memory.last_drawn.pending_step:
        hunt.pending_step = None
        hunt.pending.ask(RaiseObjection(step.dialogue, reason, step.text), hunt.view)


def _vote(hunt: HuntMemory, act: VoteAct) -> None:
    """Vote on a decision that is still open. The participant who proposed it has no vote."""
    own = "" if hunt.view.team is None else hunt.view.team.own.name
    if any(each.decision == act.decision and each.seat != own for each in decisions(hunt.view)):
        hunt.pending.ask(Vote(act.decision, act.agrees, act.reason.strip()[:LONGEST_REASON]), hunt.view)


def _take_up(memory: ParticipantMemory, hunt: HuntMemory, robot: int, now: float) -> None:
    room = left_beside(hunt.known, robot)
    if room is None:
        note(memory, hunt.texts.text("hints.nothing_to_undo", robot=robot), now)
    else:
        hunt.pending.ask(TakeUpTreasure(room), hunt.view)


def _put_aside(memory: ParticipantMemory, hunt: HuntMemory) -> None:
    item = hunt.popups.shown
    if item != memory.last_drawn.item:
        return
    if isinstance(item, TreasureItem):
        hunt.verdicts.pop(item.room, None)
    if isinstance(item, DestinationItem) and hunt.pending.destination_request(item.robot) is not None:
        hunt.pending.forget_destination(item.robot)
    elif hunt.reading is not None:
        if memory.last_drawn.dialogue is None:  # Otherwise the participant meant the open dialogue, which has ended.
            hunt.read.add(hunt.reading)
    else:
        hunt.popups.put_aside()


def _show(hunt: HuntMemory, robot: int, room: int | None) -> None:
    of_robot = (item for item in hunt.popups.waiting if item.robot == robot)
    item = next((item for item in of_robot if room is None or item == TreasureItem(robot, room)), None)
    if item is not None:
        hunt.popups.show(item)


def _refused(memory: ParticipantMemory, reason: str | None, now: float) -> bool:
    """Show the reason why an act is impossible at the moment; return True if there is a reason."""
    if reason is None:
        return False
    note(memory, reason, now)
    return True

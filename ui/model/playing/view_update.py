"""Updates of the participant's memory for each new view of the game."""

from collections.abc import Iterator, Sequence

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt import rules
from thbridge.hunt.events import Commander, TreasureLeft
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.participant_rules import Discussed, KeeperReason
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.team_notices import SayToPeople
from thbridge.roles.shared.view import (
    AnswerDialogue,
    IdentifyTreasure,
    OpenDialogue,
    ParticipantRequest,
    RobotView,
    RoomView,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    TakePicture,
    TakeUpTreasure,
    View,
)
from thbridge.text_protocol.wire.notice_format import kind_of
from ui.model.playing.memory.history import stopped_words
from ui.model.playing.memory.popup_queue import DestinationItem, PopupItem, TreasureItem
from ui.model.playing.memory.state import (
    DepartUndecided,
    EndGameEarly,
    HandOverStep,
    HuntMemory,
    LeaveLastTreasure,
    LeaveWindow,
    Note,
    ObjectionStep,
    ParticipantMemory,
    Reroute,
)
from ui.model.playing.objections import new_objections, objection_words, robot_of
from ui.model.playing.people import people_at_start, people_changes
from ui.model.playing.possible import (
    ends_game,
    why_not_ask,
    why_not_command,
    why_not_end,
    why_not_go,
    why_not_name,
    why_refused,
)
from ui.model.playing.seat_view import decision_about, is_own, label_of, may_name, sees_energy
from ui.model.playing.sounds import sounds_of
from ui.model.playing.votes import news_of, results_of
from ui.model.playing.words import commander_in_words, how_it_comes_back

NOTE = 6.0
"""Duration in seconds for which a note is shown."""


def note(memory: ParticipantMemory, sentence: str, now: float, about: PopupItem | None = None) -> None:
    """Show a sentence for a limited time, and announce it to screen readers.

    If the sentence is about a pop-up, it disappears when this pop-up is closed.
    """
    memory.note = Note(sentence, now + NOTE, about)
    memory.history.announce(sentence)


def receive_view(memory: ParticipantMemory, view: View, now: float) -> None:
    """Process a new view. If the view is of another game, the memory of the previous game is dropped."""
    hunt = memory.hunt
    if hunt is None or not _goes_on(hunt.view, view):
        _begin(memory, view)
        return
    before, former = hunt.view, hunt.known
    hunt.receive(view)
    hunt.most_energy = max([hunt.most_energy, *(robot.energy for robot in view.robots)])
    memory.history.receive(memory.texts, before, view)
    for sentence in people_changes(memory.texts, before.team, view.team):
        memory.history.add_event(sentence)
    memory.sounds += sounds_of(before, view)
    _receive_team(memory, before, view, now)
    _receive_refunds(memory, before, view, now)
    _receive_rooms(memory, hunt, before, former.state, now)
    _receive_commanders(memory, hunt, before, former.discussed, now)
    _receive_refusal(memory, hunt, now)
    for reason in hunt.pending.receive(hunt.texts, view):
        if reason:
            note(memory, reason, now)
    _reroute(memory, hunt, now)
    _drop_obsolete_step(memory, hunt, now)
    settle(memory, hunt)


def receive_tick(hunt: HuntMemory, tick: int) -> bool:
    """Process the newest tick of the simulation; return True if another second of the game has passed.

    The clock stops at the end of the game. If the window joins a game after the first game while the game is already in
    progress, the clock starts at that moment. The first game is in progress if a room was visited, or if an earlier
    program showed it.
    """
    if hunt.view.over is not None:
        return False
    before = hunt.seconds
    in_progress = hunt.is_continued or any(room.state != "unvisited" for room in hunt.view.rooms)
    joined_first = hunt.view.game == 1 and in_progress
    began = hunt.ticks[0] if hunt.ticks is not None else 0 if joined_first else tick
    hunt.ticks = min(began, tick), tick
    return hunt.seconds != before


def settle(memory: ParticipantMemory, hunt: HuntMemory) -> None:
    """Update all parts of the memory that depend on the view and on pending requests.

    The robot of the pop-up shown becomes the selected robot; otherwise two robots would look selected. If the map
    follows a robot, it now follows the robot of the pop-up, so that the room of the pop-up stays in sight. When the
    participant has selected a robot that can be sent, pop-ups of other robots do not open automatically, because the
    participant's next choice of a room is meant for the selected robot.
    """
    view = hunt.view
    hunt.submitted_names = {room: name for room, name in hunt.submitted_names.items() if _is_talked_over(hunt, room)}
    hunt.opening_sentences = {
        robot: sentence
        for robot, sentence in hunt.opening_sentences.items()
        if hunt.destination_dialogue(robot) is not None or hunt.pending.destination_request(robot) is not None
    }
    hunt.note_reading()
    at_hand = (
        memory.selected if memory.turned and why_not_ask(hunt.texts, hunt.known, memory.selected) is None else None
    )
    items = tuple(_items(hunt)) if view.over is None else ()
    hunt.popups.update(items, only_of=at_hand, quiet=[item for item in items if _is_quiet(hunt, item)])
    hunt.note_reading()
    if hunt.enlarged != hunt.popups.shown:
        hunt.enlarged = None
    if memory.note is not None and memory.note.about not in (None, hunt.popups.shown):
        memory.note = None
    if hunt.popups.shown is not None:
        memory.turned = False
        if hunt.popups.shown.robot != memory.selected:
            memory.selected, memory.typed = hunt.popups.shown.robot, ""
            memory.followed = None if memory.followed is None else memory.selected
    if hunt.choice is not None and not _asks_for_name(hunt, hunt.choice.item):
        hunt.choice = None


def open_requests(hunt: HuntMemory) -> tuple[ParticipantRequest, ...]:
    """Return all present requests.

    These are requests by the participant, requests that carry out agreements, and requests to sense treasures.
    """
    view = hunt.view
    if view.over is not None or view.consent is not None:
        return hunt.pending.requests
    agreed: list[ParticipantRequest] = []
    for consent in view.consents:
        match consent.matter:
            case "select-room" if decision_about(view, robot=consent.robot) is None:
                agreed.append(SendRobot(consent.robot, consent.room))
            case "take-picture":
                agreed.append(TakePicture(consent.room))
            case "take-treasure" if decision_about(view, room=consent.room) is not None:
                pass  # The team votes on it.
            case "take-treasure" if name := consent.name or hunt.submitted_names.get(consent.room, ""):
                agreed.append(IdentifyTreasure(consent.room, name))
    sense = [
        SenseTreasure(room.room) for room in view.rooms if room.undecided and not room.found and _can_look(hunt, room)
    ]
    return (*hunt.pending.requests, *agreed, *sense)


def _can_look(hunt: HuntMemory, room: RoomView) -> bool:
    """Return True if a robot of the participant is at rest in a room, and can sense the treasure there."""
    seat, state = hunt.known.seat, hunt.known.state
    if seat is not None and why_not_allowed(state, seat, SenseTreasure(room.room)) is not None:
        return False
    return isinstance(rules.sense(hunt.known.state, Room(room.room)), tuple)


def _begin(memory: ParticipantMemory, view: View) -> None:
    hunt = HuntMemory(memory.texts, view, is_continued=memory.hunt is None and bool(memory.history.lines))
    hunt.most_energy = max((robot.energy for robot in view.robots), default=0.0)
    if memory.hunt is not None:
        memory.history = memory.history.following()
        if memory.hunt.view.game == view.game:
            memory.pictures.forget()
    memory.hunt = hunt
    memory.typed, memory.note = "", None
    memory.sounds.clear()
    memory.selected = min(memory.selected, max(len(view.robots) - 1, 0))
    if view.team is not None:
        own = [robot.robot for robot in view.robots if not robot.has_other_commander]
        memory.selected = memory.selected if memory.selected in own else next(iter(own), memory.selected)
    memory.followed = None if memory.followed is None else memory.selected
    memory.motions = ()
    memory.last_refusal = 0 if view.refusal is None else view.refusal.number
    is_new = not memory.history.lines
    memory.history.receive(memory.texts, None, view, once=memory.once)
    memory.talk.begin(view.game)
    for sentence in people_at_start(memory.texts, view) if is_new else ():
        memory.history.add_event(sentence)
    settle(memory, hunt)


def _goes_on(before: View, view: View) -> bool:
    """Return True if a view is of the same game. Within a game, known facts never become unknown again."""
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


def _receive_refunds(memory: ParticipantMemory, before: View, view: View, now: float) -> None:
    """Show a note about each robot that stopped on its path and got energy back. The history has announced this."""
    for was, robot in zip(before.robots, view.robots, strict=True):
        stopped = was.moving_to and robot.moving_to is None and view.room(was.moving_to).state != "visited"
        if stopped and robot.energy > was.energy:
            words = stopped_words(memory.texts, was, robot, shows_energy=sees_energy(view))
            memory.note = Note(words, now + NOTE)


def _receive_rooms(memory: ParticipantMemory, hunt: HuntMemory, before: View, former: GameState, now: float) -> None:
    texts, state = hunt.texts, hunt.known.state
    for old, new in zip(before.rooms, hunt.view.rooms, strict=True):
        place = Room(new.room)
        stander = state.standing_in(place)
        if new.picture is not None and old.picture is None:
            hunt.picture_times[new.room] = now
        if new.verdict is not None and old.verdict is None:
            worker = former.decider(place) if stander is None else stander
            if worker is not None:
                hunt.verdicts[new.room] = worker
        if stander is not None and old.left != new.left and hunt.view.over is None:
            _receive_left(memory, hunt, TreasureItem(stander, new.room), new.left, now)
        finder = former.standing_in(place)
        gone = state.standing_in(place) is None and state.decider(place) == finder
        if finder is not None and gone and hunt.view.over is None:
            if hunt.choice is not None and hunt.choice.item.room == new.room:
                hunt.choice = None
            yours = why_not_name(texts, hunt.known, finder, new.room) or texts.text("history.still_yours")
            sent_on = texts.text("history.sent_on", robot=finder, room=new.room)
            _announce(memory, f"{sent_on} {yours}", hunt.view.robots[finder], now)


def _receive_left(memory: ParticipantMemory, hunt: HuntMemory, item: TreasureItem, left: bool, now: float) -> None:
    """If the treasure was left, explain how the participant can return to it. Otherwise show the treasure."""
    if left:
        memory.note = Note(hunt.texts.text("history.left_for_now", room=item.room, robot=item.robot), now + NOTE)
        memory.history.announce(hunt.texts.text("history.can_take_up", robot=item.robot))
        return
    memory.note = None
    if TakeUpTreasure(item.room) in hunt.pending:
        hunt.popups.show(item)


def _receive_commanders(
    memory: ParticipantMemory, hunt: HuntMemory, before: View, discussed: Sequence[Discussed], now: float
) -> None:
    """Announce robots that another commander took over, gave back, or was asked to give back.

    If another commander takes over a robot, a dialogue about the robot's next room is canceled.
    """
    texts = hunt.texts
    for was, robot in zip(before.robots, hunt.view.robots, strict=True):
        if robot.asked_back and not was.asked_back:
            key = "seats.asked" if robot.commander is Commander.TEAMMATE else "history.asked_back"
            commander = _commander(texts, robot)
            asked = texts.text(key, commander=commander, seat=commander, robot=robot.robot)
            _announce(memory, asked, robot, now)
        if (was.commander, was.commander_name) == (robot.commander, robot.commander_name):
            continue
        if not robot.has_other_commander:
            key = "seats.yours" if was.commander is Commander.TEAMMATE else "history.yours_again"
            sentence = texts.text(key, robot=robot.robot)
        else:
            sentence = texts.text("history.commanded", robot=robot.robot, commander=_commander(texts, robot))
            sentence += f" {how_it_comes_back(texts, robot.commander, hunt.known.seat)}"
            mine = not was.has_other_commander
            if mine and any((about.robot, about.matter) == (robot.robot, "select-room") for about in discussed):
                sentence += f" {texts.text('history.talk_void')}"
        _announce(memory, sentence, robot, now)


def _receive_team(memory: ParticipantMemory, before: View, view: View, now: float) -> None:
    """Announce votes, and requests of teammates for robots of the participant."""
    for sentence in news_of(memory.texts, before, view):
        memory.history.add_event(sentence)
    if results := results_of(memory.texts, before, view):
        memory.note = Note(results, now + NOTE)
    for objection in new_objections(before, view):
        robot = robot_of(view, objection)
        if robot is not None:
            _announce(memory, objection_words(memory.texts, view, objection), view.robots[robot], now)
    asked = () if before.team is None else before.team.asked_for
    for robot, seat in () if view.team is None else view.team.asked_for:
        if (robot, seat) not in asked:
            wants = memory.texts.text("seats.wants", seat=label_of(view, seat), robot=robot)
            _announce(memory, wants, view.robots[robot], now)


def _is_quiet(hunt: HuntMemory, item: PopupItem) -> bool:
    """Return True if a pop-up is about a teammate's dialogue or treasure, so that it does not open by itself.

    A treasure that a teammate's robot found is the participant's only if they may name it, and that teammate may not.
    """
    view = hunt.view
    if view.team is None or not view.robots[item.robot].has_other_commander:
        return False
    if isinstance(item, DestinationItem):
        return True
    commander = view.robots[item.robot].commander_name
    finds = any(mate.seat.label == commander and mate.seat.names_treasures for mate in view.team.teammates)
    dialogue = hunt.treasure_dialogue(item)
    talks = dialogue is not None and is_own(view, dialogue.robot, dialogue.matter)
    return not may_name(view) or (finds and not talks)


def _commander(texts: Texts, robot: RobotView) -> str:
    return commander_in_words(texts, robot.commander, robot.commander_name)


def _announce(memory: ParticipantMemory, sentence: str, robot: RobotView, now: float) -> None:
    memory.history.add_event(sentence, robot.robot)
    memory.note = Note(sentence, now + NOTE)


def _receive_refusal(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> None:
    refusal = hunt.view.refusal
    number = 0 if refusal is None else refusal.number
    if number == memory.last_refusal:
        return
    memory.last_refusal = number
    if refusal is None:
        return
    if refusal.wish == kind_of(SayToPeople):
        memory.talk.restore()
    if refusal.reason == KeeperReason.NOT_AGREED_ON and hunt.view.team is not None:
        # The result of the vote is in the history already.
        hunt.pending.drop_refused(refusal)
        if refusal.wish == kind_of(IdentifyTreasure):
            hunt.submitted_names.clear()
        return
    sentence = why_refused(hunt.texts, hunt.known, refusal, hunt.pending.drop_refused(refusal))
    memory.note = Note(sentence, now + NOTE)
    memory.history.add_event(sentence)
    if refusal.wish == kind_of(IdentifyTreasure):
        hunt.submitted_names.clear()


def _reroute(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> None:
    """Ask each robot that was stopped to go to its new room as soon as the robot is at rest."""
    for robot, room in list(hunt.reroutes.items()):
        mover = hunt.view.robots[robot]
        if mover.moving_to is not None:
            continue
        del hunt.reroutes[robot]
        refused = why_not_go(hunt.texts, hunt.known, robot, room)
        if hunt.view.over is not None:
            continue
        if mover.place > 0 and hunt.view.room(mover.place).undecided:
            note(memory, hunt.texts.text("game.already_there", robot=robot, room=mover.place), now)
        elif refused is not None:
            note(memory, refused, now)
        else:
            memory.history.add_request(robot, hunt.ask_to_go(SelectRoom(robot, room)))


def _drop_obsolete_step(memory: ParticipantMemory, hunt: HuntMemory, now: float) -> None:
    """Drop the pending step if it makes no sense any more after the new view, and show the reason."""
    texts, reason = hunt.texts, None
    match hunt.pending_step:
        case Reroute(robot, room):
            place = hunt.view.robots[robot].place
            arrived = hunt.view.robots[robot].moving_to is None
            reason = (
                texts.text("game.there_now", robot=robot, room=place)
                if arrived
                else why_not_go(texts, hunt.known, robot, room)
            )
        case DepartUndecided(request, room):
            decided = not hunt.view.room(room).undecided or hunt.robot_in_room(room) != request.robot
            reason = why_not_command(texts, hunt.known, request.robot)
            if reason is None and decided:
                reason = texts.text("game.decided_by_now")
        case EndGameEarly():
            reason = why_not_end(texts, hunt.known)
        case LeaveLastTreasure(room):
            if not hunt.view.room(room).undecided:
                reason = texts.text("game.decided_by_now")
            elif not ends_game(hunt.known, TreasureLeft(Room(room))):
                reason = texts.text("game.something_left")
        case HandOverStep(robot):
            reason = why_not_command(texts, hunt.known, robot)
            if reason is None and hunt.view.over is not None:
                reason = texts.text("hints.refused_game_over")
        case ObjectionStep(number):
            if all(each.dialogue != number for each in hunt.view.dialogues):
                reason = texts.text("objections.ended")
        case LeaveWindow():
            reason = None if hunt.view.over is None else texts.text("hints.refused_game_over")
        case None:
            return
    if reason is not None:
        hunt.pending_step = None
        note(memory, reason, now)


def _is_talked_over(hunt: HuntMemory, room: int) -> bool:
    """Return True if naming the treasure in a room is requested, discussed or agreed."""
    if not hunt.view.room(room).undecided:
        return False
    asked = any(
        isinstance(request, OpenDialogue) and (request.matter, request.room) == ("take-treasure", room)
        for request in hunt.pending.requests
    )
    return asked or any((about.matter, about.room) == ("take-treasure", room) for about in hunt.known.discussed)


def _asks_for_name(hunt: HuntMemory, item: TreasureItem) -> bool:
    """Return True if this pop-up is shown and asks for a name, and no name has been submitted yet."""
    open_ = hunt.popups.shown == item and hunt.treasure_dialogue(item) is None
    return open_ and hunt.view.room(item.room).undecided and item.room not in hunt.submitted_names


def _items(hunt: HuntMemory) -> Iterator[PopupItem]:
    """Yield the pop-ups that should be open, in arbitrary order. The queue appends new pop-ups."""
    view = hunt.view
    for robot in view.robots:
        if (
            hunt.destination_dialogue(robot.robot) is not None
            or hunt.pending.destination_request(robot.robot) is not None
            or hunt.unread_words(robot.robot) is not None
        ):
            yield DestinationItem(robot.robot)
    for room in view.rooms:
        worker = hunt.known.state.decider(Room(room.room))
        if room.undecided and worker is not None:
            yield TreasureItem(worker, room.room)
        elif room.room in hunt.verdicts:
            yield TreasureItem(hunt.verdicts[room.room], room.room)


def is_open(view: View, answer: AnswerDialogue) -> bool:
    """Return True if a dialogue waits for this answer at this turn."""
    return any(
        (each.dialogue, each.turn) == (answer.dialogue, answer.turn) and 0 <= answer.choice < len(each.choices)
        for each in view.dialogues
    )

"""Cards of the robots, and sentences about their activities."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.rules import affordable
from thbridge.roles.shared.notices import RobotMotion
from thbridge.roles.shared.view import HandOver, RequestHandback, RobotView, StopRobot, TakeUpTreasure
from ui.model.playing.keys import key_of
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.possible import arrival_warning, is_allowed, left_beside, undecided_beside, why_not_command
from ui.model.playing.screen import (
    Action,
    ChooseRobot,
    HandOverAct,
    NextRobot,
    RequestHandbackAct,
    RobotCard,
    StopRobotAct,
    TakeUpTreasureAct,
)
from ui.model.playing.seat_view import (
    asker_of,
    decision_about,
    is_own,
    label_at_begin,
    label_of,
    sees_energy,
    takers,
)
from ui.model.playing.words import commanded_words, commander_in_words


def cards(memory: ParticipantMemory, hunt: HuntMemory) -> tuple[RobotCard, ...]:
    """Return one card per robot, in the team's order."""
    return tuple(_card(memory, hunt, robot) for robot in hunt.view.robots)


def moved_cards(
    hunt: HuntMemory, team: Sequence[RobotCard], motions: Sequence[RobotMotion], moved: Collection[int]
) -> tuple[RobotCard, ...]:
    """Return the cards after only the motions of these robots have changed."""
    return tuple(_moved_card(hunt, card, motions[card.robot]) if card.robot in moved else card for card in team)


def _moved_card(hunt: HuntMemory, card: RobotCard, motion: RobotMotion) -> RobotCard:
    robot = hunt.view.robots[card.robot]
    state = _state(hunt, robot, motion, stranded=_is_stranded(hunt, robot))
    return replace(card, state=state, progress=_progress(robot, motion))


def is_in_trouble(robot: RobotView) -> bool:
    """Return True if a robot has a problem that needs the participant's attention."""
    return robot.blocked or robot.condition is not Condition.WELL


def card_sentence(memory: ParticipantMemory, hunt: HuntMemory, robot: int) -> str:
    """Return the card of a robot as a sentence for screen readers."""
    texts, card = hunt.texts, _card(memory, hunt, hunt.view.robots[robot])
    energy = "" if card.energy is None else texts.clause("cards.energy", energy=card.energy)
    things = (card.place, card.state, energy, card.warning, card.commanded)
    return texts.text("cards.spoken", robot=robot, things=texts.forms.between.join(filter(None, things)))


def _card(memory: ParticipantMemory, hunt: HuntMemory, robot: RobotView) -> RobotCard:
    number, texts = robot.robot, hunt.texts
    selected = number == memory.selected
    considered = memory.considered() if selected else None
    if considered is None:
        considered = hunt.destination_considered(number)
    cost = None
    if considered is not None and robot.moving_to is None and hunt.view.room(considered).state == "unvisited":
        cost = hunt.view.costs_from(robot)[considered]
    motion, asker = memory.motion(number), asker_of(hunt.view, number)
    commander = commander_in_words(texts, robot.commander, robot.commander_name)
    commands = "seats.commands" if robot.commander is Commander.TEAMMATE else "cards.commanded"
    if not sees_energy(hunt.view):
        cost = None
    stranded, warning = _is_stranded(hunt, robot), _warning(hunt, robot)
    return RobotCard(
        robot=number,
        name=texts.text("window.robot", robot=number),
        selected=selected,
        energy=robot.energy if sees_energy(hunt.view) else None,
        energy_at_start=hunt.most_energy,
        cost=cost,
        affordable=cost is None or cost <= robot.energy,
        place=texts.room(robot.place, "in" if robot.moving_to is None else "from"),
        state=_state(hunt, robot, motion, stranded=stranded),
        trouble=is_in_trouble(robot) or stranded,
        progress=_progress(robot, motion),
        waits=sum(item.robot == number and item not in hunt.popups.quiet for item in hunt.popups.waiting),
        select=_select(memory, hunt, number, warning),
        stop=_stop(hunt, robot, selected),
        commander=commander,
        commanded=texts.clause(commands, commander=commander, seat=commander) if commander else "",
        ask_back=_ask_back(hunt, robot, selected),
        take_up=_take_up(hunt, robot, selected),
        warning=warning,
        holder=_holder(hunt, commander, asker),
        hand_over=_hand_over(hunt, robot, selected),
        asked_for=bool(asker),
    )


def _holder(hunt: HuntMemory, commander: str, asker: str) -> str:
    """Return the words about the party that commands a robot; empty in a game with one participant."""
    if hunt.view.team is None:
        return ""
    if asker:
        return hunt.texts.text("seats.asks_for", seat=label_of(hunt.view, asker))
    return label_at_begin(commander) or hunt.texts.text("window.you")


def _hand_over(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    if robot.has_other_commander or hunt.view.over is not None or not takers(hunt.view):
        return None
    busy = any(isinstance(each, HandOver) and each.robot == robot.robot for each in hunt.pending.requests)
    texts, key = hunt.texts, key_of(HandOverAct()) if selected else ""
    hint = texts.text("seats.hand_over_hint", robot=robot.robot)
    return Action(HandOverAct(robot.robot), texts.text("seats.hand_over"), key, not busy, hint, busy)


def _select(memory: ParticipantMemory, hunt: HuntMemory, robot: int, warning: str) -> Action:
    team = len(hunt.view.robots)
    key = ""
    for step in (-1, 1):
        if team > 1 and robot == (memory.selected + step) % team:
            key = key_of(NextRobot(step))
    chosen = robot == memory.selected
    texts = hunt.texts
    yours = texts.text("cards.you_command" if chosen else "cards.command", robot=robot)
    hint = why_not_command(texts, hunt.known, robot) or yours
    if warning:
        hint += f" {texts.text('cards.on_arrival', warning=warning)}"
    return Action(ChooseRobot(robot), texts.text("window.robot", robot=robot), key, hint=hint)


def _stop(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    if not is_allowed(hunt.known, StopRobot(robot.robot)):
        return None
    texts, stopping = hunt.texts, _is_stopping(hunt, robot)
    refund = texts.text("cards.stop_hint" if sees_energy(hunt.view) else "seats.stop_hint")
    hint = texts.text("cards.stopping_hint", robot=robot.robot) if stopping else refund
    key = key_of(StopRobotAct()) if selected else ""
    return Action(StopRobotAct(robot.robot), texts.text("cards.stop"), key, not stopping, hint, stopping)


def _ask_back(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    if not robot.has_other_commander or hunt.view.over is not None:
        return None
    seat, is_mates = hunt.known.seat, robot.commander is Commander.TEAMMATE
    if is_mates and seat is not None and not seat.can_take_over:
        return None
    busy = RequestHandback(robot.robot) in hunt.pending
    asked = robot.asked_back or busy
    texts = hunt.texts
    hint = commanded_words(texts, robot.robot, robot.commander, robot.commander_name, seat)
    if asked:
        hint += f" {texts.text('cards.asked_back_hint')}"
    return Action(
        RequestHandbackAct(robot.robot),
        texts.text("cards.asked_back" if asked else "seats.ask_for" if is_mates else "cards.ask_back"),
        key_of(RequestHandbackAct()) if selected else "",
        not asked,
        hint,
        busy,
    )


def _take_up(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    room = left_beside(hunt.known, robot.robot)
    if room is None or robot.has_other_commander:
        return None
    busy = TakeUpTreasure(room) in hunt.pending
    key = key_of(TakeUpTreasureAct()) if selected else ""
    hint = hunt.texts.text("cards.take_up_hint", room=room, robot=robot.robot)
    return Action(TakeUpTreasureAct(robot.robot), hunt.texts.text("cards.take_up"), key, not busy, hint, busy)


def _progress(robot: RobotView, motion: RobotMotion) -> float | None:
    return None if robot.moving_to is None else round(min(max(motion.progress, 0.0), 1.0), 2)


def _state(hunt: HuntMemory, robot: RobotView, motion: RobotMotion, *, stranded: bool) -> str:
    texts = hunt.texts
    if stranded:
        return texts.text("cards.stranded")
    if robot.condition is Condition.SILENT:
        return texts.text("cards.silent")
    if robot.blocked and robot.moving_to is None:
        return texts.text("cards.blocked")
    if robot.moving_to is not None:
        return _driving(hunt, robot, motion, robot.moving_to)
    if robot.condition is Condition.LOST:
        return texts.text("cards.lost")
    return _resting(hunt, robot, motion)


def _driving(hunt: HuntMemory, robot: RobotView, motion: RobotMotion, goal: int) -> str:
    texts = hunt.texts
    if _is_stopping(hunt, robot):
        return texts.text("cards.stopping")
    if robot.condition is Condition.LOST:
        return texts.text("cards.lost_driving")
    if motion.makes_way_for is not None:
        return texts.clause("cards.making_way", robot=motion.makes_way_for)
    match motion.doing:
        case "waiting" if motion.waits_for is not None:
            return texts.clause("cards.waiting_for", robot=motion.waits_for)
        case "waiting" | "clearing":
            return texts.text(f"cards.{motion.doing}")
        case "planning" | "resting":
            return texts.clause("cards.planning", room=goal)
        case _:
            return texts.clause("cards.driving", room=goal)


def _resting(hunt: HuntMemory, robot: RobotView, motion: RobotMotion) -> str:
    number, texts = robot.robot, hunt.texts
    if hunt.view.over is not None:
        return texts.text("cards.over")
    voted = decision_about(hunt.view, robot=number)
    if voted is not None:
        return texts.text("votes.card", room=voted.room or 0)
    if hunt.pending.destination_request(number) is not None:
        return texts.text("cards.being_asked")
    if number in hunt.view.thinking:
        return texts.text("cards.thinking_where")
    talk = hunt.destination_dialogue(number)
    if talk is not None and not is_own(hunt.view, number, "select-room"):
        return texts.text("seats.talks")
    if talk is not None and not talk.choices:
        return texts.text("cards.thinking")
    if talk is not None:
        return texts.text("cards.asks" if hunt.view.has_last_word is None else "cards.waits_for_answer")
    goal = hunt.destination_considered(number)
    if goal is not None:
        return texts.clause("cards.setting_out", room=goal)
    room = undecided_beside(hunt.known, number)
    if room is not None:
        return texts.text("cards.found" if hunt.view.room(room).found else "cards.looking")
    if motion.makes_way_for is not None:
        return texts.clause("cards.making_way", robot=motion.makes_way_for)
    if robot.has_other_commander:
        return texts.text("cards.resting")
    return texts.text("cards.ready" if affordable(hunt.known.state, number) else "cards.nothing_to_do")


def nothing_waits(texts: Texts, team: Sequence[RobotCard], *, answering: bool) -> str:
    """Return the sentence to show when no pop-up waits. It names the robots that can be sent.

    Args:
        texts: texts of the game's language.
        team: the cards of all robots.
        answering: True if a pop-up is shown that the participant must answer.
    """
    is_ready = texts.text("cards.ready")
    ready = [card.robot for card in team if card.state == is_ready]
    if not ready:
        return "" if answering else texts.text("cards.nothing_waits")
    if len(ready) == 1:
        return texts.text("cards.one_ready", robot=ready[0])
    return texts.text("cards.several_ready", count=len(ready))


def _is_stopping(hunt: HuntMemory, robot: RobotView) -> bool:
    return StopRobot(robot.robot) in hunt.pending or robot.robot in hunt.reroutes


def _warning(hunt: HuntMemory, robot: RobotView) -> str:
    if robot.condition is not Condition.WELL or hunt.view.over is not None or _is_stopping(hunt, robot):
        return ""
    return arrival_warning(hunt.texts, hunt.known, robot.robot)


def _is_stranded(hunt: HuntMemory, robot: RobotView) -> bool:
    """Return True if this robot is at rest, and rooms are left but the robot has too little energy to reach them."""
    view, state = hunt.view, hunt.known.state
    if robot.moving_to is not None or is_in_trouble(robot) or view.over is not None:
        return False
    if undecided_beside(hunt.known, robot.robot) is not None or affordable(state, robot.robot):
        return False
    return any(view.costs_from(robot)[room.people] is not None for room in state.free_rooms)

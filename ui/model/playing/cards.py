"""Cards of the robots, and the sentences that describe a robot's activity."""

from collections.abc import Sequence

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import Condition
from thbridge.hunt.rules import affordable
from thbridge.roles.notices import RobotMotion
from thbridge.roles.view import CallBack, RequestHandback, RobotView, TakeUpTreasure
from ui.model.keys import key_of
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.possible import arrival_warning, is_allowed, left_beside, undecided_beside, why_not_command
from ui.model.playing.words import as_sentence, how_it_comes_back, place_name, titled
from ui.model.screen import Action, AskForRobot, ChooseRobot, NextRobot, RobotCard, StopRobot, TakeUpAgain

READY = "ready"
"""State of a robot that can be sent."""


def cards(memory: ParticipantMemory, hunt: HuntMemory) -> tuple[RobotCard, ...]:
    """One card per robot, in the team's order."""
    return tuple(_card(memory, hunt, robot) for robot in hunt.view.robots)


def is_in_trouble(robot: RobotView) -> bool:
    """Return True when something is wrong with a robot that people should worry about."""
    return robot.blocked or robot.condition is not Condition.WELL


def card_sentence(memory: ParticipantMemory, hunt: HuntMemory, robot: int) -> str:
    """The card of a robot as a sentence to be read out."""
    card = _card(memory, hunt, hunt.view.robots[robot])
    more = "".join(f", {words}" for words in (card.warning, card.commanded) if words)
    return f"{card.name}: {card.place}, {card.state}, {energy_text(card.energy)} energy{more}."


def _card(memory: ParticipantMemory, hunt: HuntMemory, robot: RobotView) -> RobotCard:
    number = robot.robot
    selected = number == memory.selected
    considered = memory.considered() if selected else None
    if considered is None:
        considered = hunt.destination_considered(number)
    cost = None
    if considered is not None and robot.moving_to is None and hunt.view.room(considered).state == "unvisited":
        cost = hunt.view.costs_from(robot)[considered]
    motion = memory.motion(number)
    place = place_name(robot.place)
    stranded, warning = _is_stranded(hunt, robot), _warning(hunt, robot)
    return RobotCard(
        robot=number,
        name=titled(number),
        selected=selected,
        energy=robot.energy,
        energy_at_start=hunt.most_energy,
        cost=cost,
        affordable=cost is None or cost <= robot.energy,
        place=f"in {place}" if robot.moving_to is None else f"from {place}",
        state="too little energy for any room" if stranded else _state(hunt, robot, motion),
        trouble=is_in_trouble(robot) or stranded,
        progress=None if robot.moving_to is None else round(min(max(motion.progress, 0.0), 1.0), 2),
        waits=sum(item.robot == number for item in hunt.popups.waiting),
        select=_select(memory, hunt, number, warning),
        stop=_stop(hunt, robot, selected),
        commander=robot.other_commander,
        ask_back=_ask_back(hunt, robot, selected),
        take_up=_take_up(hunt, robot, selected),
        warning=warning,
    )


def _select(memory: ParticipantMemory, hunt: HuntMemory, robot: int, warning: str) -> Action:
    team = len(hunt.view.robots)
    key = ""
    for step in (-1, 1):
        if team > 1 and robot == (memory.selected + step) % team:
            key = key_of(NextRobot(step))
    chosen = robot == memory.selected
    yours = f"You command {robot_name(robot)}." if chosen else f"Command {robot_name(robot)}."
    arriving = f" On arrival: {warning}." if warning else ""
    return Action(ChooseRobot(robot), titled(robot), key, hint=(why_not_command(hunt.known, robot) or yours) + arriving)


def _stop(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    if not is_allowed(hunt.known, CallBack(robot.robot)):
        return None
    stopping = _is_stopping(hunt, robot)
    hint = f"{titled(robot.robot)} is about to stop." if stopping else "The energy for the rest of the way comes back."
    return Action(StopRobot(robot.robot), "Stop", key_of(StopRobot()) if selected else "", not stopping, hint, stopping)


def _ask_back(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    if not robot.other_commander or hunt.view.over is not None:
        return None
    busy = RequestHandback(robot.robot) in hunt.pending
    asked = robot.asked_back or busy
    commander = as_sentence(f"{robot.other_commander} commands {robot_name(robot.robot)}")
    hint = f"{commander} {how_it_comes_back(robot.commander)}"
    if asked:
        hint += " You have asked for it, and can ask again in some seconds."
    return Action(
        AskForRobot(robot.robot),
        "Asked" if asked else "Ask for it back",
        key_of(AskForRobot()) if selected else "",
        not asked,
        hint,
        busy,
    )


def _take_up(hunt: HuntMemory, robot: RobotView, selected: bool) -> Action | None:
    room = left_beside(hunt.known, robot.robot)
    if room is None or robot.other_commander:
        return None
    busy = TakeUpTreasure(room) in hunt.pending
    key = key_of(TakeUpAgain()) if selected else ""
    hint = f"You left what is in room {room}. Until {robot_name(robot.robot)} sets out, you can take it up again."
    return Action(TakeUpAgain(robot.robot), "Take it up again", key, not busy, hint, busy)


def _state(hunt: HuntMemory, robot: RobotView, motion: RobotMotion) -> str:
    if robot.condition is Condition.SILENT:
        return "does not answer"
    if robot.blocked and robot.moving_to is None:
        return "no energy left"
    if robot.moving_to is not None:
        return _moving(hunt, robot, motion, place_name(robot.moving_to))
    if robot.condition is Condition.LOST:
        return "lost, does not know where it is"
    return _resting(hunt, robot, motion)


def _moving(hunt: HuntMemory, robot: RobotView, motion: RobotMotion, goal: str) -> str:
    if _is_stopping(hunt, robot):
        return "stopping"
    if robot.condition is Condition.LOST:
        return "lost, looking for its place"
    if motion.makes_way_for is not None:
        return _making_way(motion.makes_way_for)
    match motion.doing:
        case "waiting" if motion.waits_for is not None:
            return f"waiting for {robot_name(motion.waits_for)}"
        case "waiting":
            return "waiting for another robot"
        case "clearing":
            return "getting free"
        case "planning" | "resting":
            return f"looking for a way to {goal}"
        case _:
            return f"travelling to {goal}"


def _making_way(robot: int) -> str:
    return f"making way for {robot_name(robot)}"


def _resting(hunt: HuntMemory, robot: RobotView, motion: RobotMotion) -> str:
    number = robot.robot
    if hunt.view.over is not None:
        return "done"
    if hunt.pending.destination_request(number) is not None:
        return "is being asked"
    if number in hunt.view.thinking:
        return "is thinking about where to go"
    talk = hunt.destination_dialogue(number)
    if talk is not None:
        asks = "asks you something" if hunt.view.has_last_word is None else "waits for your answer"
        return asks if talk.choices else "is thinking"
    goal = hunt.destination_considered(number)
    if goal is not None:
        return f"about to set out for {place_name(goal)}"
    room = undecided_beside(hunt.known, number)
    if room is not None:
        return "found something" if hunt.view.room(room).found else "looking at what is here"
    if motion.makes_way_for is not None:
        return _making_way(motion.makes_way_for)
    if robot.other_commander:
        return "at rest"
    return READY if affordable(hunt.known.state, number) else "nothing left to do"


def nothing_waits(team: Sequence[RobotCard], *, answering: bool) -> str:
    """Return the sentence for people for whom no pop-up waits: which robots they may send.

    Args:
        team: the cards of all robots.
        answering: True while a pop-up is shown, which waits for them.
    """
    ready = [card.robot for card in team if card.state == READY]
    if not ready:
        return "" if answering else "Nothing waits for you"
    if len(ready) == 1:
        return f"{titled(ready[0])} is ready to be sent"
    return f"{len(ready)} robots are ready to be sent"


def _is_stopping(hunt: HuntMemory, robot: RobotView) -> bool:
    return CallBack(robot.robot) in hunt.pending or robot.robot in hunt.reroutes


def _warning(hunt: HuntMemory, robot: RobotView) -> str:
    if robot.condition is not Condition.WELL or hunt.view.over is not None or _is_stopping(hunt, robot):
        return ""
    return arrival_warning(hunt.known, robot.robot)


def _is_stranded(hunt: HuntMemory, robot: RobotView) -> bool:
    """Return True when rooms are left, and this robot at rest can reach none of them for want of energy alone."""
    view, state = hunt.view, hunt.known.state
    if robot.moving_to is not None or is_in_trouble(robot) or view.over is not None:
        return False
    if undecided_beside(hunt.known, robot.robot) is not None or affordable(state, robot.robot):
        return False
    return any(view.costs_from(robot)[room.people] is not None for room in state.free_rooms)

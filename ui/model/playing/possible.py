"""Acts that the rules allow, as far as a view shows it; for the others the reason, in words for a hint.

The game's own rules (`thbridge.hunt.rules`, `thbridge.roles.keeper.participant_requests`) decide. These functions tell
the same beforehand, so that no act is offered which would be refused. Those called `why_not_...` return the reason, or
None where the act is possible.
"""

from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import Condition
from thbridge.hunt.rules import robot_name
from thbridge.roles.view import Consent, DialogueMatter, DialogueView, RobotView, View
from ui.model.playing.words import how_it_comes_back, place_name, titled


def robot_in_room(view: View, room: int) -> int | None:
    """The robot that stands in a room and is not driving."""
    return next((robot.robot for robot in view.robots if robot.place == room and robot.moving_to is None), None)


def deciding_robot(view: View, room: int) -> int | None:
    """The robot that may name a treasure: it stands in the room, or found it and was sent on by others."""
    stander, known = robot_in_room(view, room), view.room(room)
    return known.robot if stander is None and known.undecided else stander


def undecided_beside(view: View, robot: int) -> int | None:
    """The room in which this robot stands beside a treasure that is neither named nor left."""
    place = view.robots[robot].place
    found = place > 0 and view.room(place).undecided and robot_in_room(view, place) == robot
    return place if found else None


def discussed_matters(view: View) -> tuple[tuple[int, DialogueMatter, int], ...]:
    """(robot, matter, room) of all open dialogues, and of all agreements that are not carried out yet."""
    matters: list[DialogueView | Consent] = [*view.dialogues, *view.consents]
    return tuple((matter.robot, matter.matter, matter.room) for matter in matters)


def competing_robot(view: View, robot: int, room: int) -> int | None:
    """Another robot that is in dialogue or agreement with the participant about going to this room."""
    others = (other for other, matter, about in discussed_matters(view) if (matter, about) == ("select-room", room))
    return next((other for other in others if other != robot), None)


def why_not_work(view: View, robot: int) -> str | None:
    """Reason why a robot can do nothing at all just now, or None."""
    if view.over is not None:
        return "The game is over."
    if view.robots[robot].condition is Condition.SILENT:
        return f"{titled(robot)} does not answer."
    if view.robots[robot].blocked:
        return f"{titled(robot)} has no energy left."
    return None


def why_not_command(view: View, robot: int) -> str | None:
    """Reason why the participant may not send or stop a robot just now, or None."""
    other = view.robots[robot].other_commander
    return f"{titled(robot)} is commanded by {other}. {how_it_comes_back(view.robots[robot])}" if other else None


def why_not_free(view: View, robot: int, room: int) -> str | None:
    """Reason why no robot, or not this one, may go to a room, whatever its place and energy; or None."""
    known = view.room(room)
    if known.state == "visited":
        return "This room has been visited."
    if known.state == "reserved":
        return f"{titled(robot if known.robot is None else known.robot)} is on its way there."
    other = competing_robot(view, robot, room)
    return None if other is None else f"{titled(other)} is asking you about this room."


def why_not_go(view: View, robot: int, room: int) -> str | None:
    """Reason why a robot cannot go to a room, or None; a robot that is driving would be called back first."""
    refused = why_not_work(view, robot) or why_not_command(view, robot) or why_not_free(view, robot, room)
    if refused is not None:
        return refused
    mover = view.robots[robot]
    # To the game, a robot that stops on its path stands in the corridor.
    place = mover.place if mover.moving_to is None else 0
    energy = mover.energy if mover.moving_to is None else mover.energy + energy_paid(view, mover)
    cost = view.costs[place][room]
    if cost is None:
        return f"There is no way there from {place_name(place)}."
    if cost > energy:
        return f"This costs {energy_text(cost)}; {robot_name(robot)} has {energy_text(energy)} energy."
    return None


def why_not_ask(view: View, robot: int) -> str | None:
    """Reason why a robot cannot be asked for advice, or None."""
    refused = why_not_work(view, robot) or why_not_command(view, robot)
    if refused is not None:
        return refused
    bound_for = view.robots[robot].moving_to
    if bound_for is not None:
        return f"{titled(robot)} is on its way to {place_name(bound_for)}."
    if all(why_not_go(view, robot, room.room) for room in view.rooms):
        return f"There is no room left that {titled(robot)} can go to."
    return None


def why_not_picture(view: View, robot: int, room: int) -> str | None:
    """Reason why a robot cannot take a picture in the room where it stands, or None."""
    return _why_not_pay(view, robot, room, robot_in_room(view, room), "A picture", view.picture_cost)


def why_not_name(view: View, robot: int, room: int) -> str | None:
    """Reason why the treasure in the room where a robot stands cannot be named, or None."""
    if view.room(room).verdict is not None or view.room(room).left:
        return "This is decided."
    return _why_not_pay(view, robot, room, deciding_robot(view, room), "Naming it", view.identify_cost)


def why_not_end(view: View) -> str | None:
    """Reason why the game cannot be ended just now, or None."""
    if view.over is not None:
        return "The game is over."
    moving = next((robot for robot in view.robots if robot.moving_to is not None), None)
    if moving is None:
        return None
    theirs = why_not_command(view, moving.robot)
    return f"{titled(moving.robot)} is still on its way. {theirs or 'Stop it, or wait for it.'}"


def energy_paid(view: View, robot: RobotView) -> float:
    """Energy that a robot has paid for the move it is making."""
    return 0.0 if robot.moving_to is None else view.costs[robot.place][robot.moving_to] or 0.0


def energy_warning(view: View, robot: int, room: int) -> str:
    """Warning that a robot's energy suffices to go to a room, but not to name its treasure; or empty."""
    mover = view.robots[robot]
    cost = view.costs[mover.place][room]
    if mover.moving_to is not None or cost is None or cost > mover.energy:
        return ""
    left = mover.energy - cost
    return "" if left > 0.0 and view.identify_cost <= left else "Enough to get there, not to name what is there."


def _why_not_pay(view: View, robot: int, room: int, worker: int | None, what: str, cost: float) -> str | None:
    refused = why_not_work(view, robot)
    if refused is not None:
        return refused
    if worker != robot:
        return f"{titled(robot)} is not in room {room} any more."
    energy = view.robots[robot].energy
    if cost > energy:
        return f"{what} costs {energy_text(cost)}; {robot_name(robot)} has {energy_text(energy)} energy."
    return None

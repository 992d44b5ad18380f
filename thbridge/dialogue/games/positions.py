"""Positions that a game can reach according to its table, for checks of a table before it is used."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from thbridge.dialogue.games.locutions import Locution
from thbridge.dialogue.games.tables import GameRole, GameTable, Reply, Slot

FormOf = Callable[[Reply], Locution]
"""Function that returns the locution of a reply, in the form that fits the content of the reply's slot."""


@dataclass(frozen=True, slots=True)
class TablePosition:
    """State of a game with the earlier statements that affect the next moves.

    Attributes:
        stage: name of the state.
        defender: the role (initiator or respondent) that made the last claim; None before there is a claim.
        is_announced: True if the argument for the claim was stated as a whole.
        is_offered: True if some of the support was stated.
    """

    stage: str
    defender: GameRole | None = None
    is_announced: bool = False
    is_offered: bool = False


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Reason why a reply is not legal in a position, and a remedy for the author of the table."""

    problem: str
    remedy: str


NO_CLAIM = Obstacle(
    "no earlier move makes a claim", "Add an earlier reply that makes a claim: its locution has the effect `claimed`"
)
_NOT_OFFERED = Obstacle("no earlier move states a support to refer to", "Let the defender say `of: support` first")
_NOT_ANNOUNCED = Obstacle("no earlier move states an argument to refer to", "Let the defender say `of: argument` first")
_TOO_LATE = Obstacle(
    "the argument as a whole comes before its support, not after it",
    "Move this reply to an earlier stage, or write support",
)
_OWN_WORDS = Obstacle(
    "it is the defender's turn, but this locution repeats what the other side has said",
    "Give the turn to the challenger, or use another locution",
)


def speaker_in(table: GameTable, position: TablePosition) -> GameRole | None:
    """Return the speaker: the initiator or the respondent.

    Return None if the table expects the defender or the challenger although there is no claim yet.
    """
    turn = table.stages[position.stage].turn
    if turn in {GameRole.INITIATOR, GameRole.RESPONDENT}:
        return turn
    if position.defender is None or turn is GameRole.DEFENDER:
        return position.defender
    return GameRole.RESPONDENT if position.defender is GameRole.INITIATOR else GameRole.INITIATOR


def refuses_support(table: GameTable, position: TablePosition, reply: Reply, form_of: FormOf) -> bool:
    """Return True if a reply does not accept a support that was given earlier. Arguments as in `obstacle`."""
    agrees = {"shown", "concluded"} & set(form_of(reply).after)
    return position.is_offered and speaker_in(table, position) is not position.defender and not agrees


def obstacle(table: GameTable, position: TablePosition, reply: Reply, form_of: FormOf) -> Obstacle | None:
    """Return the reason why a reply is never legal in a position, for any beliefs of both sides; or None.

    Args:
        table: the game.
        position: a position of the game.
        reply: a reply of the position's state.
        form_of: returns the forms of locutions.
    """
    if reply.slot not in {Slot.CLAIM, Slot.SUPPORT, Slot.ARGUMENT}:
        return None
    if position.defender is None:
        return NO_CLAIM
    form, defends = form_of(reply), speaker_in(table, position) is position.defender
    if reply.slot is Slot.ARGUMENT and position.is_offered:
        return _TOO_LATE
    if defends:
        return _OWN_WORDS if "said" in form.before and "said" in form.before_person else None
    if reply.slot is Slot.SUPPORT and not position.is_offered:
        return _NOT_OFFERED
    return _NOT_ANNOUNCED if reply.slot is Slot.ARGUMENT and not position.is_announced else None


def positions(table: GameTable, form_of: FormOf) -> tuple[TablePosition, ...]:
    """Return all positions that a play of a table can reach, in the order in which they are found.

    Args:
        table: the game.
        form_of: returns the forms of locutions.
    """
    found: dict[TablePosition, None] = {}
    waiting = [TablePosition(table.opening)]
    while waiting:
        position = waiting.pop()
        if position in found:
            continue
        found[position] = None
        if speaker_in(table, position) is None:
            continue
        for reply in table.stages[position.stage].replies:
            if obstacle(table, position, reply, form_of) is None:
                after = _after(table, position, reply, form_of)
                waiting += [replace(after, stage=name) for name in reply.targets if name in table.stages]
    return tuple(found)


def _after(table: GameTable, position: TablePosition, reply: Reply, form_of: FormOf) -> TablePosition:
    speaker, form = speaker_in(table, position), form_of(reply)
    if form.makes_claim and reply.slot in {Slot.TOPIC, Slot.OPPOSITE}:
        return TablePosition(position.stage, speaker)
    if reply.slot is Slot.SUPPORT and speaker is position.defender:
        return replace(position, is_offered=True)
    return replace(position, is_announced=True) if reply.slot is Slot.ARGUMENT else position

"""Check of state changes against a transition table."""

from collections.abc import Set


def check_transition(
    table: Set[tuple[type[object], str, type[object]]], state: object, event: str, following: object
) -> None:
    """Raise RuntimeError unless a transition table contains this transition.

    Args:
        table: all transitions, each with state, event and next state.
        state: the present state.
        event: cause of the change.
        following: the next state.
    """
    if (type(state), event, type(following)) not in table:
        raise RuntimeError(f"transition not allowed: from {state} to {following} by the event {event!r}")

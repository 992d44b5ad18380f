"""Events of a study with people."""

from thbridge.experiment.store.events import Clocks, NewEvent

NOON = Clocks("2026-01-02T12:00:00Z", 5_000_000_000, 12.5)


def answer(participant: str, text: str, step: int = 1) -> NewEvent:
    return NewEvent(
        "answer-given", "participant", NOON, participant, step, "supervisor", 0, {"item": "q1", "text": text}
    )

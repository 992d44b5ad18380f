"""Events of a study with people."""

from pathlib import Path

from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import Clocks, EventKind, JsonValue, LoggedEvent, NewEvent

NOON = Clocks("2026-01-02T12:00:00Z", 5_000_000_000, 12.5)


def answer(participant: str, text: str, step: int = 1) -> NewEvent:
    return NewEvent(
        "answer-given", "participant", NOON, participant, step, "supervisor", 0, {"item": "q1", "text": text}
    )


def data_of(folder: Path, kind: EventKind) -> list[dict[str, JsonValue]]:
    """Return the data of all events of a kind in the log of a study."""
    entries = ExperimentFolder(folder).entries()
    return [
        dict(each.event.data or {}) for each in entries if isinstance(each, LoggedEvent) and each.event.kind == kind
    ]

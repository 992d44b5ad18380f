"""Faults that trials have found in labs' programs."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TrialFault:
    """Fault of a lab's program, with the context in which it was first found.

    Attributes:
        problem: the problem as a clause.
        remedy: remedy, for the author of the program.
        position: context of the fault: the topic, the moves, or the offered sentence.
        times: number of times that the fault was found.
    """

    problem: str
    remedy: str
    position: tuple[str, ...]
    times: int = 1

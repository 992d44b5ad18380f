"""Faults of programs of labs that a trial has found."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TrialFault:
    """Fault of a program of a lab, where it was found first.

    Attributes:
        problem: the problem as a clause.
        remedy: what its author may do.
        position: where it was: what was talked about, said, or offered.
        times: number of times that it was found.
    """

    problem: str
    remedy: str
    position: tuple[str, ...]
    times: int = 1

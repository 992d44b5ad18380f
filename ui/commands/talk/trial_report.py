"""Report of a trial of a lab's program: faults and figures, as text and as JSON."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from thbridge.dialogue.trials.faults import TrialFault
from ui.commands.talk.check import counted

LONGEST = 5.0
"""Time limit of a call, seconds of wall time."""
MOST_SHOWN = 5
"""Maximum number of faults that are printed, each with its position."""


@dataclass(frozen=True, slots=True)
class TrialReport:
    """Report of a trial.

    Attributes:
        name: name of the program that was tried.
        summary: extent of the trial, as the beginning of a sentence.
        figures: extent of the trial as numbers, for programs.
        faults: faults that were found.
    """

    name: str
    summary: str
    figures: Mapping[str, object]
    faults: Sequence[TrialFault]

    @property
    def ok(self) -> bool:
        """True if there is no fault."""
        return not self.faults

    def lines(self) -> Iterator[str]:
        """Yield the output for people."""
        for fault in self.faults[:MOST_SHOWN]:
            times = "" if fault.times == 1 else f" ({fault.times} times)"
            yield f"{self.name}: {fault.problem}{times}. {fault.remedy}."
            yield from (f"  {line}" for line in fault.position)
        if len(self.faults) > MOST_SHOWN:
            yield f"{self.name}: {len(self.faults) - MOST_SHOWN} more faults; fix the faults above first"
        yield f"{self.summary}, {counted('fault', self.faults)}"

    def as_json(self) -> Mapping[str, object]:
        """Return the output for programs."""
        faults = [
            {"problem": fault.problem, "remedy": fault.remedy, "position": fault.position, "times": fault.times}
            for fault in self.faults
        ]
        return {"name": self.name, **self.figures, "faults": faults}

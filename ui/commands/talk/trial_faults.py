"""Words of faults that trials of programs of labs have found."""

from collections.abc import Iterator, Sequence

from thbridge.dialogue.trials.faults import TrialFault

MOST_SHOWN = 5
"""Greatest number of faults that are shown with their positions."""


def fault_lines(name: str, faults: Sequence[TrialFault]) -> Iterator[str]:
    """Yield what people are told of the faults of the program with this name."""
    for fault in faults[:MOST_SHOWN]:
        times = "" if fault.times == 1 else f" ({fault.times} times)"
        yield f"{name}: {fault.problem}{times}. {fault.remedy}."
        yield from (f"  {line}" for line in fault.position)
    if len(faults) > MOST_SHOWN:
        yield f"{name}: {len(faults) - MOST_SHOWN} more faults; mend these first"


def fault_as_json(fault: TrialFault) -> dict[str, object]:
    """Return what programs are told of a fault."""
    return {"problem": fault.problem, "remedy": fault.remedy, "position": fault.position, "times": fault.times}

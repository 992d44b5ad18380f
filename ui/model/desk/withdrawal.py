"""Sentences about the data that a withdrawal deletes."""

from collections.abc import Iterator

from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.withdrawal import WithdrawalPlan


def plan_lines(place: ExperimentFolder, plan: WithdrawalPlan) -> Iterator[str]:
    """Yield a line for each file and folder from which data will be deleted."""
    who = plan.withdrawal.participant
    yield f"The withdrawal of {who} is permanent:"
    yield f"  {place.log}: {_counted(plan.log_entries, 'entry', 'entries')} will be deleted."
    for path, (files, size) in plan.recordings.items():
        yield f"  {path}: {_counted(files, 'file', 'files')}, {size / 1e6:.1f} MB, will be deleted."
    for path in plan.exports:
        yield f"  {path}: this export will be written again without {who}."
    for path in plan.backups:
        yield f"  {path}: this backup will be updated without {who}."
    for path in plan.missing:
        yield f"  {path}: this folder is missing now. The withdrawal cannot finish until it is back."


def _counted(number: int, one: str, several: str) -> str:
    return f"{number} {one if number == 1 else several}"

"""`thbridge study restore`."""

from pathlib import Path

from thbridge.experiment.restore import RestorePlan, plan_restore, restore
from ui.command_line.confirmation import confirm
from ui.command_line.terminal import bad_input, command, note
from ui.commands.study.unfinished import finish_begun_withdrawals


def restore_study(backup: Path, to: Path | None, *, yes: bool) -> None:
    """Restore a study; ask for confirmation if its own log is intact and newer.

    Args:
        backup: the backup's folder.
        to: the study's folder. If None, it is the folder that was backed up.
        yes: True to skip the confirmation.
    """
    with bad_input():
        plan = plan_restore(backup, to)
        root = plan.study.root
        if plan.damage:
            note(plan.damage)
        if plan.newer:
            note(_newer(plan))
            confirm(f"Go back to the backup {backup}?", "Nothing was restored", yes=yes)
        kept, lacking = restore(plan)
    for sentence in lacking:
        note(sentence)
    if kept is not None:
        note(
            f"The previous files of {root} are kept in {kept}. Look at them with `{command('study', 'status', kept)}`."
        )
    note(f"{root} was restored from {backup}, with {plan.events} events. See `{command('study', 'status', root)}`.")
    finish_begun_withdrawals(root)


def _newer(plan: RestorePlan) -> str:
    return (
        f"The log of {plan.study.root} is intact, and has {plan.newer} events that the backup does not have. "
        "A restore keeps these events next to the study, and the study continues from the backup."
    )

"""Unfinished withdrawals of participants, which each command of a study completes first."""

from pathlib import Path

from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.errors import BadFile
from ui.command_line.terminal import note


def finish_begun_withdrawals(folder: Path) -> None:
    """Finish withdrawals that have begun, and print which steps are not possible yet."""
    try:
        pending = ExperimentFolder(folder).pending_withdrawals.read()
    except BadFile as fault:
        note(str(fault))
        return
    if pending:
        # These imports take a second, and are rarely needed.
        from ui.commands.study.withdrawal import finish_and_report

        finish_and_report(folder, pending)

"""`thbridge study withdraw`, and the completion of interrupted withdrawals."""

import time
from collections.abc import Sequence
from pathlib import Path

import typer

from thbridge.app.compose.machine import versions
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import deviations
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.events import Clocks
from thbridge.experiment.store.pending_withdrawals import PendingWithdrawal
from thbridge.experiment.withdrawal import (
    NobodyWithdraws,
    Withdrawal,
    finish_withdrawal,
    finish_withdrawals,
    plain,
    plan_withdrawal,
    withdraw,
)
from thbridge.files.errors import BadFile
from thbridge.timing.wall_clock import utc_now
from ui.command_line.confirmation import confirm
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note
from ui.model.desk.withdrawal import plan_lines


def finish_and_report(folder: Path, pending: Sequence[PendingWithdrawal]) -> list[Withdrawal]:
    """Finish withdrawals that have begun, and print which steps are not possible yet."""
    place = ExperimentFolder(folder)
    try:
        installed = versions()
        finished = finish_withdrawals(place, place.read(), installed, deviations(place, installed), _now)
    except BadFile as fault:
        finished = [Withdrawal(each.participant, each.code, failed=[str(fault)]) for each in pending]
    for one in finished:
        if one.failed:
            _report(one)
            note(_not_finished(folder, one))
        else:
            note(f"The interrupted withdrawal of {one.participant} is finished.")
    return finished


def withdraw_participant(folder: Path, named: str | None, gone: Sequence[Path], *, yes: bool) -> None:
    """Withdraw a participant after a confirmation.

    Args:
        folder: folder of the study.
        named: id or completion code of the participant. If None, `gone` must be given, and withdrawals that have begun
            are finished.
        gone: exports and backups that no longer exist.
        yes: True to skip the confirmation.
    """
    with bad_input():
        place = ExperimentFolder(folder)
        design = place.read()
        for path in gone:
            if path.exists():
                fail(BAD_INPUT, f"{path}: this folder exists. The withdrawal deletes data in this folder; omit --gone.")
            if not any([place.exports_known.remove(path), place.backups_known.remove(path)]):
                fail(BAD_INPUT, f"{path}: no export or backup of this study was written there. Check the path.")
        pending = place.pending_withdrawals.read()
        finished = finish_and_report(folder, pending) if pending else []
        if named is None and gone:
            raise typer.Exit(FAILED if any(one.failed for one in finished) else 0)
        ids = command("study", "status", folder)
        if named is None or not plain(named):
            fail(BAD_INPUT, f"Name the participant by their id or completion code. `{ids}` lists the ids.")
        for one in finished:
            if plain(named) in {plain(one.participant), plain(one.code)}:
                raise typer.Exit(FAILED if one.failed else 0)
        try:
            plan = plan_withdrawal(place, design, named)
        except NobodyWithdraws:
            who = f"{named}: the study has no data of a participant with this id or completion code."
            fail(BAD_INPUT, f"{who} `{ids}` lists the ids.")
        for line in plan_lines(place, plan):
            note(line)
        confirm(f"Delete all of this data about {plan.withdrawal.participant}?", "Nothing was deleted", yes=yes)
        installed = versions()
        one = withdraw(place, design, plan.withdrawal, installed, deviations(place, installed), _now)
    _report(one)
    if one.failed:
        fail(FAILED, _not_finished(folder, one))
    others = "If there are other copies of the folder, recordings, results or markers"
    note(f"{others}, delete {one.participant} from them.")


def withdraw_during(place: ExperimentFolder, conductor: Conductor, log: ExperimentLog, participant: str) -> str:
    """Withdraw a participant while this program runs the study.

    Returns:
        Sentences about tasks that a person must still do; empty if there are none.

    Raises:
        BadFile: see `withdraw`.
    """
    design, installed = place.read(), versions()
    try:
        plan = plan_withdrawal(place, design, participant)
    except NobodyWithdraws:
        # The withdrawal was requested twice.
        return ""
    place.pending_withdrawals.add(plan.withdrawal)
    conductor.withdraw(plan.withdrawal.participant)
    one = finish_withdrawal(place, design, log, plan.withdrawal, installed, deviations(place, installed), _now)
    return " ".join((*one.left, *one.failed))


def _now() -> Clocks:
    return Clocks(utc_now(), time.monotonic_ns())


def _report(one: Withdrawal) -> None:
    for sentence in (*one.done, *one.left, *one.failed):
        note(sentence)


def _not_finished(folder: Path, one: Withdrawal) -> str:
    gone = command("study", "withdraw", folder, "--gone", "PATH")
    return (
        f"The withdrawal of {one.participant} is not finished. Correct the problems above; the next command on this "
        f"study tries again. If an export or a backup no longer exists anywhere, run `{gone}`."
    )

"""Commands for studies with people: `thbridge study new`, `run`, `status`, `watch`, `freeze`, `backup`, ..."""

import shlex
import shutil
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from thbridge.timing.wall_clock import utc_now
from ui.command_line.option_sets import with_option_sets
from ui.command_line.options import (
    AsJson,
    ColourScheme,
    EngineOptions,
    LookOption,
    ProgressKind,
    ProgressOption,
)
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note, print_json, say
from ui.windows.display import why_no_window

if TYPE_CHECKING:
    from thbridge.batch.engines.engine import Engine

FolderOfExperiment = Annotated[Path, typer.Argument(help="The folder of an experiment.", metavar="FOLDER")]


def study_new(
    folder: Annotated[Path, typer.Argument(help="The folder to make; must not exist.", metavar="FOLDER")],
    language: Annotated[str, typer.Option(help="Language of all that participants read: en or de.")] = "en",
) -> None:
    """Begin a study with people: a folder with an example to change."""
    from thbridge.experiment.folder import example_languages, write_example
    from thbridge.files.disk.whole import new_folder

    if language not in example_languages():
        known = ", ".join(example_languages())
        fail(
            BAD_INPUT,
            f"--language: there is no example in {language}. Choose one of {known}; see `thbridge docs languages`.",
        )
    with bad_input(), new_folder(folder) as new:
        write_example(new, language)
    note(
        f"Wrote {folder}. Change its experiment.yaml and texts, in an editor or by "
        f"`{command('study', 'edit', folder)}`; then check it: `{command('study', 'check', folder)}`. "
        "`thbridge docs study-keys` explains all keys of its files."
    )


def study_status(folder: FolderOfExperiment, as_json: AsJson = False) -> None:
    """Tell who has taken part, how far they are, and how many are missing."""
    from thbridge.app.compose.machine import versions
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.freeze import deviations
    from thbridge.experiment.progress import Progress, lag_words
    from thbridge.experiment.recordings import told_leftovers
    from thbridge.experiment.store.event_log import read_log
    from thbridge.experiment.store.events import RunState
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place = ExperimentFolder(folder)
        design = place.read()
        entries = read_log(place.log) if place.log.exists() else ()
        progress = Progress(design).after(entries)
        left = list(told_leftovers(place, progress, entries))
        changed = deviations(place, versions())
    runs = list(progress.runs.values())
    counts = {str(state): sum(run.state is state for run in runs) for state in RunState}
    most = {run.participant: run.lag for run in runs if run.lag is not None}
    if as_json:
        told = {"changed": None if changed is None else list(changed), "recordings": left, "most_lag_seconds": most}
        print_json({"planned": design.allocation.size, **counts, **told})
        return
    say(f"{design.file.title}: {counts['complete']} of {design.allocation.size} runs that count")
    for run in runs:
        reason = f" ({run.reason})" if run.reason else ""
        number, steps = progress.step_count(run.participant)
        at = f", step {number} of {steps}" if run.state is RunState.UNDER_WAY else ""
        step, lag = (None, 0.0) if run.slowest is None else run.slowest
        slow = f", {step.name} up to {lag:.1f} s behind real time" if step is not None and lag >= 1.0 else ""
        say(f"  {run.participant}  {run.state}{reason}{at}{slow}")
    for sentence in (*left, *lag_words(progress)):
        say(sentence)
    if changed is None:
        say("Not frozen.")
    else:
        say("Frozen, and as it was." if not changed else f"Frozen; since then {'; '.join(changed)}.")


def study_watch(
    folder: FolderOfExperiment,
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Watch a study under way in a window: who is where, what is missing, events and notes. Nothing is changed."""
    from thbridge.experiment.folder import ExperimentFolder

    if not hosted:
        from ui.commands.study.unfinished import finish_begun_withdrawals
        from ui.sources.experiment import ExperimentSource

        finish_begun_withdrawals(folder)
        with bad_input():
            source = ExperimentSource(ExperimentFolder(folder), utc_now)
        reason = why_no_window()
        if reason is not None:
            fail(BAD_INPUT, f"{reason} Or see `{command('study', 'status', folder)}`.")
        from ui.windows.desk.program import show_folder

        raise typer.Exit(show_folder(source, look.value))
    from ui.windows.desk.program import show_hosted

    raise typer.Exit(show_hosted(ExperimentFolder(folder), look.value))


def study_run(
    folder: FolderOfExperiment,
    windowed: Annotated[bool, typer.Option("--windowed", help="In a window, not on the full screen.")] = False,
    desk: Annotated[
        bool, typer.Option("--desk/--no-desk", help="Open the researcher's window, too, for another screen.")
    ] = False,
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Have people go through the study at this computer, one after the other; after a crash it goes on where it was."""
    if hosted:
        from ui.windows.kiosk.window import open_kiosk

        raise typer.Exit(open_kiosk(look.value, windowed=windowed))
    from ui.first_start.bar import announce_start

    if why_no_window() is None:
        announce_start(look.value)

    from ui.commands.study.run import run_study

    run_study(folder, look.value, windowed=windowed, desk=desk)


def study_preview(
    folder: FolderOfExperiment,
    step: Annotated[
        str, typer.Argument(help="Name of a step, or its number in the file; by default all steps.", metavar="[STEP]")
    ] = "",
    condition: Annotated[
        str, typer.Option(help="Level within people, such as `collaborator`; by default the first.", metavar="LEVEL")
    ] = "",
    group: Annotated[str, typer.Option(help="Level between people; by default the first.", metavar="LEVEL")] = "",
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Show a step as participants see it, without the steps before it. Nothing is kept."""
    if hosted:
        from ui.windows.kiosk.window import open_kiosk

        raise typer.Exit(open_kiosk(look.value, windowed=True, title="Preview: nothing is kept"))
    from ui.commands.study.preview import preview_step
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    preview_step(folder, step, condition, group, look.value)


def study_freeze(folder: FolderOfExperiment) -> None:
    """Write the fingerprint of the experiment, for a preregistration; exports tell whether it still holds."""
    from thbridge.app.compose.machine import versions
    from thbridge.experiment.check import check_experiment
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.freeze import freeze
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place, installed = ExperimentFolder(folder), versions()
        check_experiment(place, installed)
        found = freeze(place, installed, utc_now())
    say(found.digest)
    note(f"Wrote {place.freeze}. Put this hash into the registration.")


def study_export(
    folder: FolderOfExperiment,
    to: Annotated[Path, typer.Option(help="The folder to write; must be empty or new.", metavar="DIR")],
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Export tables for pandas and R, as Psych-DS asks for, with scripts and a paragraph of methods."""
    from thbridge.app.compose.machine import versions
    from thbridge.experiment.export.folder import export_experiment
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.freeze import deviations
    from ui.command_line.progress import shown_progress
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input(), shown_progress(progress, "export"):
        place = ExperimentFolder(folder)
        design, installed = place.read(), versions()
        entries, changed = place.entries(), deviations(place, installed)
        written = export_experiment(place, design, entries, to, installed, changed)
    say(", ".join(f"{rows} {name}" for name, rows in written.rows.items()))
    for told in written.notes:
        note(told)
    python, r = shlex.join(["python", str(to / "analysis.py")]), shlex.join(["Rscript", str(to / "analysis.R")])
    note(f"Wrote {to}. Compare and draw its conditions by `{python}` or `{r}`.")


def study_backup(
    folder: FolderOfExperiment,
    to: Annotated[
        Path, typer.Option(help="The folder of the backup; one of before is brought up to date.", metavar="DIR")
    ],
) -> None:
    """Back up a study, also while people go through it: log, recordings and files, each verified."""
    from thbridge.experiment.backup import back_up
    from thbridge.experiment.folder import ExperimentFolder
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place = ExperimentFolder(folder)
        place.read()
        place.entries()
        lacking = back_up(place, to)
    for told in lacking:
        note(told)
    note(f"{to} is verified, and as the study is now. It can be used in its place: `{command('study', 'status', to)}`.")
    if lacking:
        raise typer.Exit(FAILED)


def study_restore(
    backup: Annotated[Path, typer.Argument(help="The folder of a backup.", metavar="BACKUP")],
    to: Annotated[
        Path | None,
        typer.Option(help="The folder of the study; by default the folder that was backed up.", metavar="STUDY"),
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Go back without asking if the study's own log is whole and newer.")
    ] = False,
) -> None:
    """Restore a study from a backup; what is replaced is kept, and those who withdrew since stay withdrawn."""
    from ui.commands.study.restore import restore_study

    restore_study(backup, to, yes=yes)


def study_withdraw(
    folder: FolderOfExperiment,
    participant: Annotated[
        list[str] | None,
        typer.Argument(
            help="Id of the participant, such as P-7K3FQ, or their completion code, with or without its blank.",
            metavar="PARTICIPANT",
        ),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Delete without asking, for scripts.")] = False,
    gone: Annotated[
        list[Path] | None,
        typer.Option(help="An export or a backup that no longer exists anywhere.", metavar="PATH"),
    ] = None,
) -> None:
    """Delete one participant for good from log, recordings, exports and backups, after showing what that is."""
    from ui.commands.study.withdrawal import withdraw_participant

    withdraw_participant(folder, " ".join(participant) if participant else None, gone or (), yes=yes)


def study_rehearse(
    folder: FolderOfExperiment,
    to: Annotated[
        Path,
        typer.Option(help="Folder for the rehearsal, a copy; must not exist.", metavar="DIR"),
    ],
    seed: Annotated[int, typer.Option(help="All that simulated people do follows from it.", min=0, max=2**31 - 1)] = 1,
    games: Annotated[bool, typer.Option("--games/--no-games", help="Whether games are played and recorded.")] = True,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Have simulated people go through the whole experiment; what they are like stands in its `rehearsal.yaml`."""
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.freeze import data_of
    from thbridge.experiment.rehearsal.people import read_people
    from thbridge.experiment.rehearsal.rehearsal import rehearse
    from thbridge.files.disk.whole import new_folder
    from ui.command_line.progress import shown_progress
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place = ExperimentFolder(folder)
        design = place.read(with_files=True)
        people = read_people(place.people, design)
        if to.exists():
            fail(BAD_INPUT, f"{to}: there is such a folder already. Choose another by --to.")
        with (
            new_folder(to, "choose another by --to, or make room") as new,
            shown_progress(progress, "rehearsal") as tell,
        ):
            shutil.copytree(folder, new, ignore=data_of, dirs_exist_ok=True)
            rehearse(ExperimentFolder(new), design, replace(people, plays=people.plays and games), seed, tell)
    study_status(to)
    note(f"Export it with `{command('study', 'export', to, '--to', to / 'exports' / 'first')}`.")


@with_option_sets
def study_power(
    folder: FolderOfExperiment,
    score: Annotated[str, typer.Option(help="The score that is compared: a subscale of a form.")],
    factor: Annotated[str, typer.Option(help="The factor whose levels are compared.")],
    people: Annotated[
        list[int] | None,
        typer.Option(help="A number of people; may be given several times. By default six up to the quota.", min=2),
    ] = None,
    rehearsals: Annotated[int, typer.Option(help="Rehearsals of each kind.", min=10, max=100_000)] = 200,
    seed: Annotated[int, typer.Option(help="Of the first of them.", min=0, max=2**30)] = 1,
    to: Annotated[
        Path | None,
        typer.Option(help="Folder that keeps the results, so that a stopped run goes on.", metavar="DIR"),
    ] = None,
    *,
    engine: EngineOptions,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Estimate by rehearsals how many people are needed to find the effects that `rehearsal.yaml` puts in."""
    from thbridge.batch.engines.engine import EngineFailed
    from thbridge.experiment.rehearsal.power import WARM, PowerTask
    from ui.command_line.progress import shown_progress
    from ui.commands.study.power import estimate_shown, power_tasks, show_estimates
    from ui.commands.study.unfinished import finish_begun_withdrawals
    from ui.commands.sweep.engines import chosen_engine

    finish_begun_withdrawals(folder)
    with TemporaryDirectory(prefix="thbridge-power-") as scratch:
        root = to or Path(scratch)
        with bad_input():
            tasks = power_tasks(folder, score, factor, people or (), rehearsals, seed, root)
        chosen: Engine[PowerTask] = chosen_engine(engine, WARM, root / "slurm")
        try:
            with bad_input(FAILED), shown_progress(progress, "rehearsals") as tell:
                estimates = estimate_shown(tasks, chosen, tell)
        except EngineFailed as reason:
            fail(FAILED, str(reason))
        except KeyboardInterrupt:
            kept = "the same command goes on" if to is not None else "name a folder by --to to keep what is done"
            fail(FAILED, f"stopped; {kept}")
    show_estimates(estimates, as_json=as_json)

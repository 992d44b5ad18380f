"""Commands of `thbridge study` for studies with people: `new`, `run`, `status`, `watch`, `freeze`, `backup`, ..."""

import secrets
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

FolderOfExperiment = Annotated[Path, typer.Argument(help="Folder of a study with people.", metavar="FOLDER")]


def study_new(
    folder: Annotated[Path, typer.Argument(help="Folder to create; must not exist.", metavar="FOLDER")],
    language: Annotated[str, typer.Option(help="Language of all texts for participants: en or de.")] = "en",
) -> None:
    """Create a folder with an example of a study with people, which you can change."""
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
        f"Wrote {folder}. Change its experiment.yaml and texts, in an editor or with "
        f"`{command('study', 'edit', folder)}`; then check it: `{command('study', 'check', folder)}`. "
        "`thbridge docs study-keys` explains all keys of its files."
    )


def study_status(folder: FolderOfExperiment, as_json: AsJson = False) -> None:
    """Print the participants, their progress, and how many participants are still missing."""
    from thbridge.app.compose.machine import versions
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.freeze import deviations
    from thbridge.experiment.progress import Progress, lag_words
    from thbridge.experiment.recordings import notes_on_leftovers
    from thbridge.experiment.store.event_log import read_log
    from thbridge.experiment.store.events import RunState
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place = ExperimentFolder(folder)
        design = place.read()
        entries = read_log(place.log) if place.log.exists() else ()
        progress = Progress(design).after(entries)
        left = list(notes_on_leftovers(place, progress, entries))
        changed = deviations(place, versions())
    runs = list(progress.runs.values())
    counts = {str(state): sum(run.state is state for run in runs) for state in RunState}
    most = {run.participant: run.lag for run in runs if run.lag is not None}
    if as_json:
        details = {"changed": None if changed is None else list(changed), "recordings": left, "most_lag_seconds": most}
        print_json({"planned": design.allocation.size, **counts, **details})
        return
    say(f"{design.file.title}: {counts['complete']} of {design.allocation.size} runs complete")
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
        say("The study is not frozen.")
    else:
        say(
            f"The study was frozen. Changed since then: {'; '.join(changed)}."
            if changed
            else "The study is frozen, and unchanged since then."
        )


def study_watch(
    folder: FolderOfExperiment,
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Watch a running study with people in a window: participants, missing data, events, notes. Nothing is changed."""
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
    windowed: Annotated[bool, typer.Option("--windowed", help="Use a window instead of the full screen.")] = False,
    desk: Annotated[
        bool, typer.Option("--desk/--no-desk", help="Also open the desk, the researcher's window for another screen.")
    ] = False,
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Run a study on this computer, for one participant after another. After a crash, continue at the same step."""
    if hosted:
        from ui.windows.kiosk.window import open_kiosk

        raise typer.Exit(open_kiosk(look.value, windowed=windowed))
    from ui.first_start.bar import announce_start

    if why_no_window() is None:
        announce_start(look.value)

    from ui.commands.study.run import run_study

    run_study(folder, look.value, windowed=windowed, desk=desk)


def study_codes(
    folder: FolderOfExperiment,
    number: Annotated[int, typer.Option(help="Number of codes to create.", min=1, max=100_000)] = 1,
    address: Annotated[
        str, typer.Option(help="Address of `thbridge serve`, as participants reach it.", metavar="URL")
    ] = "http://127.0.0.1:8080/",
) -> None:
    """Create codes for participants in browsers, add them to the study's file of codes, and print a link for each."""
    from thbridge.experiment.design.recruiting import add_codes, link_with
    from thbridge.experiment.folder import ExperimentFolder

    if not address.startswith(("http://", "https://")):
        fail(BAD_INPUT, f"--address: {address} is not an address. Write an address that begins with https://.")
    with bad_input():
        design = ExperimentFolder(folder).read()
        name = design.file.recruiting.codes
        if name is None:
            remedy = "Write recruiting: {codes: codes.txt}"
            raise design.fault("recruiting.codes", "the study has no file for codes, so anyone can enter", remedy)
        for code in add_codes(folder / name, number, secrets.randbelow):
            say(link_with(address, code))
    note(f"Added codes to {folder / name}: {number}. If `thbridge serve` is running, stop it and start it again.")


def study_preview(
    folder: FolderOfExperiment,
    step: Annotated[
        str, typer.Argument(help="Name of a step, or its number in the file; default: all steps.", metavar="[STEP]")
    ] = "",
    condition: Annotated[
        str,
        typer.Option(
            help="Level of the within-people factor, such as `collaborator`; default: the first.", metavar="LEVEL"
        ),
    ] = "",
    group: Annotated[
        str, typer.Option(help="Level of the between-people factor; default: the first.", metavar="LEVEL")
    ] = "",
    look: LookOption = ColourScheme.SYSTEM,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Show a step as participants see it, without the steps before it. Nothing is recorded."""
    if hosted:
        from ui.windows.kiosk.window import open_kiosk

        raise typer.Exit(open_kiosk(look.value, windowed=True, title="Preview: nothing is recorded"))
    from ui.commands.study.preview import preview_step
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    preview_step(folder, step, condition, group, look.value)


def study_freeze(folder: FolderOfExperiment) -> None:
    """Write the experiment's fingerprint for a preregistration. Later exports report changes of the experiment."""
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
    to: Annotated[Path, typer.Option(help="Folder to write; must be new or empty.", metavar="DIR")],
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Export tables for pandas and R in the Psych-DS format, with scripts and a paragraph for the methods section."""
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
    for details in written.notes:
        note(details)
    python, r = shlex.join(["python", str(to / "analysis.py")]), shlex.join(["Rscript", str(to / "analysis.R")])
    note(f"Wrote {to}. Compare and plot the conditions with `{python}` or `{r}`.")


def study_backup(
    folder: FolderOfExperiment,
    to: Annotated[Path, typer.Option(help="Folder of the backup; an existing backup is updated.", metavar="DIR")],
) -> None:
    """Back up a study, even while people take part: log, recordings and files, each verified."""
    from thbridge.experiment.backup import back_up
    from thbridge.experiment.folder import ExperimentFolder
    from ui.commands.study.unfinished import finish_begun_withdrawals

    finish_begun_withdrawals(folder)
    with bad_input():
        place = ExperimentFolder(folder)
        place.read()
        place.entries()
        lacking = back_up(place, to)
    for details in lacking:
        note(details)
    use = f"You can use the backup instead of the study: `{command('study', 'status', to)}`"
    note(f"{to} is verified and up to date. {use}.")
    if lacking:
        raise typer.Exit(FAILED)


def study_restore(
    backup: Annotated[Path, typer.Argument(help="Folder of a backup.", metavar="BACKUP")],
    to: Annotated[
        Path | None,
        typer.Option(help="Folder of the study; default: the folder that was backed up.", metavar="STUDY"),
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Do not ask for confirmation if the study's own log is intact and newer.")
    ] = False,
) -> None:
    """Restore a study from a backup.

    Replaced files are kept. People who withdrew after the backup stay withdrawn.
    """
    from ui.commands.study.restore import restore_study

    restore_study(backup, to, yes=yes)


def study_withdraw(
    folder: FolderOfExperiment,
    participant: Annotated[
        list[str] | None,
        typer.Argument(
            help="Id of the participant, such as P-7K3FQ, or their completion code. The blank in the code is optional.",
            metavar="PARTICIPANT",
        ),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask for confirmation (for scripts).")] = False,
    gone: Annotated[
        list[Path] | None,
        typer.Option(help="Export or backup that no longer exists, so that it is not searched.", metavar="PATH"),
    ] = None,
) -> None:
    """List the data of one participant, then delete it permanently from log, recordings, exports and backups."""
    from ui.commands.study.withdrawal import withdraw_participant

    withdraw_participant(folder, " ".join(participant) if participant else None, gone or (), yes=yes)


def study_rehearse(
    folder: FolderOfExperiment,
    to: Annotated[
        Path,
        typer.Option(help="Folder for the rehearsal, a copy of the study; must not exist.", metavar="DIR"),
    ],
    seed: Annotated[int, typer.Option(help="Random seed.", min=0, max=2**31 - 1)] = 1,
    games: Annotated[bool, typer.Option("--games/--no-games", help="Play and record the games.")] = True,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Run the whole experiment with simulated people; `rehearsal.yaml` describes them."""
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
            fail(BAD_INPUT, f"{to}: this folder already exists. Choose another folder with --to.")
        with (
            new_folder(to, "choose another folder with --to, or free disk space") as new,
            shown_progress(progress, "rehearsal") as tell,
        ):
            shutil.copytree(folder, new, ignore=data_of, dirs_exist_ok=True)
            rehearse(ExperimentFolder(new), design, replace(people, plays=people.plays and games), seed, tell)
    study_status(to)
    note(f"Export the rehearsal with `{command('study', 'export', to, '--to', to / 'exports' / 'first')}`.")


@with_option_sets
def study_power(
    folder: FolderOfExperiment,
    score: Annotated[str, typer.Option(help="Score to compare: a subscale of a form.")],
    factor: Annotated[str, typer.Option(help="Factor whose levels are compared.")],
    people: Annotated[
        list[int] | None,
        typer.Option(help="Number of people. Can be repeated. Default: six values up to the quota.", min=2),
    ] = None,
    rehearsals: Annotated[
        int,
        typer.Option(
            help="Number of rehearsals with the effects. The same number runs without effects.", min=10, max=100_000
        ),
    ] = 200,
    seed: Annotated[int, typer.Option(help="Random seed of the first rehearsal.", min=0, max=2**30)] = 1,
    to: Annotated[
        Path | None,
        typer.Option(help="Folder for the results, so that a stopped run can be resumed.", metavar="DIR"),
    ] = None,
    *,
    engine: EngineOptions,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Simulate rehearsals to estimate how many people are needed to find the effects in `rehearsal.yaml`."""
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
            kept = "Run the same command to resume" if to is not None else "To keep results, name a folder with --to"
            fail(FAILED, f"The estimate was stopped. {kept}.")
    show_estimates(estimates, as_json=as_json)

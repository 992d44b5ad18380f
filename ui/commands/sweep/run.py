"""`thbridge sweep run`: play the games of a design."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.option_sets import with_option_sets
from ui.command_line.options import AsJson, EngineOptions, ProgressKind, ProgressOption
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, note, print_json


@with_option_sets
def sweep_run(
    design_file: Annotated[
        Path, typer.Argument(help="Design of the sweep (YAML); see `thbridge docs sweeps`.", metavar="DESIGN.yaml")
    ],
    to: Annotated[
        Path | None,
        typer.Option("--out", help="Folder of the sweep; default: the name of the design file.", metavar="DIR"),
    ] = None,
    *,
    engine: EngineOptions,
    shard: Annotated[
        str | None,
        typer.Option(
            help="Play only part I of N parts, for job arrays. All parts write to the same folder.", metavar="I/N"
        ),
    ] = None,
    retry: Annotated[
        bool, typer.Option("--retry", help="Play failed games again, after you have fixed the cause.")
    ] = False,
    check: Annotated[
        bool, typer.Option("--check", help="Only check the design, and print the number of games.")
    ] = False,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Play the games of a design, or resume an earlier run.

    The exit code is 1 if the run was stopped, or if a repeated game gave another result.
    """
    from ui.first_start.bar import announce_start

    if not check:
        announce_start()

    from thbridge.batch.chunks import Shard, shard_in
    from thbridge.batch.design import read_design
    from thbridge.batch.engines.engine import Engine, EngineFailed
    from thbridge.batch.folder import open_folder
    from thbridge.batch.sweep import WARM
    from thbridge.batch.tasks import SweepTask
    from ui.command_line.progress import shown_progress
    from ui.commands.sweep.engines import chosen_engine
    from ui.commands.sweep.shown import run_shown
    from ui.commands.sweep.telling import design_as_json, progress_as_json, show_design, show_progress
    from ui.first_start.compiling import compile_ahead

    part = Shard() if shard is None else shard_in(shard)
    if part is None:
        fail(BAD_INPUT, f"--shard: {shard!r} is not of the form I/N. Write, for example, --shard 2/8 for part 2 of 8.")
    with bad_input():
        design = read_design(design_file)
        for doubt in design.doubts:
            note(str(doubt))
        if check:
            if as_json:
                print_json(design_as_json(design))
            else:
                show_design(design)
            return
    root = to or Path(design_file.stem)
    chosen: Engine[SweepTask] = chosen_engine(engine, WARM, root / "slurm")
    with bad_input():
        folder = open_folder(design, root)
    compile_ahead(whole_hunt=True)
    try:
        with bad_input(FAILED), shown_progress(progress, "games") as tell:
            done = run_shown(design, folder, chosen, part, retry=retry, tell=tell)
    except EngineFailed as reason:
        fail(FAILED, str(reason))
    except KeyboardInterrupt:
        fail(
            FAILED,
            "Stopped. All results are kept. To resume, run the same command. For the status, run "
            f"{command('sweep', 'status', root)}",
        )
    if as_json:
        print_json(progress_as_json(done, root))
    else:
        show_progress(done, root)
    if done.failed:
        note(f"{done.failed} games produced no result. Run {command('sweep', 'status', root)} for details.")
    if done.differing:
        fail(
            FAILED,
            f"{done.differing} of {done.verified} repeated games gave DIFFERENT results. Do not trust "
            "this sweep. Look for workers with other versions or machines.",
        )

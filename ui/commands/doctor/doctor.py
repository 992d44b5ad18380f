"""`thbridge doctor`: check whether games can run on this computer."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson


def doctor(
    study_file: Annotated[
        Path | None, typer.Argument(help="Study file; its ports are checked instead of the default ports.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check this computer: Python, packages, windows, ports, compiled code, folders, clock, locale.

    Print a line for each check: ok, warning (some features do not work) or fault (no game can be played), and the
    remedy. The exit code is 1 if there is a fault.
    """
    import dataclasses
    import time
    from tempfile import gettempdir

    from ui.command_line.settings import study_of
    from ui.command_line.terminal import FAILED, print_json, say
    from ui.commands.doctor.packages import check_packages
    from ui.commands.doctor.places import check_folder, check_kernels
    from ui.commands.doctor.ports import PORTS, check_ports, ports_of_study
    from ui.commands.doctor.result import HealthState
    from ui.commands.doctor.screen import check_screen
    from ui.commands.doctor.surroundings import check_clock, check_libraries, check_locale

    ports = PORTS if study_file is None else ports_of_study(study_of(study_file, {}))
    checks = [
        *check_packages(),
        check_libraries(),
        check_screen(),
        *check_ports(ports),
        check_kernels(),
        check_folder("recordings", Path("bags")),
        check_folder("temporary files", Path(gettempdir())),
        *check_clock(time.time()),
        check_locale(),
    ]
    faults = [check for check in checks if check.state is HealthState.FAULT]
    if as_json:
        print_json({"ok": not faults, "checks": [dataclasses.asdict(check) for check in checks]})
    else:
        width = max(len(check.name) for check in checks)
        for check in checks:
            remedy = f" {check.remedy}." if check.remedy else ""
            say(f"{check.state:7}  {check.name:{width}}  {check.message}.{remedy}")
    if faults:
        raise typer.Exit(FAILED)

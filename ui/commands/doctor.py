"""`thbridge doctor`: whether this computer has what games need."""

import typer

from ui.options import AsJson


def doctor(as_json: AsJson = False) -> None:
    """Check this computer: Python, packages, windows, ports, compiled code, folders, clock, locale.

    Prints a line for each check: ok, warning (some features do not work) or fault (no game can be played), with the
    remedy. Ends with 1 if there is a fault.
    """
    import dataclasses
    import time
    from pathlib import Path
    from tempfile import gettempdir

    from ui.actions.doctor.packages import check_packages
    from ui.actions.doctor.places import check_folder, check_kernels
    from ui.actions.doctor.ports import check_ports
    from ui.actions.doctor.result import HealthState
    from ui.actions.doctor.surroundings import check_clock, check_libraries, check_locale, check_screen
    from ui.terminal import FAILED, print_json, say

    checks = [
        *check_packages(),
        check_libraries(),
        check_screen(),
        *check_ports(),
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

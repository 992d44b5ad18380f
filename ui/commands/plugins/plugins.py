"""`thbridge plugins`: programs of a lab that replace parts of a session."""

from typing import Annotated

import typer

from ui.command_line.options import AsJson, Seed
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, print_json, say


def plugins_list(as_json: AsJson = False) -> None:
    """List the plug-ins that are installed; none of them is loaded."""
    from thbridge.files.plugins import KINDS
    from ui.commands.plugins.check import listed

    found = [*listed()]
    if as_json:
        print_json({"plugins": [{"group": kind.group, "name": name, "from": what} for kind, name, what in found]})
        return
    for kind, name, what in found:
        say(f"{kind.what} {name}: {what}")
    if not found:
        say(f"None is installed. Groups of entry points: {', '.join(kind.group for kind in KINDS)}.")


def plugins_check(
    participant: Annotated[
        str | None, typer.Option(help="A simulated participant that is installed: it plays games of all conditions.")
    ] = None,
    recovery: Annotated[
        str | None, typer.Option(help="A recovery behavior that is installed: it runs in places of all kinds.")
    ] = None,
    localizer: Annotated[
        str | None, typer.Option(help="A localizer that is installed: it is asked for all that it may be asked for.")
    ] = None,
    planner: Annotated[
        str | None, typer.Option(help="A global planner that is installed: it plans on maps with and without paths.")
    ] = None,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Try plug-ins in many situations, twice and in a second process, and report faults.

    Strategies and authors of wordings: `thbridge talk check`.
    """
    from thbridge.files.plugins import LOCALIZERS, PARTICIPANTS, PLANNERS, RECOVERIES
    from ui.commands.plugins.check import check_plugin

    named = ((PARTICIPANTS, participant), (RECOVERIES, recovery), (LOCALIZERS, localizer), (PLANNERS, planner))
    asked = [(kind, name) for kind, name in named if name is not None]
    if not asked:
        fail(
            BAD_INPUT,
            "nothing to check. Write --participant NAME, say; see `thbridge plugins list`.",
        )
    with bad_input():
        checked = [check_plugin(kind, name, seed or 0) for kind, name in asked]
    ok = all(each.ok for each in checked)
    if as_json:
        print_json({"ok": ok, "plugins": [each.as_json() for each in checked]})
    else:
        for each in checked:
            for line in each.lines():
                say(line)
    if not ok:
        raise typer.Exit(BAD_INPUT)

"""`thbridge plugins`: programs of a lab that replace parts of a session."""

from typing import Annotated

import typer

from ui.command_line.options import AsJson, Seed
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, print_json, say


def plugins_list(as_json: AsJson = False) -> None:
    """List the installed plug-ins, without loading them."""
    from thbridge.files.plugins import KINDS
    from ui.commands.plugins.check import listed

    found = [*listed()]
    if as_json:
        print_json({"plugins": [{"group": kind.group, "name": name, "from": what} for kind, name, what in found]})
        return
    for kind, name, what in found:
        say(f"{kind.what} {name}: {what}")
    if not found:
        say(f"No plug-in is installed. Groups of entry points: {', '.join(kind.group for kind in KINDS)}.")


def plugins_check(
    participant: Annotated[
        str | None, typer.Option(help="Name of the simulated participant to check, in games of all conditions.")
    ] = None,
    recovery: Annotated[
        str | None, typer.Option(help="Name of the recovery behavior to check in all kinds of places.")
    ] = None,
    localizer: Annotated[str | None, typer.Option(help="Name of the localizer to check, with all its methods.")] = None,
    planner: Annotated[
        str | None, typer.Option(help="Name of the global planner to check, on maps with and without paths.")
    ] = None,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Try plug-ins in many situations, and report faults. Each situation runs twice, and again in a second process.

    To check strategies and authors of wordings, use `thbridge talk check`.
    """
    from thbridge.files.plugins import LOCALIZERS, PARTICIPANTS, PLANNERS, RECOVERIES
    from ui.commands.plugins.check import check_plugin

    named = ((PARTICIPANTS, participant), (RECOVERIES, recovery), (LOCALIZERS, localizer), (PLANNERS, planner))
    asked = [(kind, name) for kind, name in named if name is not None]
    if not asked:
        fail(
            BAD_INPUT,
            "The plug-in to check is missing. Write, for example, --participant NAME; see `thbridge plugins list`.",
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

"""`thbridge maps check` and `maps list`."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note, print_json, say


def maps_check(
    name: Annotated[str, typer.Argument(help="Name of a map, or the path of its folder.")],
    to: Annotated[
        Path | None,
        typer.Option(help="Also draw the map with rooms, doors, goals and start poses, as a .png, .svg or .pdf."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check a map (image, rooms, goals, start poses), and print what it contains."""
    from thbridge.files.map_files import check_map
    from thbridge.offline.map_survey import survey
    from ui.command_line.pictures import PICTURES
    from ui.command_line.settings import map_folder
    from ui.commands.maps.survey import finding_as_json, show_survey, survey_as_json, write_survey_picture

    if to is not None and to.suffix.lower() not in PICTURES:
        fail(BAD_INPUT, f"--to: {to} is not a picture. Write a file name that ends in .png, .svg or .pdf.")
    folder = map_folder(name)
    check = check_map(folder)
    seen = None if check.map is None else survey(check.map)
    errors = len(check.errors)
    if as_json:
        figures = None if seen is None else survey_as_json(seen)
        print_json({"ok": errors == 0, "findings": [finding_as_json(each) for each in check.findings], "map": figures})
    else:
        if seen is not None and not errors:
            show_survey(seen, folder)
        for finding in check.findings:
            say(f"{finding.severity}: {finding.fault}")
        say(f"{errors} errors, {len(check.findings) - errors} warnings")
    if to is not None and seen is None:
        note(f"{to} was not drawn, because files of the map cannot be read.")
    elif to is not None and seen is not None:
        with bad_input():
            write_survey_picture(seen, to)
        note(f"Wrote {to}.")
    if errors:
        raise typer.Exit(BAD_INPUT)


def maps_list() -> None:
    """List the maps that come with thbridge."""
    from thbridge.files.resources import shipped

    for name in shipped().names("maps"):
        say(name)

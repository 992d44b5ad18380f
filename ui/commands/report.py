"""`thbridge report`."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import ProgressKind, ProgressOption
from ui.command_line.outputs import share_outputs
from ui.command_line.recordings import Estimated, Recording, Truth
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note


def report(
    bag: Recording,
    to: Annotated[
        Path | None, typer.Option(help="HTML file to write; default: next to the bag. `-` is standard output.")
    ] = None,
    map_yaml: Annotated[
        Path | None, typer.Option("--map", help="Map (a map_server YAML file); default: the map in the bag.")
    ] = None,
    truth: Truth = None,
    estimate: Estimated = None,
    player: Annotated[
        bool, typer.Option("--player", help="Write a page that plays the recording, instead of the report.")
    ] = False,
    language: Annotated[
        str | None,
        typer.Option(
            "--language", metavar="NAME", help="Language of the player: en or de; default: the language of the study."
        ),
    ] = None,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Write a report of a bag: one HTML page with paths, errors, energy, events and dialogues.

    With --player, the page plays the recording: robots on the map, dialogues, events, and values over time.
    """
    from thbridge.analysis.report.builder import trajectory_topics
    from ui.command_line.heap import give_large_blocks_back
    from ui.command_line.outputs import STANDARD_OUTPUT
    from ui.command_line.progress import shown_progress
    from ui.command_line.report import write_page, write_report

    give_large_blocks_back()
    if language is not None:
        _check_language(language, player)
    if to is not None:
        share_outputs()
    with bad_input(), shown_progress(progress, "report") as tell:
        named = trajectory_topics(bag, truth, estimate)
        if player:
            from ui.web.player.page import build_player

            page = to or bag.with_name(f"{bag.stem}-player.html")
            write_page(bag, page, map_yaml, lambda grid: build_player(bag, grid, tell, named, language))
            if page != STANDARD_OUTPUT:
                note(f"Player: {page}")
        else:
            write_report(bag, to or bag.with_suffix(".html"), map_yaml, tell, named)


def _check_language(language: str, player: bool) -> None:
    """Check the language before the bag is read, which can take minutes."""
    from thbridge.files.language_texts import shipped_languages

    if not player:
        fail(BAD_INPUT, "--language: reports are in English. Add --player, or omit --language.")
    if language not in shipped_languages():
        known = ", ".join(shipped_languages())
        fail(BAD_INPUT, f"--language: there is no built-in language {language!r}. Choose one of {known}.")

"""`thbridge docs`: the documentation in the terminal or in a browser."""

from typing import Annotated

import typer


def docs(
    page: Annotated[
        str | None, typer.Argument(help="Name of a page, such as `sweeps`. Default: list all pages.")
    ] = None,
    in_browser: Annotated[
        bool, typer.Option("--open", help="Open the page, or the list of pages, in a browser.")
    ] = False,
) -> None:
    """List the pages of the documentation, or show a page."""
    from ui.command_line.terminal import bad_input
    from ui.commands.docs.pages import find_page, list_pages, open_in_browser, show_page

    with bad_input():
        found = None if page is None else find_page(page)
        if in_browser:
            open_in_browser(found)
        elif found is None:
            list_pages()
        else:
            show_page(found)

"""Reference pages of the command line: a page for each top-level command, with its subcommands."""

import re
from collections.abc import Iterator
from inspect import cleandoc

import typer
import typer.main
from typer.core import TyperCommand, TyperGroup

from ui.cli import app

Command = TyperCommand | TyperGroup


def command_pages() -> dict[str, str]:
    """Return the pages by their names, such as `play`, and the list of all commands as `index`."""
    root = typer.main.get_command(app)
    pages = {}
    rows = []
    for name, command in _inner(root):
        pages[name] = "\n".join(_lines(("thbridge", name), command, level=1)) + "\n"
        rows.append(f"* [`thbridge {name}`]({name}.md): {_first(command)}")
    toctree = ["```{toctree}", ":hidden:", *sorted(pages), "```"]
    head = ["# Commands", "", "For everyone at a terminal: each command with its arguments and options.", ""]
    pages["index"] = "\n".join([*head, *sorted(rows), "", *toctree]) + "\n"
    return pages


def _inner(group: object) -> Iterator[tuple[str, Command]]:
    if isinstance(group, TyperGroup):
        context = typer.Context(group)
        for name in group.list_commands(context):
            command = group.get_command(context, name)
            if command is not None and not command.hidden:
                yield name, command


def _lines(names: tuple[str, ...], command: Command, level: int) -> Iterator[str]:
    context = typer.Context(command, info_name=" ".join(names))
    yield f"{'#' * level} thbridge {' '.join(names[1:])}" if level == 1 else f"{'#' * level} {' '.join(names[1:])}"
    yield ""
    if level == 1:
        yield f"For everyone at a terminal: `{' '.join(names)} --help` prints the same."
        yield ""
    yield _markdown(command.help or "")
    yield ""
    inner = list(_inner(command))
    if not inner:
        yield f"```text\n{' '.join(names)} {' '.join(command.collect_usage_pieces(context))}\n```"
        yield ""
    yield from _table("argument", [param for param in command.params if param.param_type_name == "argument"], context)
    yield from _table("option", [param for param in command.params if param.param_type_name == "option"], context)
    for name, each in inner:
        yield from _lines((*names, name), each, level + 1)


def _table(kind: str, params: list, context: typer.Context) -> Iterator[str]:
    rows = [
        record
        for param in params
        if not getattr(param, "hidden", False) and (record := param.get_help_record(context)) is not None
    ]
    if rows:
        yield f"| {kind} | meaning |\n|---|---|"
        for names, meaning in rows:
            yield f"| `{_cell(names)}` | {_cell(_markdown(meaning))} |"
        yield ""


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _first(command: Command) -> str:
    return _markdown(command.help or "").partition("\n")[0]


def _markdown(help_text: str) -> str:
    """Return a help text without Rich's markup. Its square brackets are escaped, so that they do not become links."""
    text = re.sub(r"\\\[", "[", cleandoc(help_text).replace("\b\n", ""))
    return re.sub(r"(?<![`\w])\[(?=[^\]]*\])", r"\\[", " ".join(text.split("\n")) if "\n\n" not in text else text)

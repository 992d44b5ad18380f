"""Commands that run in this process. Real processes, which take seconds to start, are tested in `tests/system`."""

from contextlib import chdir
from pathlib import Path
from typing import Any

import typer
import typer.main
from typer.core import TyperCommand, TyperGroup
from typer.testing import CliRunner, Result

from ui.cli import app


def thbridge(folder: Path, *words: object) -> Result:
    """Run a command in a folder; return its exit code and its output."""
    with chdir(folder):
        return invoke(*words)


def invoke(*words: object, **options: Any) -> Result:
    """Run a command, with options for the runner such as `input`; return its exit code and its output."""
    return CliRunner().invoke(app, [*map(str, words)], **options)


def output_of(*words: object) -> str:
    """Return the output of a command that must succeed."""
    done = invoke(*words)
    assert done.exit_code == 0, done.output
    return done.output


def refusal_of(*words: object) -> str:
    """Return the output of a command that must fail, on one line."""
    done = invoke(*words)
    assert done.exit_code != 0
    return " ".join(done.output.split())


def refusal(*words: object) -> str:
    """Return the error message of a command that must reject its input and change no file."""
    before = sorted(Path().rglob("*"))
    done = invoke(*words)
    assert done.exit_code == 2, (done.output, done.exception)
    assert done.stdout == ""
    assert sorted(Path().rglob("*")) == before
    return done.stderr


def all_commands() -> dict[tuple[str, ...], TyperCommand | TyperGroup]:
    """Return all commands, and the groups that they are in, by their names."""
    found = {(): typer.main.get_command(app)}
    groups = [()]
    while groups:
        names = groups.pop()
        context = typer.Context(found[names])
        for name in found[names].list_commands(context):
            found[*names, name] = inner = found[names].get_command(context, name)
            groups += [(*names, name)] * isinstance(inner, TyperGroup)
    return found

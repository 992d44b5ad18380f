"""Options of one subject in one dataclass."""

from dataclasses import dataclass
from typing import Annotated

import typer
from typer.testing import CliRunner

from ui.command_line.option_sets import with_option_sets


@dataclass(frozen=True)
class Size:
    width: Annotated[int, typer.Option(help="Meters.", min=1)]
    names: Annotated[list[str] | None, typer.Option("--name")] = None
    depth: Annotated[int, typer.Option()] = 3


def test_each_field_is_an_option_and_the_command_takes_them_as_one() -> None:
    taken: list[object] = []

    @with_option_sets
    def measure(
        first: Annotated[str, typer.Argument()], *, size: Size, last: Annotated[bool, typer.Option()] = False
    ) -> None:
        taken.append((first, size, last))

    app = typer.Typer()
    app.command()(measure)
    assert CliRunner().invoke(app, ["a", "--width", "2", "--name", "b", "--last", "--name", "c"]).exit_code == 0
    assert taken == [("a", Size(2, ["b", "c"], 3), True)]
    assert "'--width'" in CliRunner().invoke(app, ["a"]).output

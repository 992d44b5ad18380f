"""Commands in this process: their start, which takes seconds, is tested by real programs in `tests/system`."""

from contextlib import chdir
from pathlib import Path

from click.testing import Result
from typer.testing import CliRunner

from ui.cli import app


def thbridge(folder: Path, *words: object) -> Result:
    """Run a command in a folder, and return its exit code and what it printed."""
    with chdir(folder):
        return CliRunner().invoke(app, [*map(str, words)])

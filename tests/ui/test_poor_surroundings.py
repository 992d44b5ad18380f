"""Commands in poor surroundings, as real programs: no home, an ASCII locale, closed standard streams."""

import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
import typer

from tests.compiling import ROOT
from ui.cli import app

PEOPLE = ROOT / "tests" / "system" / "studies_of_0_1" / "with-people"
THBRIDGE = f"{shlex.quote(sys.executable)} -c 'from ui.cli import main; main()'"
SURROUNDINGS = {
    "no home": "env -u HOME {}",
    "an ASCII locale": "env LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 {}",
    "no standard output": "{} >&-",
    "no standard error": "{} 2>&-",
    "all of it": "env -u HOME LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 {} >&- 2>&-",
}


def commands(command: click.Command, names: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the names of all commands."""
    yield names
    for name, inner in (getattr(command, "commands", None) or {}).items():
        yield from commands(inner, (*names, name))


ALL = tuple(commands(typer.main.get_command(app)))


def run(where: str, *arguments: object) -> int:
    """Run a command; return its exit code."""
    line = SURROUNDINGS[where].format(f"{THBRIDGE} {shlex.join(map(str, arguments))}")
    done = subprocess.run(
        ["sh", "-c", line], env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=False, timeout=100
    )
    assert b"Traceback" not in done.stdout + done.stderr, done.stderr.decode(errors="replace")
    return done.returncode


@pytest.mark.parametrize("where", SURROUNDINGS)
def test_results_and_refusals(where: str, tmp_path: Path) -> None:
    assert run(where, "study", "status", PEOPLE) == 0
    assert run(where, "study", "init", tmp_path / "größe.yaml") == 0
    assert run(where, "study", "status", tmp_path / "größe") == 2


def test_letters_that_the_locale_does_not_have_are_escaped(tmp_path: Path) -> None:
    (tmp_path / "study").mkdir()
    for path in PEOPLE.iterdir():
        (tmp_path / "study" / path.name).symlink_to(path)
    file = tmp_path / "study" / "experiment.yaml"
    text = file.read_text()
    file.unlink()
    title = next(line for line in text.splitlines() if line.startswith("title:"))
    file.write_text(text.replace(title, "title: Größe 5°"))
    assert run("an ASCII locale", "study", "status", tmp_path / "study") == 0


@pytest.mark.parametrize("key", ["map", "templates"])
def test_a_folder_of_a_user_that_is_not_there(tmp_path: Path, key: str) -> None:
    (tmp_path / "study.yaml").write_text(f"{key}: ~nosuchuser/x\n")
    assert run("no home", "study", "check", tmp_path / "study.yaml") == 2


@pytest.mark.slow
@pytest.mark.parametrize("names", ALL, ids=" ".join)
def test_the_help_of_every_command(names: tuple[str, ...]) -> None:
    assert run("all of it", *names, "--help") == 0

"""Commands in poor surroundings, as real programs: no home, no account, an ASCII locale, closed standard streams."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.programs.commands import all_commands
from tests.support.project import ROOT

PEOPLE = ROOT / "tests" / "system" / "studies_of_0_1" / "with-people"
NOBODY = """
import pwd
def unknown(_account):
    raise KeyError(_account)
pwd.getpwuid = pwd.getpwnam = unknown
"""
"""A machine that does not know the account by which a program runs, as in a container."""
COMMANDS = """
import os, sys
from ui.cli import main
def run(words):
    sys.argv = ["thbridge", *map(os.fsdecode, words)]
    try:
        main()
    except SystemExit as left:
        return left.code
codes = [run(words) for words in {}]
sys.exit(0 if codes == {} else f"exit codes: {{codes}}")
"""
"""Several commands in one process, for starting takes most of the time."""
NO_HOME = "env -u HOME -u USER -u LOGNAME {}"
ASCII = "env LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 {}"
CLOSED = "{} >&-"
ALL_CLOSED = "{} <&- >&- 2>&-"


def run(surroundings: str, program: str) -> subprocess.CompletedProcess[bytes]:
    """Run a program in surroundings; neither may show a traceback."""
    line = surroundings.format(shlex.join([sys.executable, "-c", program]))
    done = subprocess.run(
        ["sh", "-c", line], env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=False, timeout=100
    )
    assert b"Traceback" not in done.stdout + done.stderr, done.stderr.decode(errors="replace")
    return done


def commands(*expected: tuple[int, list[object]]) -> str:
    """Return a program that runs commands and ends with 0 if their exit codes are the expected ones."""
    return COMMANDS.format(
        [[os.fsencode(str(word)) for word in words] for _, words in expected], [code for code, _ in expected]
    )


def test_results_and_refusals_without_a_home_and_in_an_ascii_locale(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    for path in PEOPLE.iterdir():
        (study / path.name).symlink_to(path)
    text = (study / "experiment.yaml").read_text()
    (study / "experiment.yaml").unlink()
    title = next(line for line in text.splitlines() if line.startswith("title:"))
    (study / "experiment.yaml").write_text(text.replace(title, "title: Größe 5°"))
    (tmp_path / "nobody's.yaml").write_text("map: ~nosuchuser/x\n")
    (tmp_path / "own.yaml").write_text("templates: ~/x\n")
    program = NOBODY + commands(
        (0, ["study", "status", study]),
        (0, ["study", "init", tmp_path / "größe.yaml"]),
        (2, ["study", "status", tmp_path / "größe"]),
        (2, ["study", "check", tmp_path / "nobody's.yaml"]),
        (2, ["study", "check", tmp_path / "own.yaml"]),
    )
    done = run(NO_HOME.format(ASCII), program)
    assert (done.returncode, b"Gr\\xf6\\xdfe 5\\xb0" in done.stdout) == (0, True), done.stderr.decode()


def test_a_result_that_goes_nowhere_is_a_failure_that_says_so(tmp_path: Path) -> None:
    program = commands((2, ["study", "status", tmp_path]), (1, ["study", "init", "-"]))
    done = run(CLOSED, program)
    assert done.returncode == 0, done.stderr.decode()
    *_, last = done.stderr.decode().splitlines()
    assert last == "Standard output is closed, so the output of this command is lost. Redirect it to a file."


def test_files_are_written_whole_with_all_streams_closed(tmp_path: Path) -> None:
    program = NOBODY + commands((1, ["study", "init", "-"]), (1, ["study", "init", tmp_path / "a.yaml"]))
    assert run(NO_HOME.format(ALL_CLOSED), program).returncode == 0
    assert (tmp_path / "a.yaml").read_text().endswith("\n")


# Every command


@pytest.mark.slow
@pytest.mark.parametrize("names", tuple(all_commands()), ids=" ".join)
def test_the_help_of_every_command(names: tuple[str, ...]) -> None:
    everything = NO_HOME.format(ASCII).format(ALL_CLOSED)
    assert run(everything, NOBODY + commands((1, [*names, "--help"]))).returncode == 0

"""docs/tutorials/first-study.md does what it says: each of its commands is run in order, and says what stands there."""

import re
import runpy
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke
from tests.support.studies.kiosk_without_screen import RehearsedGames, WindowOfTwo

PAGE = Path(__file__).parents[2] / "docs" / "tutorials" / "first-study.md"


@pytest.fixture
def at_the_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, instead in (
        ("WindowProcess", WindowOfTwo),
        ("StudyGames", RehearsedGames),
        ("why_no_window", lambda: None),
    ):
        monkeypatch.setattr(f"ui.commands.study.run.{name}", instead)
    return tmp_path


def blocks() -> Iterator[tuple[str, str]]:
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL):
        yield block[1], block[2]


def commands(session: str) -> Iterator[tuple[str, str]]:
    """The commands of a terminal's session, and what is said to each."""
    yield from re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", session, re.MULTILINE)


def carried_out(command: str) -> str:
    program, *arguments = command.split()
    if program == "thbridge":
        done = invoke(*arguments)
        assert done.exit_code == 0, f"{command}: {done.output}"
        return done.output
    if program == "python":
        runpy.run_path(arguments[0], run_name="__main__")
        return ""
    if shutil.which(program) is not None:
        subprocess.run([program, *arguments], check=True, capture_output=True)
    return ""


def assert_said(command: str, shown: str, said: str) -> None:
    """Whatever the width of the terminal, and where `...` stands anything may."""
    pattern = r"\s+".join(map(re.escape, shown.split()))
    for gap, anything in (("...", ".*"), ("P-XXXXX", "P-[2-9A-Z]{5}")):
        pattern = pattern.replace(re.escape(gap), anything)
    assert re.fullmatch(rf"\s*{pattern}\s*", said, re.DOTALL), f"$ {command}\n{said}"


@pytest.mark.slow
def test_every_command_of_the_page_does_what_stands_there(at_the_lab: Path) -> None:
    said, run = "", []
    for kind, block in blocks():
        if kind == "sh":
            subprocess.run(["bash", "-e", "-c", block], check=True)
        elif kind == "python":
            exec(compile(block, str(PAGE), "exec"), {})
        else:
            assert kind == "console"
            for command, shown in commands(block):
                now = command
                if "P-XXXXX" in command:
                    now = command.replace("P-XXXXX", re.findall(r"P-\w{5}", said)[0])
                before, said = said, carried_out(now)
                assert_said(now, shown, said)
                said = said if "P-" in said else before
                run.append(command.split()[:3])
    study = ["new", "check", "rehearse", "power", "freeze", "run", "status", "backup", "export", "withdraw"]
    assert {each for each in study if ["thbridge", "study", each] in run} == set(study)
    drawn = Path("rehearsal/exports/first/results/workload-python.png")
    assert drawn.stat().st_size > 1000

"""Pages of docs, tested as a reader follows them: the blocks are run in order, and each command must print what the
page shows."""

import re
import runpy
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

from tests.support.programs.commands import invoke


def follow(page: Path) -> list[list[str]]:
    """Run a page in the current folder: its shell scripts, its terminal sessions and its Python code.

    Other blocks are skipped. In the output that a session shows, `...` matches any text, and `P-XXXXX` a participant's
    id.

    Returns:
        Words of each command in the sessions.
    """
    said, run = "", []
    for kind, block in _blocks(page):
        if kind == "sh":
            subprocess.run(["bash", "-e", "-c", block], check=True)
        elif kind == "python":
            exec(compile(block, str(page), "exec"), {})
        elif kind == "console":
            for command, shown in _commands(block):
                now = command
                if "P-XXXXX" in command:
                    now = command.replace("P-XXXXX", re.findall(r"P-\w{5}", said)[0])
                before, said = said, _carried_out(now)
                _assert_said(now, shown, said)
                said = said if "P-" in said else before
                run.append(command.split())
    return run


def _blocks(page: Path) -> Iterator[tuple[str, str]]:
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL):
        yield block[1], block[2]


def _commands(session: str) -> Iterator[tuple[str, str]]:
    """Yield the commands of a terminal session, each with the output that the page shows for it."""
    yield from re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", session, re.MULTILINE)


def _carried_out(command: str) -> str:
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


def _assert_said(command: str, shown: str, said: str) -> None:
    """Compare the outputs, ignoring line breaks, because these depend on the width of the terminal."""
    pattern = r"\s+".join(map(re.escape, shown.split()))
    for gap, anything in (("...", ".*"), ("P-XXXXX", "P-[2-9A-Z]{5}")):
        pattern = pattern.replace(re.escape(gap), anything)
    assert re.fullmatch(rf"\s*{pattern}\s*", said, re.DOTALL), f"$ {command}\n{said}"

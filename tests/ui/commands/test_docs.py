"""`thbridge docs`: pages in the terminal and in a browser, and those that help texts name."""

import os
import re
import subprocess
import sys
import webbrowser
from pathlib import Path

import pytest

from tests.support.programs.commands import all_commands, invoke
from tests.support.project import ROOT
from ui.commands.docs import pages

NAMED = re.compile(r"thbridge docs ([\w-]+)|docs/(?:[\w-]+/)*([\w-]+)\.md")


def test_pages_are_listed_and_printed_as_they_are_written() -> None:
    listed = invoke("docs").stdout
    assert "sweeps " in listed
    assert listed.count("\n") == len(pages.pages()) > 60
    for name in ("sweeps", "docs/how-to/sweeps.md", "sweeps.md#the-design"):
        shown = invoke("docs", name)
        assert (shown.exit_code, shown.stdout) == (0, (ROOT / "docs" / "how-to" / "sweeps.md").read_text())


def test_an_unknown_page_is_answered_with_the_nearest() -> None:
    refused = invoke("docs", "sweep")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "A similar name is sweeps." in refused.stderr


def test_each_page_that_a_help_text_or_a_message_names_is_there() -> None:
    commands = all_commands().values()
    text = " ".join(getattr(each, "help", None) or "" for command in commands for each in (command, *command.params))
    text += " ".join(path.read_text() for path in (ROOT / "ui").rglob("*.py"))
    named = {first or second for first, second in NAMED.findall(text)}
    assert {"sweeps", "security", "mavlink"} <= named
    assert named <= set(pages.pages())


@pytest.mark.parametrize("has_browser", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_page_for_a_browser_links_to_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_browser: bool
) -> None:
    monkeypatch.setattr(pages, "cache_folder", lambda: tmp_path / "kernels")
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda uri: opened.append(uri) or has_browser)
    done = invoke("docs", "sweeps", "--open")
    page = tmp_path / "docs" / "how-to" / "sweeps.html"
    assert (done.exit_code, done.stdout, opened) == (0, f"{page}\n", [page.as_uri()])
    assert ("No browser could be opened" in done.stderr) is not has_browser
    links = re.findall(r'href="([^"#:]+\.html)(?:#([\w-]+))?"', page.read_text())
    assert links
    for target, anchor in links:
        linked = (page.parent / target).read_text()
        assert not anchor or f'id="{anchor}"' in linked, (target, anchor)


PAGER = "import sys; text = sys.stdin.read(); print('paged', 'From one file' in text, '#' in text[:9])"


@pytest.mark.parametrize(("pager", "is_paged"), [("pager", True), ("/nowhere/less", False)])
def test_on_a_terminal_a_page_goes_through_the_pager_if_there_is_one(
    tmp_path: Path, pager: str, is_paged: bool
) -> None:
    if pager == "pager":
        program = tmp_path / pager
        program.write_text(f"#!{sys.executable}\n{PAGER}\n")
        program.chmod(0o755)
        pager = str(program)
    docs = [sys.executable, "-c", "from ui.cli import main; main()", "docs", "sweeps"]
    on_terminal = f"import pty; pty.spawn({docs})"
    done = subprocess.run(
        [sys.executable, "-c", on_terminal], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
        env={**os.environ, "PAGER": pager, "TERM": "xterm", "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert ("paged True False" in done.stdout) is is_paged
    assert ("From one file to a figure" in done.stdout) is not is_paged

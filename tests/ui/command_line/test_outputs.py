"""Permissions of what commands write; `tests/system/test_readers.py` looks at those of real programs."""

import os
import stat
from pathlib import Path

import pytest

from tests.support.programs.commands import thbridge
from ui.command_line import outputs
from ui.command_line.outputs import keep_to_owner


@pytest.fixture(autouse=True)
def _program_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the account's umask of one test from commands of the next."""
    monkeypatch.setattr(outputs, "_umask_of_account", [])


def run(folder: Path, umask: int, *arguments: str) -> None:
    os.umask(umask)
    keep_to_owner()
    thbridge(folder, *arguments)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("umask", [0o022, 0o027])
def test_figures_may_be_shared_as_the_accounts_umask_says(tmp_path: Path, umask: int) -> None:
    run(tmp_path, umask, "maps", "check", "practice", "--to", "practice.svg")
    assert mode(tmp_path / "practice.svg") == 0o666 & ~umask


def test_recordings_are_their_owners_alone_and_a_report_that_is_named_is_not(tmp_path: Path) -> None:
    play = ("play", "--headless", "--map", "practice", "--robots", "1", "--max-seconds", "1", "--bag", "a.bag")
    run(tmp_path, 0o022, *play)
    assert mode(tmp_path / "a.bag") == mode(tmp_path / "a.html") == 0o600
    run(tmp_path, 0o022, "report", "a.bag", "--to", "shared.html")
    assert mode(tmp_path / "shared.html") == 0o644

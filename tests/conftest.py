"""What all tests share."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import settings

from sim.common.kernels import is_compiled

# Windows are tested without a screen, unless somebody wants to look on.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# The first example may have to compile a kernel, and other programs may want the machine: no test is a matter of time.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

ROOT = Path(__file__).parents[1]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add what `make bench` can be told."""
    parser.addoption("--write-budgets", action="store_true", help="write what bench tests measure into budgets.toml")


def pytest_configure(config: pytest.Config) -> None:
    """Share files out as they are collected: first those that wait for other programs, last the many quick ones.

    Else files of one long test come last of all, and one core waits for the other.
    """
    config.option.loadscopereorder = False


def pytest_sessionstart(session: pytest.Session) -> None:
    """Before processes share all tests in a fresh checkout, let a short hunt compile what robots compute with.

    Else each of them would compile it for itself, and whoever waits for a program would wait for that as well.
    """
    is_first_of_several = session.config.getoption("numprocesses", None) and not hasattr(session.config, "workerinput")
    if is_first_of_several and not is_compiled():
        hunt = ["play", "--headless", "--port", "0", "--rate", "0", "--max-seconds", "10", "--no-report"]
        with TemporaryDirectory() as folder:
            command = [sys.executable, "-c", "from ui.cli import main; main()", *hunt]
            subprocess.run(
                command, cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=False
            )

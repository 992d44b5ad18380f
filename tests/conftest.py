"""What all tests share."""

import gc
import os
import re
import shutil
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from functools import cache
from itertools import chain
from pathlib import Path

import pytest
import typer.testing
from hypothesis import settings

# What helpers assert is explained as in tests, if this is said before any of them is imported.
pytest.register_assert_rewrite("tests.support")

from tests.support.programs.compiling import compile_kernels  # noqa: E402
from tests.support.project import ROOT  # noqa: E402

MEMORY, ENOUGH = Path("/dev/shm"), 4 << 30
"""Folder whose files are in memory, and bytes that must be free there."""

# Windows are tested without a screen, unless somebody wants to look on.
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# The first example may have to compile a kernel, and other programs may want the machine: no test is a matter of time.
settings.register_profile("quick", deadline=None, max_examples=20)
settings.register_profile("thorough", deadline=None, max_examples=300)  # by `make test-slow`
settings.load_profile("quick")

# The tree of all commands takes 35 ms, and tests call a thousand of them.
typer.testing._get_command = cache(typer.testing._get_command)  # type: ignore[attr-defined]

CHECKED = "CHECKED_SECONDS"
"""The variable by which `make test` says how long it took before tests began."""


@pytest.fixture(autouse=True)
def _own_umask() -> Iterator[None]:
    """Keep the permissions that a command of this process gives its files from those of the next test."""
    before = os.umask(0o022)
    yield
    os.umask(before)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add what `make bench` can be told."""
    parser.addoption("--write-budgets", action="store_true", help="raise budgets.toml to what bench tests measure")


def pytest_configure(config: pytest.Config) -> None:
    """Share files out as they are collected: first those that wait for other programs, last the many quick ones.

    Else files of one long test come last of all, and one core waits for the other.
    """
    config.option.loadscopereorder = False
    gc.disable()
    # Programs force what they promise onto the disk, which takes tests of studies half their time. Tests of that itself
    # have disks of their own that forget (tests/support/disks), and speed is measured on a real one.
    if config.option.markexpr != "bench" and is_roomy(MEMORY):
        os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", str(MEMORY))


def is_roomy(folder: Path) -> bool:
    """Return True if a folder in memory has room for the files of all tests."""
    if not folder.is_dir():
        return False
    available = re.search(r"^MemAvailable: +(\d+) kB", Path("/proc/meminfo").read_text(), re.MULTILINE)
    memory = 0 if available is None else int(available[1]) * 1024
    return min(memory, shutil.disk_usage(folder).free) >= ENOUGH


def pytest_collection_finish() -> None:
    """Leave all tests out of the garbage collector's search: it would go through 700 MB of what stays for good."""
    gc.freeze()
    gc.enable()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Share tests among more processes than there are cores: a third of the time tests wait for other programs."""
    cores = len(os.sched_getaffinity(0))
    return cores + cores // 2


def pytest_sessionstart(session: pytest.Session) -> None:
    """Before processes share all tests, compile what they compute with."""
    if session.config.getoption("numprocesses", None) and not hasattr(session.config, "workerinput"):
        compile_kernels()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Show how long each kind of tests took, where they were shared out, and keep it if `make test` asks for it."""
    if not terminalreporter.config.getoption("numprocesses", None):
        return
    table = durations(terminalreporter)
    terminalreporter.section("seconds by kind")
    for kind, (seconds, count) in table.items():
        terminalreporter.write_line(f"{seconds:8.1f}  {kind}" + (f", {count} tests" if count else ""))
    if CHECKED in os.environ:
        with (ROOT / "durations.csv").open("a") as file:
            when = datetime.now().astimezone().isoformat(timespec="seconds")
            file.writelines(f'{when},"{kind}",{seconds:.1f},{count}\n' for kind, (seconds, count) in table.items())


def durations(reporter: pytest.TerminalReporter) -> dict[str, tuple[float, int]]:
    """Return the seconds of each kind, and its number of tests: as many as were waited for, on however many cores."""
    seconds, tests = Counter[str](), dict[str, set[str]]()
    for report in chain.from_iterable(reporter.stats.values()):
        if isinstance(report, pytest.TestReport):
            kind = str(Path(report.nodeid.partition("::")[0]).parent).split("/")[1:2]
            folder = "/".join(("tests", *kind))
            seconds[folder] += report.duration
            tests.setdefault(folder, set()).add(report.nodeid)
    table = {"compiling, once for these sources": (compile_kernels(), 0)}
    if CHECKED in os.environ:
        table["style, types, imports, beside compiling"] = (float(os.environ[CHECKED]), 0)
    return table | {folder: (seconds[folder], len(tests[folder])) for folder in sorted(seconds)}

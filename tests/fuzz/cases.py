"""Files with mistakes, one after the other, each read within bounds of memory and of processor time."""

import resource
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from random import Random
from types import FrameType

from tests.fuzz.mutating import mutated
from tests.fuzz.targets import TARGETS
from thbridge.files.errors import BadFile

SECONDS = 20.0
"""Processor time for one file; usual ones take some milliseconds."""
MEMORY = 1 << 30
"""Address space for one file, beside what the process has already."""


class TooSlow(BaseException):  # no except clause of a parser shall take it
    """A file took more processor time than any may."""


def fuzz(name: str, work: Path, seed: int, count: int) -> Iterator[str]:
    """Read files of a target with mistakes in them; yield what is wrong with those that the parser did not refuse well.

    Args:
        name: of the target.
        work: an empty folder.
        seed: of the mistakes.
        count: number of files.
    """
    target = TARGETS[name]
    whole, folder = work / "whole", work / "case"
    whole.mkdir()
    files = target.seeds(whole)
    for file in files:  # what is whole must be read, or mistakes are made in the wrong place
        shutil.copytree(whole, folder)
        target.read(folder, file)
        shutil.rmtree(folder)
    for number in range(count):
        file = files[number % len(files)]
        shutil.copytree(whole, folder)
        data = mutated((whole / file).read_bytes(), Random(f"{name} {seed} {number}"))
        (folder / file).write_bytes(data)
        try:
            with bounded(), suppress(BadFile):
                target.read(folder, file)
        except (Exception, TooSlow) as error:
            kept = work / f"{name}-{seed}-{number}-{Path(file).name}"
            kept.write_bytes(data)
            yield f"{type(error).__name__}: {str(error)[:200]} ({kept})"
        shutil.rmtree(folder)


@contextmanager
def bounded() -> Iterator[None]:
    """Bound memory and processor time of what is done within."""
    usual, most = resource.getrlimit(resource.RLIMIT_AS)
    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before = signal.signal(signal.SIGPROF, _end)
    resource.setrlimit(resource.RLIMIT_AS, (now + MEMORY, most))
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        resource.setrlimit(resource.RLIMIT_AS, (usual, most))
        signal.signal(signal.SIGPROF, before)


def _end(number: int, frame: FrameType | None) -> None:
    raise TooSlow(f"more than {SECONDS:g} s")

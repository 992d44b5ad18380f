"""Cases with mistakes, one after the other, each read within bounds of memory and of processor time."""

import resource
import shutil
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from random import Random
from types import FrameType

from tests.fuzz.messages import MESSAGES, MessageTarget
from tests.fuzz.mutating import mutated
from tests.fuzz.targets import TARGETS, Target
from thbridge.files.errors import BadFile

SECONDS = 20.0
"""Processor time for one case; usual ones take some milliseconds."""
MEMORY = 1 << 30
"""Address space for one case, beside what the process has already."""

ALL: dict[str, Target | MessageTarget] = {**TARGETS, **MESSAGES}


class TooSlow(BaseException):  # no except clause of a parser shall take it
    """A case took more processor time than any may."""


def fuzz(name: str, work: Path, seed: int, count: int, first: int = 0) -> Iterator[str]:
    """Read cases of a target; yield what is wrong with those that the parser did not refuse well.

    Args:
        name: of the target.
        work: an empty folder; what fails is kept in it.
        seed: of the mistakes.
        count: number of cases.
        first: number of the first one; a case depends on target, seed and number alone.
    """
    target = ALL[name]
    read = _of_files(target, work) if isinstance(target, Target) else _of_messages(target)
    for number in range(first, first + count):
        if (found := read(Random(f"{name} {seed} {number}"), number)) is not None:
            data, kind, error = found
            kept = work / f"{name}-{seed}-{number}-{kind}"
            kept.write_bytes(data)
            yield f"{type(error).__name__}: {str(error)[:200]} ({kept})"


Case = Callable[[Random, int], tuple[bytes, str, BaseException] | None]
"""Reads the case of a number; what was read and what went wrong, None when all is well."""


def _of_files(target: Target, work: Path) -> Case:
    whole, folder = work / "whole", work / "case"
    whole.mkdir()
    files = target.seeds(whole)
    for file in files:  # what is whole must be read, or mistakes are made in the wrong place
        shutil.copytree(whole, folder)
        target.read(folder, file)
        shutil.rmtree(folder)
    contents = {file: (whole / file).read_bytes() for file in files}
    if not target.writes:
        shutil.copytree(whole, folder)

    def read(random: Random, number: int) -> tuple[bytes, str, BaseException] | None:
        file = files[number % len(files)]
        data = mutated(contents[file], random)
        if target.writes:
            shutil.copytree(whole, folder)
        (folder / file).write_bytes(data)
        try:
            with bounded(), suppress(BadFile):
                target.read(folder, file)
        except (Exception, TooSlow) as error:
            return data, Path(file).name, error
        finally:
            if target.writes:
                shutil.rmtree(folder)
            else:
                (folder / file).write_bytes(contents[file])
        return None

    return read


def _of_messages(target: MessageTarget) -> Case:
    seeds = target.seeds()
    for data in seeds:
        target.read(data)

    def read(random: Random, number: int) -> tuple[bytes, str, BaseException] | None:
        data = mutated(seeds[number % len(seeds)], random)
        try:
            with bounded(), suppress(*target.refuses):
                target.read(data)
        except (Exception, TooSlow) as error:
            return data, "message", error
        return None

    return read


@contextmanager
def bounded() -> Iterator[None]:
    """Bound memory and processor time of what is done within."""
    usual, most = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm", "rb") as file:  # noqa: PTH123 - a path object takes as long as the rest of a case
        now = int(file.read().split()[0]) * resource.getpagesize()
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

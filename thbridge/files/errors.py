"""Errors of files that a person can correct."""

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_UNSEEN = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
"""Characters that control terminals or the writing direction, line ends, and bytes of names that are not UTF-8."""

_LONGEST = 1000
"""Maximum number of characters shown of a path or a key, because untrusted names may have half a million."""


def visible(text: str, keep: str = "") -> str:
    """Return untrusted text with control characters as escapes such as \\x1b, because they can clear screens and forge
    lines.

    Args:
        text: the text.
        keep: control characters that stay.
    """
    return _UNSEEN.sub(lambda found: found[0] if found[0] in keep else repr(found[0])[1:-1], text)


class BadFile(Exception):  # noqa: N818 - it names the fault of a file, and people read it as a sentence
    """A fault of a file that people write: position, problem and remedy.

    `str()` gives the message to show, on one line: `PATH, line N, KEY: problem. Remedy.`

    Attributes:
        path: the faulty file or folder.
        line: line number from 1, or None when no single line is at fault.
        key: the faulty word, key or column, or None.
        problem: the problem as a clause without a full stop.
        remedy: the remedy as a clause without a full stop.
    """

    def __init__(self, path: Path, problem: str, remedy: str, line: int | None = None, key: str | None = None) -> None:
        self.path = path
        self.line = line
        self.key = key
        self.problem = problem
        self.remedy = remedy
        where = [str(path)]
        if line is not None:
            where.append(f"line {line}")
        if key is not None:
            where.append(key)
        remedy = remedy[:1].upper() + remedy[1:].rstrip(".")
        where = [word if len(word) <= _LONGEST else f"{word[:_LONGEST]}..." for word in where]
        super().__init__(visible(f"{', '.join(where)}: {problem.rstrip('.')}. {remedy}."))

    def __reduce__(self) -> tuple[type["BadFile"], tuple[Path, str, str, int | None, str | None]]:
        return (type(self), (self.path, self.problem, self.remedy, self.line, self.key))


class BadFiles(BadFile):
    """All faults of a file, so that people can correct them together.

    `str()` gives one line for each fault; the attributes are those of the first fault.

    Attributes:
        faults: the faults, at least one.
    """

    def __init__(self, faults: tuple[BadFile, ...]) -> None:
        first = faults[0]
        super().__init__(first.path, first.problem, first.remedy, first.line, first.key)
        self.faults = faults

    def __str__(self) -> str:
        return "\n".join(str(fault) for fault in self.faults)

    def __reduce__(self) -> tuple[type["BadFiles"], tuple[tuple[BadFile, ...]]]:  # type: ignore[override]  # as built
        return (type(self), (self.faults,))


class FaultCollection:
    """Faults of several files, read one after the other, so that people can correct them together.

    Attributes:
        found: all faults so far.
    """

    def __init__(self) -> None:
        self.found: list[BadFile] = []

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Store a fault that is raised in this context, and continue."""
        try:
            yield
        except BadFiles as several:
            self.found += several.faults
        except BadFile as fault:
            self.found.append(fault)

    def together(self) -> BadFile:
        """Return the only fault, or all of them together. At least one must have been found."""
        return self.found[0] if len(self.found) == 1 else BadFiles(tuple(self.found))

    def raise_any(self) -> None:
        """Raise all faults together, if there are any."""
        if self.found:
            raise self.together()


def reason_of(error: OSError) -> str:
    """Return the system's text for an error, without the function and address that asyncio adds."""
    # Failed lookups of host names have negative numbers and their own texts.
    if error.errno is not None and error.errno > 0:
        return os.strerror(error.errno)
    if isinstance(error, shutil.Error) and (number := re.search(r"\[Errno (\d+)\]", str(error))):
        # A copied folder has one error for each file, and most are the same.
        return os.strerror(int(number[1]))
    return error.strerror or str(error)

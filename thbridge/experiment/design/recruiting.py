"""Recruiting of people by links: codes, parameters in the address, and what follows each ending of a run."""

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from urllib.parse import quote, urlsplit

from sim.parameters import param
from thbridge.files.disk.text_files import read_text
from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile

CODE = "code"
"""Name of the parameter with a person's code in the address of a link."""
MOST_PARAMETERS = 8
LONGEST_ADDRESS = 500
"""Maximum length of an ending, in characters."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
_CODE = re.compile(r"[A-Za-z0-9_-]{12,64}")
"""Pattern of a code. A random code of 12 of these 64 characters has 72 bits."""
_LETTERS, _LENGTH = "23456789ABCDEFGHJKMNPQRSTVWXYZ", 16
"""Characters of the codes that this program creates, and their number: 78 bits. No two characters look alike."""
_VALUE = re.compile(r"[A-Za-z0-9_.-]{1,64}")
_COMPLETION_CODE = re.compile(r"[A-Za-z0-9_-]{1,64}")
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")


class Ending(StrEnum):
    """Ending of a person's visit to a study; the values are keys of `recruiting.endings`."""

    COMPLETE = "complete"
    FAILED_CHECK = "failed_check"
    DECLINED = "declined"
    ENDED_EARLY = "ended_early"
    FULL = "full"
    TIMED_OUT = "timed_out"
    NO_GROUP = "no_group"


@dataclass(frozen=True, slots=True)
class EndingsSection:
    """Endings for people in browsers: for each, an address of a recruiting service (https) or a completion code."""

    complete: str = param("", "for people who completed the study")
    failed_check: str = param("", "for people who failed a check")
    declined: str = param("", "for people who did not agree to take part")
    ended_early: str = param("", "for people who stopped, or whose run ended for another reason")
    full: str = param("", "for people who arrive when the study is complete")
    timed_out: str = param("", "for people who were absent for too long; see `presence`")
    no_group: str = param(
        "", "for people who waited in vain for a game of several people; if empty, they get a completion code"
    )


@dataclass(frozen=True, slots=True)
class RecruitingSection:
    """Entry of people from a recruiting service into a study, and the endings that they get."""

    ask: str = param(
        "", "question for people's code from the recruiting service, before the first step; if empty, no question"
    )
    codes: Path | None = param(
        None,
        "path of a file with one code per line, relative to the folder of this file; in a browser, only people with a "
        "code can enter, and each code admits one person; if null, no code is needed",
    )
    parameters: tuple[str, ...] = param(
        ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID"),
        "parameters of the link that are kept in the log; the first one identifies the person if no code is needed",
    )
    endings: EndingsSection = param(
        EndingsSection(),
        "what people in browsers get at the end: an address that begins with https://, or a completion code; "
        "{NAME} in an address is replaced by a parameter of the link",
    )


def recruiting_problems(recruiting: RecruitingSection) -> Iterator[tuple[str, str, str]]:
    """Yield faults: key, problem and remedy."""
    names, key = recruiting.parameters, "recruiting.parameters"
    if len(names) > MOST_PARAMETERS:
        yield key, f"the list has {len(names)} names", f"Write at most {MOST_PARAMETERS}"
    for index, name in enumerate(names):
        if not _NAME.fullmatch(name) or name == CODE or name in names[:index]:
            problem = f"{name} is not a name of a parameter, or is not unique"
            yield f"{key}[{index}]", problem, f"Write a name of letters, digits and _, other than {CODE}"
    for ending in Ending:
        value, key = ending_of(recruiting, ending), f"recruiting.endings.{ending}"
        for name in _PLACEHOLDER.findall(value):
            if name not in names:
                problem = f"{{{name}}} is not a parameter of the link"
                yield key, problem, f"Write one of {', '.join(names)}, or add the name to recruiting.parameters"
        if value and not _COMPLETION_CODE.fullmatch(value) and not _is_address(_PLACEHOLDER.sub("x", value)):
            problem = f"{value} is neither an address that begins with https:// nor a completion code"
            yield key, problem, "Write such an address, or a code of letters, digits, - and _"


def ending_of(recruiting: RecruitingSection, ending: Ending, parameters: Mapping[str, str] | None = None) -> str:
    """Return the address or completion code of an ending; empty if there is none.

    Args:
        recruiting: section of the study.
        ending: the ending.
        parameters: values that replace placeholders in an address; if None, placeholders stay.
    """
    value = str(getattr(recruiting.endings, ending.value))
    if parameters is None:
        return value
    return _PLACEHOLDER.sub(lambda found: quote(parameters.get(found[1], ""), safe=""), value)


def is_address(ending: str) -> bool:
    """Return True if an ending is an address, and False if it is a completion code."""
    return ending.startswith("https://")


def _is_address(value: str) -> bool:
    try:
        parts = urlsplit(value)
    except ValueError:
        return False
    plain = value.isascii() and value.isprintable() and not set(' "<>{}\\^`') & set(value)
    return is_address(value) and bool(parts.hostname) and plain and len(value) <= LONGEST_ADDRESS


def is_value(value: str) -> bool:
    """Return True if a recruiting service may send this value of a parameter."""
    return _VALUE.fullmatch(value) is not None


class LinkCodes:
    """Codes that admit people to a study.

    Args:
        codes: the codes.
    """

    def __init__(self, codes: Sequence[str]) -> None:
        # A digest is looked up, so the time of the look-up does not depend on the characters of a guessed code.
        self._digests = frozenset(map(digest_of_code, codes))

    def __contains__(self, code: object) -> bool:
        return isinstance(code, str) and digest_of_code(code) in self._digests


def read_codes(path: Path) -> list[str]:
    """Return the codes in a file with one code per line; empty lines do not count.

    Raises:
        BadFile: the file cannot be read, has no code, or a code is too short, damaged or not unique.
    """
    remedy = "Create codes: thbridge study codes FOLDER"
    try:
        lines = read_text(path).splitlines()
    except BadFile as fault:
        raise BadFile(path, fault.problem, remedy) from None
    codes: dict[str, int] = {}
    for number, line in enumerate(lines, start=1):
        if not (code := line.strip()):
            continue
        if not _CODE.fullmatch(code):
            problem = "a code must have 12 to 64 letters, digits, - or _, so that no one can guess it"
            raise BadFile(path, problem, remedy, line=number)
        if code in codes:
            raise BadFile(path, f"this code is also on line {codes[code]}", "Delete one of the lines", line=number)
        codes[code] = number
    if not codes:
        raise BadFile(path, "the file has no code", remedy)
    return list(codes)


def link_codes(recruiting: RecruitingSection, folder: Path) -> LinkCodes | None:
    """Return the codes of the study in a folder; None if no code is needed.

    Raises:
        BadFile: see `read_codes`.
    """
    return None if recruiting.codes is None else LinkCodes(read_codes(folder / recruiting.codes))


def add_codes(path: Path, number: int, draw: Callable[[int], int]) -> list[str]:
    """Create codes and add them to a file, which need not exist; return the new codes.

    Args:
        path: the file.
        number: number of codes to create.
        draw: function that returns a secret random whole number from 0 to n - 1, where n is its argument.

    Raises:
        BadFile: the file cannot be written, or its present codes are faulty.
    """
    present = read_codes(path) if path.exists() else []
    made = ["".join(_LETTERS[draw(len(_LETTERS))] for _ in range(_LENGTH)) for _ in range(number)]
    write_whole(path, "".join(f"{code}\n" for code in (*present, *made)).encode())
    return made


def link_with(address: str, code: str) -> str:
    """Return the link with a code; `address` is that of the server."""
    return f"{address.rstrip('/')}/?{CODE}={code}"


def digest_of_code(code: str) -> bytes:
    """Return the digest of a link's code."""
    return hashlib.sha256(code.encode()).digest()

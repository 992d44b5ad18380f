"""Reads argumentation frameworks in the formats of solvers.

APX has a fact for each argument and each attack (`arg(a).`, `att(a,b).`), TGF a line for each, with a line `#` between
them. The numeric format of the competitions from 2023 on (AF) says in its first line how many arguments there are
(`p af 3`), and then has a line for each attack (`1 2`).
"""

import re
from pathlib import Path

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection

_NAME = r"[^\s(),]+"
_FACT = re.compile(rf"\s*(?:(arg)\s*\(\s*({_NAME})\s*\)|(att)\s*\(\s*({_NAME})\s*,\s*({_NAME})\s*\))\s*(\.?)\s*")
_NAMES_HOLD = "names hold no blanks, commas or brackets"
_NUMBER = re.compile(r"[1-9][0-9]*|0")
_LARGEST = 64_000_000
"""Bytes."""
_MOST_ARGUMENTS = 10_000_000
"""That a number in a file may declare."""
_LONGEST = 60
"""Letters of a file that are told in a fault."""
_MOST_FAULTS = 20
"""After so many the rest is not read: it is another kind of file."""


def read_framework(path: Path) -> ArgumentationFramework:
    """Read a framework; its name says in which format it is.

    Raises:
        BadFile: it cannot be read, or is not of its format; faults of several lines together.
    """
    match path.suffix.lower():
        case ".apx":
            return _read_apx(path)
        case ".tgf":
            return _read_tgf(path)
        case ".af":
            return _read_af(path)
    raise BadFile(path, "its name does not say what it is", "give a file whose name ends in .apx, .tgf or .af")


class _Facts:
    """The arguments and attacks of a file, and what is wrong with its lines."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._arguments: dict[str, int] = {}
        self._attacks: dict[tuple[str, str], int] = {}
        self.faults = FaultCollection()

    def fail(self, line: int, problem: str, remedy: str) -> None:
        if len(self.faults.found) == _MOST_FAULTS:
            raise self.faults.together()
        with self.faults.kept():
            raise BadFile(self._path, problem, remedy, line=line)

    def argue(self, name: str, line: int, remedy: str = "take one of them away") -> None:
        if not name.isprintable():
            # It would be printed as it stands, and might command the terminal.
            self.fail(line, f"the name {_start(name)} has signs that cannot be printed", "write it with others")
        elif name in self._arguments:
            self.fail(line, f"the argument {name} is there twice, first in line {self._arguments[name]}", remedy)
        else:
            self._arguments[name] = line

    def attack(self, attacker: str, target: str, line: int) -> None:
        self._attacks.setdefault((attacker, target), line)

    def framework(self) -> ArgumentationFramework:
        # What a line that cannot be read declares is not known.
        attacks = {} if self.faults.found else self._attacks
        for attack, line in attacks.items():
            for name in dict.fromkeys(attack):
                if name not in self._arguments:
                    self.fail(line, f"there is no argument {name}", "declare it, or mend its name")
        if self.faults.found:
            raise self.faults.together()
        return ArgumentationFramework.of(self._arguments, self._attacks)


def _read_apx(path: Path) -> ArgumentationFramework:
    facts = _Facts(path)
    for number, line in enumerate(read_text(path, _LARGEST).splitlines(), start=1):
        text, at = line.partition("%")[0].rstrip(), 0
        while at < len(text):
            fact = _FACT.match(text, at)
            if fact is None:
                remedy = f"write arg(NAME). or att(ATTACKER,TARGET). and a percent sign before comments; {_NAMES_HOLD}"
                facts.fail(number, f"{_start(text[at:])} cannot be read", remedy)
                break
            at = fact.end()
            if not fact[6]:
                facts.fail(number, f"there is no full stop after {fact[0].strip()}", "put one there")
            if fact[1]:
                facts.argue(fact[2], number)
            else:
                facts.attack(fact[4], fact[5], number)
    return facts.framework()


def _read_tgf(path: Path) -> ArgumentationFramework:
    facts, is_of_attacks = _Facts(path), False
    for number, line in enumerate(read_text(path, _LARGEST).splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        # Further words are labels.
        names = words[: 2 if is_of_attacks else 1]
        if words == ["#"]:
            is_of_attacks = True
        elif strange := [name for name in names if not re.fullmatch(_NAME, name)]:
            facts.fail(number, f"{_start(strange[0])} is no name of an argument", f"mend it: {_NAMES_HOLD}")
        elif not is_of_attacks:
            facts.argue(names[0], number, "take one of them away; attacks come after a line with a # alone")
        elif len(names) == 2:
            facts.attack(names[0], names[1], number)
        else:
            facts.fail(number, f"{_start(line)} is no attack", "write the attacker, a blank and what it attacks")
    return facts.framework()


def _read_af(path: Path) -> ArgumentationFramework:
    facts, count = _Facts(path), None
    for number, line in enumerate(read_text(path, _LARGEST).splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        numbers = [int(word) for word in words if len(word) < 10 and _NUMBER.fullmatch(word)]
        if count is None:
            if words[:2] != ["p", "af"] or len(words) != 3 or len(numbers) != 1 or numbers[0] > _MOST_ARGUMENTS:
                remedy = f"begin with p af and the number of arguments, at most {_MOST_ARGUMENTS}: p af 3"
                raise BadFile(path, f"{_start(line)} does not say how many arguments there are", remedy, line=number)
            count = numbers[0]
            for each in range(1, count + 1):
                facts.argue(str(each), number)
        elif len(words) == 2 and len(numbers) == 2 and all(1 <= each <= count for each in numbers):
            facts.attack(words[0], words[1], number)
        else:
            remedy = f"write the attacker, a blank and what it attacks, numbers from 1 to {count}"
            facts.fail(number, f"{_start(line)} is no attack", remedy)
    if count is None:
        raise BadFile(path, "it does not say how many arguments there are", "begin with a line like p af 3")
    return facts.framework()


def _start(text: str) -> str:
    """The text in quotes, or as much of it as a sentence bears."""
    text = text.strip()
    return repr(text if len(text) <= _LONGEST else f"{text[:_LONGEST]}...")

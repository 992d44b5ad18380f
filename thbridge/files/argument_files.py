"""Reading of argumentation frameworks in the formats of solvers.

APX has a fact for each argument and each attack (`arg(a).`, `att(a,b).`). TGF has a line for each argument, then a line
`#`, then a line for each attack. AF is the numeric format of the competitions since 2023. The first line of an AF file
gives the number of arguments (`p af 3`). Each further line is an attack (`1 2`).
"""

import re
from pathlib import Path

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, FaultCollection

_NAME = r"[^\s(),]+"
_FACT = re.compile(rf"\s*(?:(arg)\s*\(\s*({_NAME})\s*\)|(att)\s*\(\s*({_NAME})\s*,\s*({_NAME})\s*\))\s*(\.?)\s*")
_NAMES_HOLD = "names cannot contain blanks, commas or brackets"
_NUMBER = re.compile(r"[1-9][0-9]*|0")
_LARGEST = 64_000_000
"""Largest size of a file, bytes."""
_MOST_ARGUMENTS = 10_000_000
"""Maximum number of arguments that a file may declare."""
_LONGEST = 60
"""Maximum number of characters that a message quotes from a file."""
_MOST_FAULTS = 20
"""Reading stops after this number of faults, because the file probably has another format."""


def read_framework(path: Path) -> ArgumentationFramework:
    """Read a framework; the suffix of the file's name gives the format.

    Raises:
        BadFile: the file cannot be read, or does not follow the format; faults of several lines are raised together.
    """
    match path.suffix.lower():
        case ".apx":
            return _read_apx(path)
        case ".tgf":
            return _read_tgf(path)
        case ".af":
            return _read_af(path)
    raise BadFile(path, "the suffix does not show the format", "name a file with the suffix .apx, .tgf or .af")


class _Facts:
    """The arguments and attacks of a file, and the faults of its lines."""

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

    def argue(self, name: str, line: int, remedy: str = "delete one of the two") -> None:
        if not name.isprintable():
            # The name would be printed unchanged, so its control characters could change the terminal.
            self.fail(line, f"the name {_start(name)} has characters that cannot be printed", "choose other characters")
        elif name in self._arguments:
            self.fail(line, f"the argument {name} is defined twice, first in line {self._arguments[name]}", remedy)
        else:
            self._arguments[name] = line

    def attack(self, attacker: str, target: str, line: int) -> None:
        self._attacks.setdefault((attacker, target), line)

    def framework(self) -> ArgumentationFramework:
        # Unreadable lines may declare further arguments, so attacks cannot be checked.
        attacks = {} if self.faults.found else self._attacks
        for attack, line in attacks.items():
            for name in dict.fromkeys(attack):
                if name not in self._arguments:
                    self.fail(line, f"no argument {name} is defined", "declare this argument, or correct its name")
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
                facts.fail(number, f"the full stop after {fact[0].strip()} is missing", "add it")
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
            facts.fail(number, f"{_start(strange[0])} is not a name of an argument", f"correct the name: {_NAMES_HOLD}")
        elif not is_of_attacks:
            facts.argue(names[0], number, "delete one of the two; write attacks below a line that has only a #")
        elif len(names) == 2:
            facts.attack(names[0], names[1], number)
        else:
            facts.fail(number, f"{_start(line)} is not an attack", "write the attacker, a blank, and its target")
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
                raise BadFile(path, f"{_start(line)} does not give the number of arguments", remedy, line=number)
            count = numbers[0]
            for each in range(1, count + 1):
                facts.argue(str(each), number)
        elif len(words) == 2 and len(numbers) == 2 and all(1 <= each <= count for each in numbers):
            facts.attack(words[0], words[1], number)
        else:
            remedy = f"write the attacker, a blank, and its target, as numbers from 1 to {count}"
            facts.fail(number, f"{_start(line)} is not an attack", remedy)
    if count is None:
        raise BadFile(path, "the number of arguments is missing", "begin with a line like p af 3")
    return facts.framework()


def _start(text: str) -> str:
    """Return the text in quotes, cut to a length that fits into a sentence."""
    text = text.strip()
    return repr(text if len(text) <= _LONGEST else f"{text[:_LONGEST]}...")

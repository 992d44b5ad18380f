"""Reads argumentation frameworks in the formats of solvers: APX (`arg(a).`, `att(a,b).`) and trivial graphs (TGF)."""

import re
from pathlib import Path

from thbridge.argumentation.framework import ArgumentationFramework
from thbridge.files.errors import BadFile, FaultCollection
from thbridge.files.yaml.tree import read_text

APX, TGF = ".apx", ".tgf"
_FACT = re.compile(r"\s*(?:(arg)\s*\(\s*([^\s(),]+)\s*\)|(att)\s*\(\s*([^\s(),]+)\s*,\s*([^\s(),]+)\s*\))\s*\.\s*")
_LARGEST = 64_000_000
"""Bytes."""


def read_framework(path: Path) -> ArgumentationFramework:
    """Read a framework; its name says in which format it is.

    Raises:
        BadFile: it cannot be read, or is not of its format; faults of several lines together.
    """
    if path.suffix.lower() == APX:
        return _read_apx(path)
    if path.suffix.lower() == TGF:
        return _read_tgf(path)
    raise BadFile(path, "its name does not say what it is", f"give a file whose name ends in {APX} or {TGF}")


class _Facts:
    """The arguments and attacks of a file, and what is wrong with its lines."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._arguments: dict[str, int] = {}
        self._attacks: dict[tuple[str, str], int] = {}
        self.faults = FaultCollection()

    def fail(self, line: int, problem: str, remedy: str) -> None:
        with self.faults.kept():
            raise BadFile(self._path, problem, remedy, line=line)

    def argue(self, name: str, line: int) -> None:
        if name in self._arguments:
            first = self._arguments[name]
            self.fail(line, f"the argument {name} is there twice, first in line {first}", "take one of them away")
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
        text, at = line.partition("%")[0], 0
        while at < len(text.rstrip()):
            fact = _FACT.match(text, at)
            if fact is None:
                remedy = "write arg(NAME). or att(ATTACKER,TARGET). and a percent sign before comments"
                facts.fail(number, f"{text[at:].strip()!r} cannot be read", remedy)
                break
            at = fact.end()
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
        if words == ["#"]:
            is_of_attacks = True
        elif not is_of_attacks:
            facts.argue(words[0], number)
        elif len(words) > 1:
            facts.attack(words[0], words[1], number)
        else:
            facts.fail(number, f"{line.strip()!r} is no attack", "write the attacker, a blank and what it attacks")
    return facts.framework()

"""Plug-ins: programs of labs that replace a part of a session, found by their entry points."""

import difflib
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, redirect_stdout
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from thbridge.dialogue.other_programs import RAISED, told_error
from thbridge.files.errors import BadFile


@dataclass(frozen=True, slots=True)
class PluginKind:
    """Kind of plug-ins. Names are only looked up when needed, and a plug-in is only imported when it is loaded.

    Attributes:
        group: group of entry points.
        what: name of the kind in sentences.
    """

    group: str
    what: str

    def key(self, name: str) -> str:
        """Return the key under which the version of a plug-in is recorded, such as `thbridge.strategies:polite`."""
        return f"{self.group}:{name}"

    def names(self) -> tuple[str, ...]:
        """Return the installed names, in alphabetical order."""
        return names_in(self.group)

    def describe(self, name: str) -> str:
        """Return the value of a name's entry point, and its package: `lab:Filter, of the package lab 1.0`."""
        entry = self._entry(name)
        return f"{entry.value}, of the package {_package(entry)}"

    def package(self, name: str) -> str:
        """Return the package and version of an installed name, such as `lab 1.0`. Otherwise raise BadFile."""
        return _package(self._entry(name))

    def load(self, name: str) -> Callable[..., Any]:  # type: ignore[explicit-any]  # of others
        """Return the object that the entry point of a name refers to.

        Raises:
            BadFile: no plug-in of this name is installed, or the plug-in cannot be imported or called.
        """
        entry = self._entry(name)
        try:
            with printing_aside():
                program: object = entry.load()
        except RAISED as error:
            problem = f"{entry.value} cannot be imported: {type(error).__name__}: {error}"
            raise self.fault(name, problem, "Correct the plug-in, or install the package again") from error
        if not callable(program):
            raise self.fault(name, f"{entry.value} is not a function", "Name a function, or a class")
        return program

    def made(self, name: str, make: Callable[[], object], methods: tuple[str, ...], takes: str) -> None:
        """Test a factory by making its product.

        Args:
            name: name of the plug-in.
            make: calls the factory.
            methods: names of the methods that its product needs.
            takes: arguments of the factory, in words.

        Raises:
            BadFile: the product cannot be made, or lacks a method.
        """
        remedy = f"Name a class or function with the arguments {takes}; its result needs a method `{methods[0]}`"
        try:
            with printing_aside():
                product = make()
        except RAISED as error:
            raise self.fault(name, f"making the object failed: {told_error(error)}", remedy) from error
        lacking = next((method for method in methods if not callable(getattr(product, method, None))), None)
        if lacking is not None:
            raise self.fault(name, f"the result is a {type(product).__name__}, which has no method {lacking}", remedy)

    def fault(self, name: str, problem: str, remedy: str) -> BadFile:
        """Return a fault of a plug-in, with its package."""
        return BadFile(Path(self.group), f"package {self.package(name)}: {problem}", remedy, key=name)

    def _entry(self, name: str) -> EntryPoint:
        found = {each.name: each for each in entry_points(group=self.group)}
        if name not in found:
            near = difflib.get_close_matches(name, found, n=1)
            installed = f"Installed are: {', '.join(sorted(found))}" if found else "No such plug-in is installed"
            remedy = f"The nearest name is {near[0]}" if near else installed
            raise BadFile(Path(self.group), f"no {self.what} {name} is installed", remedy, key=name)
        return found[name]


STRATEGIES = PluginKind("thbridge.strategies", "strategy")
WORDINGS = PluginKind("thbridge.wordings", "author of wordings")
PARTICIPANTS = PluginKind("thbridge.participants", "simulated participant")
LOCALIZERS = PluginKind("thbridge.localizers", "localizer")
PLANNERS = PluginKind("thbridge.global_planners", "global planner")
RECOVERIES = PluginKind("thbridge.recovery_behaviors", "recovery behavior")
KINDS = (STRATEGIES, WORDINGS, PARTICIPANTS, LOCALIZERS, PLANNERS, RECOVERIES)
"""All kinds."""


def names_in(group: str) -> tuple[str, ...]:
    """Return the installed names in a group of entry points, in alphabetical order."""
    return tuple(sorted(entry_points(group=group).names))


def package_of(key: str) -> str | None:
    """Return the package and version of the plug-in with this key; None if there is no such plug-in."""
    group, _, name = key.partition(":")
    found = [*entry_points(group=group, name=name)] if name else []
    return _package(found[-1]) if found else None


def printing_aside() -> AbstractContextManager[object]:
    """Return a context that sends a plug-in's output to standard error, because standard output is for results."""
    return redirect_stdout(sys.stderr)


def _package(entry: EntryPoint) -> str:
    return "unknown" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"

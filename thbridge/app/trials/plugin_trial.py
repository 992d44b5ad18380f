"""Findings of a trial of a plug-in."""

import hashlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from thbridge.app.compose.installed_parts import PartCaller
from thbridge.dialogue.trials.faults import TrialFault
from thbridge.timing.slow_calls import ImpatientCaller, Stopwatch

T = TypeVar("T")

SLOWEST = 100.0
"""Largest factor by which a plug-in may be slower than the built-in part in the same situations."""
NOT_DETERMINED = "with the same seed, it decided differently the second time"
DETERMINED = "Use the arguments alone: keep nothing in the module, draw random numbers by the seed, sort sets"


@dataclass(slots=True)
class PluginTrial:
    """Trial of a plug-in.

    Attributes:
        what: name of the kind of plug-in.
        situations: number of situations in which it was tried.
        faults: faults by their problems.
        digest: digest of all its results; the same in each process.
        own: measures the time of its calls.
        built_in: measures the time of calls of the built-in part.
    """

    what: str
    situations: int = 0
    faults: dict[str, TrialFault] = field(default_factory=dict)
    digest: str = ""
    own: Stopwatch = field(default_factory=Stopwatch)
    built_in: Stopwatch = field(default_factory=Stopwatch)

    @property
    def slowness(self) -> float:
        """Time of its calls, as a multiple of the built-in part's."""
        return self.own.seconds / self.built_in.seconds if self.built_in.seconds else 0.0

    def note(self, problem: str, remedy: str, position: Iterable[str]) -> None:
        """Keep a fault, with the position in which it occurred first."""
        fault = self.faults.get(problem) or TrialFault(problem, remedy, tuple(position), 0)
        self.faults[problem] = replace(fault, times=fault.times + 1)

    def twice(self, title: str, play: Callable[[], Iterable[str]]) -> None:
        """Play a situation twice, and compare the plug-in's results.

        Args:
            title: title of the situation.
            play: plays it, and yields all results of the plug-in as text.
        """
        self.situations += 1
        first, again = [*play()], [*play()]
        self.digest = hashlib.sha256("\n".join((self.digest, *first)).encode()).hexdigest()
        if first != again:
            at = next((i for i, pair in enumerate(zip(first, again, strict=False)) if pair[0] != pair[1]), -1)
            shown = (f"First: {each[at][:300]}" if each else "Nothing" for each in (first, again))
            self.note(NOT_DETERMINED, DETERMINED, (title, *shown))

    def caller(self, seconds: float) -> PartCaller:
        """Return the function that calls the plug-in: it measures the time of calls, and gives each a timeout."""
        impatient = ImpatientCaller[Any](seconds)

        def call(asked: Callable[[], T], /) -> T:
            returned: T = impatient.call(lambda: self.own.measure(asked))
            return returned

        return call

    def end(self) -> None:
        """Judge the plug-in's speed; must be called once, at the end."""
        if self.slowness > SLOWEST:
            # The text omits the measured factor, which differs in each run.
            problem = f"it takes more than {SLOWEST:.0f} times as long as the built-in {self.what}"
            self.note(problem, "Prepare in the factory what every call needs, or use numpy", ())

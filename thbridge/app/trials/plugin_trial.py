"""Trial of a plug-in, with its findings."""

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
NOT_DETERMINED = "with the same seed, a second run gave another result"
DETERMINED = "Use only the arguments: store nothing in the module, take random numbers from the seed, and sort sets"


@dataclass(slots=True)
class PluginTrial:
    """Trial of a plug-in.

    Attributes:
        what: name of the kind of plug-in.
        situations: number of situations in which the plug-in was tried.
        faults: faults, by the text of the problem.
        digest: digest of all results, which is the same in every process.
        own: stopwatch for the calls of the plug-in.
        built_in: stopwatch for the calls of the built-in part.
    """

    what: str
    situations: int = 0
    faults: dict[str, TrialFault] = field(default_factory=dict)
    digest: str = ""
    own: Stopwatch = field(default_factory=Stopwatch)
    built_in: Stopwatch = field(default_factory=Stopwatch)

    @property
    def slowness(self) -> float:
        """Time of the plug-in's calls, divided by the time of the built-in part's calls."""
        return self.own.seconds / self.built_in.seconds if self.built_in.seconds else 0.0

    def note(self, problem: str, remedy: str, position: Iterable[str]) -> None:
        """Record a fault, with the position in which it first occurred."""
        fault = self.faults.get(problem) or TrialFault(problem, remedy, tuple(position), 0)
        self.faults[problem] = replace(fault, times=fault.times + 1)

    def twice(self, title: str, play: Callable[[], Iterable[str]]) -> None:
        """Run a situation twice, and compare the plug-in's results.

        Args:
            title: title of the situation.
            play: function that runs the situation, and yields all results of the plug-in as text.
        """
        self.situations += 1
        first, again = [*play()], [*play()]
        self.digest = hashlib.sha256("\n".join((self.digest, *first)).encode()).hexdigest()
        if first != again:
            at = next((i for i, pair in enumerate(zip(first, again, strict=False)) if pair[0] != pair[1]), -1)
            shown = (f"First: {each[at][:300]}" if each else "Nothing" for each in (first, again))
            self.note(NOT_DETERMINED, DETERMINED, (title, *shown))

    def caller(self, seconds: float) -> PartCaller:
        """Return the function that calls the plug-in with a timeout, and measures the time."""
        impatient = ImpatientCaller[Any](seconds)

        def call(asked: Callable[[], T], /) -> T:
            returned: T = impatient.call(lambda: self.own.measure(asked))
            return returned

        return call

    def end(self) -> None:
        """Check the plug-in's speed; call this method once, at the end."""
        if self.slowness > SLOWEST:
            # The text omits the measured factor, which differs in each run.
            problem = f"the plug-in takes more than {SLOWEST:.0f} times as long as the built-in {self.what}"
            self.note(problem, "Do slow preparations in the factory, or use numpy", ())

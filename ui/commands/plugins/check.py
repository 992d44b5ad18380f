"""Checks and lists of plug-ins, for `thbridge plugins`."""

import multiprocessing
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from thbridge.app.trials.localizer_check import try_localizer
from thbridge.app.trials.participant_check import try_participant
from thbridge.app.trials.planner_check import try_planner
from thbridge.app.trials.plugin_trial import DETERMINED, PluginTrial
from thbridge.app.trials.recovery_check import try_recovery
from thbridge.files.plugins import KINDS, LOCALIZERS, PARTICIPANTS, PLANNERS, RECOVERIES, PluginKind
from ui.commands.talk.check import counted
from ui.commands.talk.trial_faults import fault_as_json, fault_lines

LONGEST = 5.0
"""Seconds of wall time after which a call counts as one that never ends."""

TRIALS: Mapping[PluginKind, Callable[[str, int, float], PluginTrial]] = {
    PARTICIPANTS: try_participant,
    LOCALIZERS: try_localizer,
    PLANNERS: try_planner,
    RECOVERIES: try_recovery,
}
"""Trial of each kind of plug-in, given a name, a seed and the seconds that a call may take."""


@dataclass(frozen=True, slots=True)
class PluginCheck:
    """Result of the check of a plug-in.

    Attributes:
        kind: of the plug-in.
        name: of the plug-in.
        package: its package and version.
        trial: the findings.
    """

    kind: PluginKind
    name: str
    package: str
    trial: PluginTrial

    @property
    def ok(self) -> bool:
        """True when nothing is wrong."""
        return not self.trial.faults

    def lines(self) -> Iterator[str]:
        """Yield the sentences for people."""
        faults = [*self.trial.faults.values()]
        yield from fault_lines(self.name, faults)
        tried = f"{self.name} ({self.package}): {self.trial.situations} situations, each twice"
        yield f"{tried}, {self.trial.slowness:.2g} times the time of the built-in {self.trial.what}, " + counted(
            "fault", faults
        )

    def as_json(self) -> Mapping[str, object]:
        """Return the values for programs."""
        return {
            "name": self.name,
            "kind": self.kind.what,
            "package": self.package,
            "situations": self.trial.situations,
            "slowness": round(self.trial.slowness, 3),
            "faults": [*map(fault_as_json, self.trial.faults.values())],
        }


def check_plugin(kind: PluginKind, name: str, seed: int) -> PluginCheck:
    """Check a plug-in: here, and again in a process of its own.

    Args:
        kind: of the plug-in.
        name: of the plug-in.
        seed: random seed.

    Raises:
        BadFile: there is no such plug-in, or it cannot be made.
    """
    trial = TRIALS[kind](name, seed, LONGEST)
    if not trial.faults:
        # Another process has another order of sets, and imports the module again.
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            other = pool.submit(TRIALS[kind], name, seed, LONGEST).result()
        if other.digest != trial.digest:
            trial.note("in another process it decided otherwise with the same seed", DETERMINED, ())
    return PluginCheck(kind, name, kind.package(name), trial)


def listed() -> Iterator[tuple[PluginKind, str, str]]:
    """Yield the kind, name and description of each plug-in that is installed; none is loaded for it."""
    for kind in KINDS:
        for name in kind.names():
            yield kind, name, kind.describe(name)

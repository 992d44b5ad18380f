"""Checks and lists of plug-ins for `thbridge plugins`."""

import multiprocessing
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor

from thbridge.app.trials.localizer_check import try_localizer
from thbridge.app.trials.participant_check import try_participant
from thbridge.app.trials.planner_check import try_planner
from thbridge.app.trials.plugin_trial import DETERMINED, PluginTrial
from thbridge.app.trials.recovery_check import try_recovery
from thbridge.files.plugins import KINDS, LOCALIZERS, PARTICIPANTS, PLANNERS, RECOVERIES, PluginKind
from ui.commands.talk.trial_report import LONGEST, TrialReport

TRIALS: Mapping[PluginKind, Callable[[str, int, float], PluginTrial]] = {
    PARTICIPANTS: try_participant,
    LOCALIZERS: try_localizer,
    PLANNERS: try_planner,
    RECOVERIES: try_recovery,
}
"""Trial of each kind of plug-in. A trial receives a name, a seed and the time limit of a call in seconds."""


def check_plugin(kind: PluginKind, name: str, seed: int) -> TrialReport:
    """Check a plug-in in this process, and again in another process.

    Args:
        kind: kind of the plug-in.
        name: name of the plug-in.
        seed: random seed.

    Raises:
        BadFile: there is no such plug-in, or it cannot be created.
    """
    trial = TRIALS[kind](name, seed, LONGEST)
    if not trial.faults:
        # In another process, sets have another order, and the module is imported again.
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            other = pool.submit(TRIALS[kind], name, seed, LONGEST).result()
        if other.digest != trial.digest:
            trial.note("the plug-in decided differently in another process with the same seed", DETERMINED, ())
    package = kind.package(name)
    tried = f"{name} ({package}): {trial.situations} situations, each run twice"
    summary = f"{tried}, in {trial.slowness:.2g} times the time of the built-in {trial.what}"
    figures = {
        "kind": kind.what,
        "package": package,
        "situations": trial.situations,
        "slowness": round(trial.slowness, 3),
    }
    return TrialReport(name, summary, figures, [*trial.faults.values()])


def listed() -> Iterator[tuple[PluginKind, str, str]]:
    """Yield the kind, name and description of each installed plug-in, without loading the plug-ins."""
    for kind in KINDS:
        for name in kind.names():
            yield kind, name, kind.describe(name)

"""Parts of robots' software that studies name as plug-ins, loaded and guarded."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from sim.common.observations import Twist
from sim.parameters import RobotParameters
from sim.robot.installed_parts import InstalledParts, PartKind, installed_names
from sim.robot.navigator.recovery import RecoveryFactory, RecoverySituation, RunningRecovery
from sim.robot.part_failure import PartFailed
from thbridge.app.compose.installed import FaultLog
from thbridge.dialogue.other_programs import RAISED, told_error
from thbridge.files.plugins import printing_aside
from thbridge.study.plugins import PART_KINDS

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class PartGuard:
    """Guard of a part: whatever the lab's program raises becomes `PartFailed`, and is logged once.

    Attributes:
        what: kind and name of the part.
        log: takes each failure.
    """

    what: str
    log: Callable[[str], None]

    def call(self, asked: Callable[[], T], wrong: Callable[[object], str] = lambda _: "") -> T:
        """Return what a call returns.

        Args:
            asked: calls the lab's program.
            wrong: says what is wrong with what was returned; empty: nothing.

        Raises:
            PartFailed: it raised an error, or what it returned is wrong.
        """
        try:
            with printing_aside():
                returned = asked()
            problem = wrong(returned)
        except RAISED as error:
            raise self.failed(told_error(error)) from error
        if problem:
            raise self.failed(problem)
        return returned

    def failed(self, problem: str) -> PartFailed:
        """Return the failure of the part for a problem."""
        self.log(problem)
        return PartFailed(f"the {self.what} failed: {problem}")


@dataclass(frozen=True, slots=True)
class GuardedRecoveryFactory:
    """Factory of a lab's recovery behavior; see `RecoveryFactory`.

    Attributes:
        factory: of the lab.
        guard: of what it makes.
    """

    factory: RecoveryFactory
    guard: PartGuard

    def __call__(self, seed: int, /) -> RunningRecovery:
        """Return the behavior."""
        return GuardedRecovery(self.guard.call(lambda: self.factory(seed)), self.guard)


@dataclass(frozen=True, slots=True)
class GuardedRecovery:
    """Recovery behavior of a lab.

    Attributes:
        behavior: of the lab.
        guard: of its calls.
    """

    behavior: RunningRecovery
    guard: PartGuard

    def command(self, now: RecoverySituation) -> Twist | None:
        """Return its command; see `RunningRecovery`."""
        said = self.guard.call(lambda: self.behavior.command(now), _wrong_command)
        return None if said is None else Twist(float(said.linear), float(said.angular))


def _wrong_command(said: object) -> str:
    if said is None:
        return ""
    if not isinstance(said, Twist):
        return f"a {type(said).__name__} is no Twist, and not None"
    if not (math.isfinite(said.linear) and math.isfinite(said.angular)):
        return f"the command ({said.linear}, {said.angular}) is not finite"
    return ""


def installed_parts(robots: Iterable[RobotParameters], log: bool = True) -> InstalledParts:
    """Return the parts that robots' parameters name as plug-ins.

    Args:
        robots: parameters of the robots' software.
        log: False where failures are not logged.

    Raises:
        BadFile: one is not installed, or cannot be made.
    """
    found: dict[PartKind, dict[str, Any]] = {kind: {} for kind in PART_KINDS}  # type: ignore[explicit-any]  # of labs
    for kind, name in sorted({(kind, name) for robot in robots for kind, _, name in installed_names(robot)}):
        what = f"{PART_KINDS[kind].what} {name}"
        guard = PartGuard(what, FaultLog(f"the {what} failed") if log else _ignore)
        found[kind][name] = _GUARDED[kind](load_part(kind, name), guard)
    return InstalledParts(**found)


def load_part(kind: PartKind, name: str) -> Callable[..., Any]:  # type: ignore[explicit-any]  # of labs
    """Return the factory of a part. Raises BadFile: it is not installed, or cannot be made."""
    plugin = PART_KINDS[kind]
    factory = plugin.load(name)
    plugin.made(name, lambda: factory(0), ("command",), "a seed")
    return factory


_GUARDED = {"recoveries": GuardedRecoveryFactory}


def _ignore(_fault: str) -> None:
    pass

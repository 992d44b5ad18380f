"""Construction of a session from keeper, robots, treasures and participant, which occurs only in this module."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.setting import StudySetting
from thbridge.app.session.session import NO_OUTLETS, EventLog, Session, SessionOutlets, TickRecorder
from thbridge.roles.hider import Hider
from thbridge.roles.keeper.keeper import Keeper
from thbridge.roles.shared.role import Role
from thbridge.text_protocol.wire import legacy

if TYPE_CHECKING:  # A text server has no robots, and starts faster without the simulator.
    from thbridge.roles.simr.team import RobotTeam


@dataclass(frozen=True, slots=True)
class Programs:
    """Programs of a game that run inside a session, in addition to the keeper. All others connect from outside.

    Attributes:
        robots: role of the robots.
        hider: role of the treasures.
        participants: roles of participants, whose messages are inputs.
    """

    robots: Role | None = None
    hider: Hider | None = None
    participants: tuple[Role, ...] = ()

    @property
    def roles(self) -> list[Role]:
        """Roles whose messages follow from the inputs, in the order of their steps."""
        return [role for role in (self.robots, self.hider) if role is not None]

    @property
    def names(self) -> list[str]:
        """Names of all roles, as recordings contain them."""
        return [role.name for role in (*self.roles, *self.participants)]


def build_programs(
    setting: StudySetting,
    participants: Sequence[Role] = (),
    outside: Collection[str] = (),
    team: "RobotTeam | None" = None,
) -> Programs:
    """Return the programs of a session with simulated robots.

    Args:
        setting: the study.
        participants: roles of participants.
        outside: names of the roles that other programs have; the robots are always inside the session.
        team: the robots. If None, simulated robots are built for this session.
    """
    from thbridge.app.compose.robots import build_simr  # noqa: PLC0415

    return Programs(
        robots=build_simr(setting, team),
        hider=None if legacy.HIDER in outside else build_hider(setting.templates, setting.study.seed),
        participants=tuple(each for each in participants if each.name not in outside),
    )


@dataclass(frozen=True, slots=True)
class SessionRecording:
    """Recording of a session. By default, nothing is recorded.

    Attributes:
        recorders: recorders that record every tick.
        log: log of the game's events and of uses of keys.
        run: unique name of this run, for the record of uses of keys.
    """

    recorders: Sequence[TickRecorder] = ()
    log: EventLog | None = None
    run: str = ""


NOT_RECORDED = SessionRecording()


def open_session(
    setting: StudySetting,
    programs: Programs,
    recording: SessionRecording = NOT_RECORDED,
    outlets: SessionOutlets = NO_OUTLETS,
    keeper: Keeper | None = None,
) -> Session:
    """Return a new, complete session; no part is added or replaced later.

    Args:
        setting: the study. If the study says so, its simulated robots are MAVLink vehicles.
        programs: the game's programs that run inside the session.
        recording: recording of the session.
        outlets: servers of the session's connections and links.
        keeper: keeper of a resumed game; None for a new game.
    """
    vehicles = None
    if programs.robots is not None and setting.study.mavlink.on:
        from thbridge.app.compose.vehicles import vehicle_factory  # noqa: PLC0415

        vehicles = vehicle_factory(setting, programs.robots)
    return Session(
        keeper or build_keeper(setting),
        programs.roles,
        recording.recorders,
        programs.participants,
        vehicles,
        recording.log,
        outlets,
        recording.run,
    )

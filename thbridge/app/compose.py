"""The composition root: builds every part of a session from one study. No other module looks up its parts."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from platform import python_version

import numpy as np

from sim.common import noise
from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import number_of, robot_numbers
from sim.common.traversability import TraversabilityMap
from sim.inputs import ScheduledInput, SendGoal
from sim.robot.costmap.footprint import radii
from sim.robot.navigator import Goal
from sim.team import Team
from sim.world.sensors import mount_of
from thbridge.app.rosgraph.live import TeamDescription
from thbridge.dialogue.engine import Engine
from thbridge.dialogue.protocols import TemplateProtocol
from thbridge.dialogue.strategies import TemplateStrategy
from thbridge.dialogue.templates import TemplatePhrasing
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.map_files import Map, read_map
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.resources import Resources, shipped
from thbridge.files.template_files import TemplateSet, read_template_set
from thbridge.files.yaml.tree import read_text
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Event
from thbridge.recording.bag.writer import BagWriter
from thbridge.roles.bot_strategy import BotStrategy
from thbridge.roles.bots import Bot, TreasureKnowledge
from thbridge.roles.hider import Hider
from thbridge.roles.keeper.briefing import Briefing
from thbridge.roles.keeper.disclosure import plain_costs
from thbridge.roles.keeper.floor_plan import floor_plan_of
from thbridge.roles.keeper.keeper import GameRules, Keeper
from thbridge.roles.notices import FloorPlan, RoomOutline
from thbridge.roles.simr.pose_telemetry import TelemetryOptions
from thbridge.roles.simr.simr import RESPONSE_TIMEOUT, GameMap, SimR
from thbridge.roles.simr.team import RobotTeam
from thbridge.roles.vehicles.parameters import VehicleParameters
from thbridge.roles.vehicles.pilot import GameSetup, Pilot
from thbridge.roles.vehicles.speed_limit import SpeedLimit
from thbridge.roles.vehicles.vehicles import RequestSink, Vehicles
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.names import CALLER
from thbridge.ros.parameters import tree_of
from thbridge.ros.publisher import Planners, TeamPublisher
from thbridge.study.study_file import Study
from thbridge.study.text import resolved
from thbridge.study.things import schedule_of

LARGEST_CONSENT = 8000
"""Bytes of the text that participants agree to; it must fit into one line with the rest of a view."""
REHEARSAL = 5 * TICKS_PER_SECOND
"""Ticks of a rehearsal: enough for robots to localise, plan around each other, turn and drive."""
REHEARSERS = 10
"""Robots of a rehearsal: enough for all of that to happen."""
RECORDED_PACKAGES = ("thbridge", "numpy", "scipy", "numba", "filterpy", "rosbags", "pymavlink")
"""Packages whose versions a bag records, since another version may run the same study differently."""


@dataclass(frozen=True, slots=True)
class StudySetting:
    """A study with all files it names, read and checked; all parts of a session are built from it.

    Attributes:
        study: the study.
        map: its map.
        templates: its set of templates.
        costs: energy of every move.
        consent: text that participants have to agree to; None: nothing.
    """

    study: Study
    map: Map
    templates: TemplateSet
    costs: CostMatrix
    consent: str | None = None

    def team(self) -> Team:
        """Return the simulated robots at their start poses."""
        study = self.study
        return self._team(range(study.robots), schedule_of(study.things, study.mishaps))

    def _team(self, robots: Sequence[int], schedule: Sequence[ScheduledInput]) -> Team:
        """Return some of the study's robots at their start poses."""
        study = self.study
        starts = [self.map.starts[robot] for robot in robots]
        software = [study.software(number_of(robot)) for robot in robots]
        return Team(self.map.grid, study.world, software, starts, study.seed, study.game.energy, schedule)

    def rehearse(self) -> None:
        """Drive simulated robots for a few seconds, so that numba compiles all kernels before the session begins.

        A few robots of a large team suffice, together with those that have software parameters of their own.
        """
        study, rooms = self.study, self.map.rooms
        robots = [robot for robot in range(study.robots) if robot < REHEARSERS or number_of(robot) in study.each]
        team = self._team(robots, schedule_of(study.things, ()))
        orders = [SendGoal(robot, Goal(0, rooms[robot % len(rooms)].goal)) for robot in range(team.size)]
        for tick in range(REHEARSAL):
            team.step(orders if tick == 0 else [])

    def simr(self, robots: RobotTeam | None = None, response_timeout: int = RESPONSE_TIMEOUT) -> SimR:
        """Return the robots' role; None for simulated robots of its own. `response_timeout` as for `SimR`, ticks."""
        field = GameMap(
            name=self.map.name,
            goals=tuple(room.goal for room in self.map.rooms),
            starts=self.map.starts[: self.study.robots],
            costs=plain_costs(self.costs),
        )
        shown = self.study.participant.shows
        shows = TelemetryOptions(shown.way, shown.uncertainty, shown.truth)
        return SimR(robots or self.team(), field, self.study.server.dialect, response_timeout, shows)

    def keeper(self, history: tuple[Event, ...] = (), last_game: int = 0) -> Keeper:
        """Return the keeper; see `Keeper` for a game that goes on."""
        game = self.study.game
        rules = GameRules(self.study.seed, game.energy, game.picture_cost, game.identify_cost, game.wrong_share)
        return Keeper(rules, self._engine, history, last_game, self.briefing())

    def briefing(self) -> Briefing:
        """Return the briefing of participants."""
        return Briefing(self.floor_plan(), self._treasures(), self.templates.pictures, self.consent)

    def floor_plan(self) -> FloorPlan:
        """Return the map as participants see it."""
        return floor_plan_of(self.map.name, self.map.grid, self._rooms(), self.study.world.footprint)

    def hider(self) -> Hider:
        """Return the treasures' role."""
        return build_hider(self.templates, self.study.seed)

    def game_setup(self) -> GameSetup:
        """Return the facts that pilots know before the game begins."""
        return GameSetup(_floor(self.study, self.map), self._rooms(), self._treasures(), self.study.game.energy)

    def vehicles(self, simr: SimR) -> Callable[[RequestSink], Vehicles] | None:
        """Return the factory of the robots' MAVLink vehicles, given a sink of their requests; None without vehicles."""
        study = self.study
        if not study.mavlink.on:
            return None
        setup = self.game_setup()

        def made(ask: RequestSink) -> Vehicles:
            pilots = []
            for robot, start in enumerate(self.map.starts[: study.robots]):
                speed_limit = SpeedLimit(robot, study.software(number_of(robot)), simr)
                pilots.append(Pilot(robot, setup, start, speed_limit, VehicleParameters(robot, simr), ask))
            return Vehicles(pilots, study.mavlink.options)

        return made

    def record(self, program: str, roles: Sequence[str], participant: str) -> SessionRecord:
        """Return a bag's first record; see `SessionRecord` for the arguments."""
        study = self.study
        return SessionRecord(resolved(study), study.seed, versions(), program, tuple(roles), participant)

    def publisher(self) -> TeamPublisher:
        """Return the publisher of these robots' ROS messages."""
        study, laser = self.study, self.study.world.laser
        planners = [Planners.of(study.software(number)) for number in robot_numbers(study.robots)]
        return TeamPublisher(study.robots, mount_of(laser), 1.0 / laser.rate, planners, vehicles=study.mavlink.on)

    def writer(self, path: Path, caller: str = CALLER) -> BagWriter:
        """Return a writer of a new bag, for messages of this node. Raises BagNotWritten."""
        recording = self.study.recording
        return BagWriter(path, compression=recording.compression, splitting=recording.splitting, caller=caller)

    def team_description(self, publisher: TeamPublisher) -> TeamDescription:
        """Return the description of these robots for a ROS graph."""
        rest = {name: value for name, value in tree_of(self.study).items() if name not in {"robot", "each"}}
        return TeamDescription(publisher.topics, self.map.grid, rest)

    def _rooms(self) -> tuple[RoomOutline, ...]:
        return tuple(
            RoomOutline(entry.room.people, entry.name, entry.region, _triple(entry.goal)) for entry in self.map.rooms
        )

    def _treasures(self) -> tuple[str, ...]:
        """Return the names of treasures, in alphabetical order."""
        return tuple(sorted((kind.name for kind in self.templates.kinds), key=str.casefold))

    def _engine(self, game: int) -> Engine:
        template = self.templates.dialogue
        seed = int(noise.key(self.study.seed, "dialogue", str(game)))
        return Engine(TemplateProtocol(template), TemplateStrategy(), TemplatePhrasing(template, seed))


def build_hider(templates: TemplateSet, seed: int) -> Hider:
    """Return the treasures' role."""
    return Hider(templates.kinds, seed, len(templates.costs.rooms))


def build_bot(templates: TemplateSet, strategy: BotStrategy, seed: int) -> Bot:
    """Return a simulated participant."""
    # The participant's copy of the list has no images; the bot recognises pictures as a person does.
    known = tuple(replace(kind, image=None) for kind in templates.kinds)
    shown_by = {kind.image: kind.name for kind in templates.kinds if kind.image is not None}
    return Bot(strategy, TreasureKnowledge(known, shown_by), seed)


def read_setting(study: Study, beside: Path, resources: Resources | None = None) -> StudySetting:
    """Read the files that a study names.

    Args:
        study: the study.
        beside: the folder that paths in the study are relative to.
        resources: maps and templates that are known by name; by default those of the project.

    Raises:
        BadFile: a file is missing or wrong, or files do not fit together.
    """
    resources = resources or shipped()
    place = read_map(resources.find("maps", study.map, beside), study.world.footprint)
    folder = resources.find("templates", study.templates, beside)
    templates = read_template_set(folder)
    largest = max((study.robots, *(study.participant.robots or ())))
    if largest > len(place.starts):
        raise BadFile(
            resources.find("maps", study.map, beside) / "rooms.yaml",
            None,
            "starts",
            f"there are start poses for {len(place.starts)} robots, but the study has {largest}",
            "add start poses or lower `robots` in the study",
        )
    faults = tuple(_misplaced(study, place, resources.find("maps", study.map, beside) / "map.yaml"))
    if faults:
        raise BadFiles(faults)
    return StudySetting(study, place, templates, _costs(study, beside, place, folder), _consent(study, beside))


def _consent(study: Study, beside: Path) -> str | None:
    """Return the text that participants have to agree to, if the study names one."""
    if study.participant.consent is None:
        return None
    path = beside / study.participant.consent
    text = read_text(path, LARGEST_CONSENT).strip()
    if not text:
        problem, remedy = "there is nothing to agree to in it", "write the text, or take `participant: consent:` away"
        raise BadFile(path, None, None, problem, remedy)
    return text


def _triple(pose: Pose2) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.theta


def _floor(study: Study, place: Map) -> TraversabilityMap:
    """Return the map's floor, for robots of the study's footprint."""
    return TraversabilityMap.of(place.grid, *radii(np.array(study.world.footprint)))


def _misplaced(study: Study, place: Map, map_yaml: Path) -> Iterator[BadFile]:
    """Yield faults of mishaps that carry robots into walls or off the map."""
    floor = _floor(study, place)
    for index, mishap in enumerate(study.mishaps):
        if mishap.to is not None and floor.clearance_at(Pose2(*mishap.to)) < floor.inscribed:
            x, y, _ = mishap.to
            problem = f"robot {mishap.robot} would be carried to ({x:g}, {y:g}), where it does not fit on this map"
            yield BadFile(map_yaml, None, None, problem, f"mend mishaps[{index}].to in the study")


def _costs(study: Study, beside: Path, place: Map, folder: Path) -> CostMatrix:
    """Return the costs of the study's own file, or else the map's, or else the templates'; they must fit the map."""
    if study.game.costs is not None:
        path = beside / study.game.costs
    elif place.costs is not None:
        path = place.costs
    else:
        path = folder / MAP_TIMES
    costs = read_map_times(path)
    if len(costs.rooms) != len(place.rooms):
        raise BadFile(
            path,
            1,
            "number of nodes",
            f"{len(costs.rooms) + 1} nodes, but the map {place.name} has {len(place.rooms)} rooms and a corridor",
            f"give a mapTimes of {len(place.rooms) + 1} nodes in the map's folder, or by `game: costs:` in the study",
        )
    return costs


def versions() -> dict[str, str]:
    """Return the versions of this program and of the packages that its results depend on."""
    found = {"python": python_version()}
    for package in RECORDED_PACKAGES:
        found[package] = metadata.version(package)
    return found

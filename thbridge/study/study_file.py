"""The study file: all settings in one YAML file, every key of which may be left out.

The sections are frozen dataclasses. `param` gives each field its default, meaning, unit and bounds, and the reader, its
error messages and the commented file that `thbridge study init` writes all come from there.
"""

import dataclasses
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Never, cast

from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import RobotNumber
from sim.numerics import elementary
from sim.parameters import MIN_MAX_PAIRS, RobotParameters, WorldParameters, param
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.plugins import PARTICIPANTS
from thbridge.files.ros.defaults import ros_defaults, sentences_of
from thbridge.files.ros.parameters import RosParameters, parse_ros_files
from thbridge.files.yaml.load import Loaded, load_tree
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse
from thbridge.hunt.rules import MOST_ROBOTS
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.recording.bag.options import Compression, DefinitionTexts, Readers, RecordingDetail, SplitLimits
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.sockets.addresses import LONGEST_HOST, TEXT_SERVER_PORT
from thbridge.sockets.admission import parse_network
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.mavlink import MavlinkSection, faults_of_mavlink
from thbridge.study.noise import (
    TARGET_PATHS,
    NoiseSection,
    noise_section_of,
    preset_in,
    resolve_noise,
    tree_of_preset,
    value_at,
)
from thbridge.study.real_robots import FleetSection, faults_of_fleet
from thbridge.study.robots_from import RobotsFrom
from thbridge.study.things import MishapEntry, ThingEntry, faults_of_mishaps, faults_of_things
from thbridge.text_protocol.values.dialect import Dialect

OWN_STRATEGY = "manner"
"""Name of the strategy that robots come with."""


class CostModel(StrEnum):
    """Price of a robot's moves: from where it stands, or by the places of a cost file alone."""

    POSITION = "position"
    MATRIX = "matrix"


@dataclass(frozen=True, slots=True)
class GameSection:
    """Rules and energy of the game."""

    energy: float = param(100.0, "energy of each robot at the start", "", 0.01, 1e6)
    picture_cost: float = param(5.0, "energy of taking a picture", "", 0, 1e6)
    identify_cost: float = param(1.0, "energy of naming a treasure", "", 0, 1e6)
    wrong_share: float = param(1.0, "share of a treasure's points that a wrong name costs", "", 0, 10)
    costs: Path | None = param(
        None,
        "path of a mapTimes file of travel costs, or a template set's name for its file (`original-2016`); null: that "
        "of the templates where their `set.yaml` names the map, or else the map's own, or else the templates'",
    )
    cost_model: CostModel | None = param(
        None,
        "how moves are priced: `position`, from where each robot stands, or `matrix`, all places outside rooms alike; "
        "null: by position where the map's own costs count",
    )


@dataclass(frozen=True, slots=True)
class ShowsSection:
    """Options of what participants see of robots and treasures, beside estimated poses and activities."""

    way: bool = param(True, "whether the ways that lie ahead of robots are shown")
    uncertainty: bool = param(False, "whether it is shown how sure robots are of their places")
    truth: bool = param(False, "whether it is shown where simulated robots really are")
    points: bool = param(True, "whether the points of treasures are told before they are named")
    answers: bool = param(True, "whether it is told after the game what was in the rooms, and the best possible score")


@dataclass(frozen=True, slots=True)
class ParticipantSection:
    """The participant: what they see and decide, and the strategy of a simulated one."""

    strategy: str = param(
        BotStrategy.SUGGESTION.value,
        "how a simulated participant chooses rooms; or the name of one that is installed, which decides everything",
        choices=tuple(each.value for each in BotStrategy),
        plugins=PARTICIPANTS.group,
    )
    attitude: Attitude = param(
        Attitude.CREDULOUS,
        "how a simulated participant replies to robots: credulous, makes the most agreeable choice; cautious, asks for "
        "reasons and accepts them; sceptical, holds to its own choice, and gives in late or not at all",
    )
    consent: Path | None = param(None, "path of a text that participants agree to before they play; null asks nothing")
    robots: tuple[int, int] | None = param(
        None,
        "least and most robots that a participant may choose from, e.g. [1, 4]; null: always the study's number",
        "",
        1,
        MOST_ROBOTS,
    )
    shows: ShowsSection = param(ShowsSection(), "what participants see of robots and treasures")
    sound: bool = param(True, "whether the participant's window may sound; participants can switch that off by M")
    farewell: Path | None = param(
        None, "path of a text for the end of a game: thanks, and what comes next; null thanks in a sentence"
    )


@dataclass(frozen=True, slots=True)
class MannerSection:
    """Manner in which a robot argues; of no effect where robots do not argue."""

    attitude: Attitude = param(
        Attitude.CAUTIOUS,
        "what a robot accepts: credulous, whatever has a reason; cautious, what nothing it knows speaks against; "
        "sceptical, what it has an argument for itself",
    )
    persistence: int = param(
        2, "number of dialogues about the same matter in which a robot holds out; 0 gives in at once", "", 0, 10
    )
    talkative: bool = param(
        False, "whether a robot gives its arguments part by part, each to be accepted; else each as a whole"
    )
    gives_reasons: bool = param(True, "whether a robot answers questions for its reasons")
    misheard: float = param(0.0, "share of the participant's moves that a robot takes for another legal one", "", 0, 1)
    strategy: str | None = param(None, "name of a strategy, as for dialogue.strategy; null: the one named there")


@dataclass(frozen=True, slots=True)
class DialogueSection:
    """Dialogues of robots and participant."""

    condition: DialogueCondition = param(
        DialogueCondition.SCRIPT,
        "who decides: supervisor, robots do what they are told; script, they ask the questions of the templates; "
        "collaborator, robots argue and nothing happens before both agree; adviser, they argue and the participant has "
        "the last word; autonomous, they argue and have the last word",
    )
    manner: MannerSection = param(MannerSection(), "how robots argue")
    each: Mapping[int, MannerSection] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "robots with another manner, by number: {2: {persistence: 0}}", "like": "manner"},
    )
    neglect: float | None = param(
        None,
        "time after which a robot that the participant does not attend to decides by itself; null: it waits, or in the "
        "condition autonomous decides after 5 s",
        "s",
        1,
        3600,
    )
    language: str = param(
        "en", "language of all that participants read and hear: en, de, or the name of a folder in the folder of words"
    )
    author: str | None = param(
        None,
        "name of an installed program that words robots' sentences, as the entry points `thbridge.wordings` have it; "
        "null: the language's files alone",
    )
    words: Path | None = param(
        None,
        "path of a folder of words for robots that argue, beside those that come with the project; null: those alone",
    )
    strategy: str = param(
        OWN_STRATEGY,
        "how robots that argue choose what to say: `manner`, as their manner has it, or the name of a strategy that is "
        "installed",
    )
    planner: TeamPlanner = param(
        TeamPlanner.JOINT,
        "how robots choose the rooms they suggest: by the joint plan of the team, the nearest room, the cheapest moves "
        "of all, their own tours, or an auction",
    )
    adviser_error_rate: float = param(
        0.0,
        "share of suggestions that err: another room than planned; above 0 no suggestion compares rooms",
        "",
        0,
        1,
    )
    says_confidence: bool = param(
        False, "whether robots say how sure they are of a suggestion: the probability that it does not err"
    )
    confidence_bias: float = param(
        0.0, "added to the confidence that robots state, which stays within 0 and 1; 0 is calibrated", "", -1, 1
    )
    confidence_spread: float = param(
        0.0,
        "greatest distance of a suggestion's own probability of error, drawn anew for each, from adviser_error_rate, "
        "its mean; 0: all are equally sure",
        "",
        0,
        0.5,
    )
    games: Path | None = param(
        None, "path of a folder of dialogue games, beside those that come with the project; null: those alone"
    )

    def strategy_of(self, manner: MannerSection) -> str | None:
        """Return the name of the strategy of robots with a manner; None: the one that they come with."""
        name = self.strategy if manner.strategy is None else manner.strategy
        # Older studies have `template`.
        return None if name in {OWN_STRATEGY, "template"} else name

    @property
    def patience(self) -> float | None:
        """Time for which a robot waits for the participant, s; None: for ever."""
        return 5.0 if self.neglect is None and self.condition is DialogueCondition.AUTONOMOUS else self.neglect


@dataclass(frozen=True, slots=True)
class ServerSection:
    """The text server of the game's programs."""

    host: str = param("127.0.0.1", "address to listen on; 0.0.0.0 lets those of keys and open_to in")
    port: int = param(TEXT_SERVER_PORT, "TCP port; 0 takes any that is free", "", 0, 65535)
    dialect: Dialect = param(Dialect.LEGACY_2016, "which reading of %%goto comes first")
    tell_refusals: bool = param(
        False, "programs that speak as in 2016 hear `%%error Game NAME refused: WHY`; in 2016 they heard nothing"
    )


@dataclass(frozen=True, slots=True)
class RecordingSection:
    """Recording of a session."""

    compression: Compression = param(
        Compression.LZ4, "how the bag's chunks are packed; lz4 is quick, bz2 is small and slow, rosbag reads all"
    )
    detail: RecordingDetail = param(
        RecordingDetail.CHANGES,
        "changes: of costmaps that stay the same one in 10 s, and every other message; all: these costmaps, too",
    )
    definitions: DefinitionTexts = param(
        DefinitionTexts.OWN,
        "texts of message types in the bag; own: the same on every machine; installed: those of an installed ROS, with "
        "comments, as `rosbag check` wants them",
    )
    errors: bool = param(True, "the pose that each robot believes at every scan, its errors, and whether it is lost")
    readers: Readers = param(
        Readers.OWNER,
        "accounts of this machine that may read what is recorded, the treasures of the game under way among it: owner, "
        "group (that of the account) or everyone",
    )
    split_size: float | None = param(
        None, "size of a file beyond which the recording goes on in another; null: one file", "MB", 0.1, 1e6
    )
    split_duration: float | None = param(
        None, "simulated time after which the recording goes on in another file; null: one file", "s", 1.0, 1e6
    )

    @property
    def splitting(self) -> SplitLimits:
        """Limits of a recording's file before the next begins. A megabyte is 2^20 bytes, as in rosbag."""
        size, duration = self.split_size, self.split_duration
        return SplitLimits(
            None if size is None else round(size * 2**20), None if duration is None else round(duration * 1e9)
        )


@dataclass(frozen=True, slots=True)
class WatchSection:
    """Address for researchers' windows: they see the truth, and may send requests to robots."""

    host: str = param("127.0.0.1", "address to listen on; 0.0.0.0 lets those in who have a key of a folder")
    port: int | None = param(None, "TCP port, such as 6010; 0 takes any that is free; null: nobody may", "", 0, 65535)
    key: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`), or of a file with one, that is asked for; null: none is",
    )


@dataclass(frozen=True, slots=True)
class Study:
    """A study: map, robots, game, participant, programs."""

    map: str = param("arena8", "name of a map, or the path of a map folder (with a slash, from this file's folder)")
    templates: str = param("original-2016", "name of a set of templates, or the path of its folder")
    robots: int = param(2, "size of the team", "", 1, MOST_ROBOTS)
    robots_from: RobotsFrom = param(RobotsFrom.SIM, "simulated robots, or real ones of a ROS graph (section fleet)")
    external_nodes: ExternalNodes = param(
        ExternalNodes.NONE,
        "nodes of ROS that others run for simulated robots, by `simr --ros`; both: amcl, too",
    )
    seed: int = param(1, "all chance is keyed by it; the same seed gives the same run", "", 0, 2**31 - 1)
    rate: float | None = param(
        None, "simulated seconds per second; 0: as fast as it can; null: 1 when others take part, else 0", "", 0, 1000
    )
    game: GameSection = param(GameSection(), "rules and energy")
    participant: ParticipantSection = param(ParticipantSection(), "whoever plays")
    dialogue: DialogueSection = param(DialogueSection(), "how robots talk")
    server: ServerSection = param(ServerSection(), "the text server")
    watch: WatchSection = param(WatchSection(), "researchers' windows")
    keys: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`), by which programs and windows of thbridge take part from other"
        " machines, encrypted; null: none can",
    )
    open_to: tuple[str, ...] = param(
        (),
        "networks, such as 10.0.0.0/24, whose machines may speak as in 2016, ROS and MAVLink, which have neither keys"
        " nor encryption, to what listens on an address that is not this machine's alone",
    )
    mavlink: MavlinkSection = param(MavlinkSection(), "the robots as MAVLink vehicles, for ground stations")
    recording: RecordingSection = param(RecordingSection(), "the bag")
    fleet: FleetSection = param(FleetSection(), "real robots: what their topics and frames are called")
    world: WorldParameters = param(WorldParameters(), "bodies, motors and sensors as they truly are")
    robot: RobotParameters = param(RobotParameters(), "the software of every robot, under ROS's names")
    each: Mapping[int, RobotParameters] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "robots whose software differs, by number: {2: {localization: ekf}}", "like": "robot"},
    )

    things: tuple[ThingEntry, ...] = param(
        (), "bodies in the way that no map shows: each is a line - {key: value, ...}"
    )
    mishaps: tuple[MishapEntry, ...] = param((), "what befalls robots: each is a line - {key: value, ...}")

    def software(self, number: RobotNumber) -> RobotParameters:
        """Return the software of the robot with this number."""
        return self.each.get(number, self.robot)


@dataclass(frozen=True, slots=True)
class StudyFile(Study):
    """A study as people write it: noise also has its own section, and parameters may come from files of ROS."""

    noise: NoiseSection = param(NoiseSection(), "how sensors err, and what the robots' software believes of it")
    ros_parameters: tuple[Path, ...] = param(
        (),
        "ROS's YAML files for the software (amcl.yaml, local_costmap:costmap.yaml with its namespace, ...); what they"
        " leave out is as in ROS, and the section robot wins",
    )

    @classmethod
    def of(cls, study: Study) -> "StudyFile":
        """Return the file of a study."""
        return cls(**_fields(study), noise=noise_section_of(study))


def _fields(study: Study) -> dict[str, Never]:
    """Return a study's fields as keyword arguments; `Never` fits every parameter's type."""
    return {field.name: cast(Never, getattr(study, field.name)) for field in dataclasses.fields(Study)}


def with_team_size(study: Study, robots: int) -> Study:
    """Return the study with a team of this size; sections and mishaps of robots beyond it are left out."""
    each = {number: software for number, software in study.each.items() if number <= robots}
    mishaps = tuple(mishap for mishap in study.mishaps if mishap.robot <= robots)
    manners = {number: manner for number, manner in study.dialogue.each.items() if number <= robots}
    talk = dataclasses.replace(study.dialogue, each=manners)
    return dataclasses.replace(study, robots=robots, each=each, mishaps=mishaps, dialogue=talk)


def check_manners(loaded: Loaded[Study], base: str = "") -> None:
    """Raise BadFile for manners of robots that the study does not have, whatever number of robots people choose.

    Such a study can be read, because recordings of it must stay readable; a check refuses it.

    Args:
        loaded: the study.
        base: key under which it is written, with its dot; empty: it is a whole file.
    """
    study = loaded.value
    most = max((study.robots, *(study.participant.robots or ())))
    for number in study.dialogue.each:
        if number > most:
            problem = f"there is no robot {number}: the study has {most}"
            remedy = f"Write a number from 1 to {most}, or raise robots"
            raise loaded.fault(f"{base}dialogue.each.{number}", problem, remedy)


def load_study(path: Path) -> Loaded[Study]:
    """Read a study file, with notices about keys that are valid but have no effect.

    Raises:
        BadFile: it cannot be read; as BadFiles, every fault of it at once.
    """
    return load_study_tree(path, parse(path, read_text(path)))


def read_study_text(path: Path, text: str) -> Study:
    """Read a study from a text, such as that in a bag; faults name `path` as the file. See `load_study`."""
    return load_study_tree(path, parse(path, text)).value


def study_before(path: Path, tree: Node) -> StudyFile:
    """Return the values before a study's own lines count: defaults, its noise preset, its files of ROS.

    Raises:
        BadFile: one of those files cannot be read.
    """
    return StudyFile.of(_start(path, tree).study)


def load_study_tree(path: Path, tree: Node) -> Loaded[Study]:
    """Read a study from a parsed text; see `load_study`."""
    start = _start(path, tree)
    written = load_tree(path, resolve_noise(tree), StudyFile, StudyFile.of(start.study))
    study = Study(**_fields(written.value))
    loaded = Loaded(path, study, written.lines, (*start.notices_about(study, written.lines), *written.notices))
    faults = (*_given_twice(written), *_contradictions(loaded))
    if faults:
        raise BadFiles(faults)
    return loaded


@dataclass(frozen=True, slots=True)
class _Start:
    """The values before a study's own lines count.

    Attributes:
        study: these values.
        begun: the software before presets and files of ROS: hunts' or ROS's.
        ros: what the files of ROS say.
    """

    study: Study
    begun: RobotParameters
    ros: RosParameters

    def notices_about(self, study: Study, lines: Iterable[str]) -> Iterator[str]:
        """Yield sentences about the files of ROS, given the whole study and the keys of its own lines."""
        yield from self.ros.notices
        own = {TARGET_PATHS.get(line.removeprefix("noise."), line).removeprefix("robot.") for line in lines}
        yield from sentences_of(ros_defaults(study.robot, self.begun, RobotParameters(), self.ros.written | own))


def _start(path: Path, tree: Node) -> _Start:
    files = parse_ros_files(_ros_files(path, tree))
    standard = Study()
    begun = dataclasses.replace(standard, robot=files.start(standard.robot))
    start = load_tree(path, tree_of_preset(preset_in(tree)), Study, begun).value
    ros = files.over(start.robot)
    return _Start(dataclasses.replace(start, robot=ros.value), begun.robot, ros)


def _ros_files(path: Path, tree: Node) -> list[Path]:
    """Return the files of ROS that a study names; they are needed before the rest of it can be read."""
    entries = tree.entries if isinstance(tree, Section) else []
    lists = [child.items for key, child in entries if key.text == "ros_parameters" and isinstance(child, Listing)]
    return [path.parent / item.text for items in lists for item in items if isinstance(item, Scalar)]


def _given_twice(written: Loaded[StudyFile]) -> Iterator[BadFile]:
    """Yield faults of numbers written in `noise` and at their own place, with different values."""
    for path, home in TARGET_PATHS.items():
        key = f"noise.{path}"
        here, there = value_at(written.value.noise, path), value_at(written.value, home)
        if key in written.lines and home in written.lines and here != there:
            problem = f"{here} here, but {there} as {home} in line {written.lines[home]}"
            yield written.fault(key, problem, "Keep one of the two")


def _contradictions(loaded: Loaded[Study]) -> Iterator[BadFile]:
    """Yield faults of values that are valid alone but not together."""
    study = loaded.value
    laser = study.world.laser
    if TICKS_PER_SECOND % laser.rate:
        rates = [str(rate) for rate in range(1, TICKS_PER_SECOND + 1) if TICKS_PER_SECOND % rate == 0]
        problem = f"{laser.rate} does not divide the {TICKS_PER_SECOND} steps of a second"
        yield loaded.fault("world.laser.rate", problem, f"Write one of {', '.join(rates)}")
    if laser.range_min > laser.range_max:
        yield _crossed(loaded, "world.laser", study.world.laser, "range_min", "range_max")
    yield from _crossings(loaded, "robot", study.robot)
    for key, host in (("server.host", study.server.host), ("watch.host", study.watch.host)):
        if not (host.isprintable() and 0 < len(host) <= LONGEST_HOST):
            yield loaded.fault(key, "no address or name of a machine", "Write one such as 127.0.0.1")
    for number, software in study.each.items():
        if number > study.robots:
            problem = f"there is no robot {number}: the study has {study.robots}"
            yield loaded.fault(f"each.{number}", problem, f"Write a number from 1 to {study.robots}, or raise robots")
        if software != study.robot:
            yield from _crossings(loaded, f"each.{number}", software)
    if study.participant.robots is not None:
        least, most = study.participant.robots
        if least > most:
            yield loaded.fault("participant.robots", f"{least} is above {most}", "Write the smaller number first")
    rate, spread = study.dialogue.adviser_error_rate, study.dialogue.confidence_spread
    room = round(min(rate, 1.0 - rate), 9)
    if spread > room:
        problem = f"suggestions would err with probabilities from {rate - spread:g} to {rate + spread:g}"
        remedy = f"Write at most {room:g}, or change adviser_error_rate"
        yield loaded.fault("dialogue.confidence_spread", problem, remedy)
    for index, text in enumerate(study.open_to):
        if parse_network(text) is None:
            remedy = "Write an address with the length of its prefix, such as 10.0.0.0/24; 0.0.0.0/0 is everybody"
            yield loaded.fault(f"open_to[{index}]", f"{text!r} is no network", remedy)
    yield from faults_of_fleet(loaded, study.fleet, study.robots)
    yield from faults_of_mavlink(loaded, study.mavlink, study.robots)
    yield from faults_of_things(loaded, study.things)
    yield from faults_of_mishaps(loaded, study.mishaps, study.robots)
    if not _surrounds_origin(study.world.footprint):
        problem = "these corners do not surround the robot's centre (0, 0)"
        yield loaded.fault("world.footprint", problem, "Write three or more corners in turn around it")


def _crossings(loaded: Loaded[Study], key: str, software: RobotParameters) -> Iterator[BadFile]:
    for name, low, high in MIN_MAX_PAIRS:
        section = value_at(software, name)
        # A fault inherited from the section `robot` is reported there.
        inherited = key != "robot" and section == value_at(loaded.value.robot, name)
        if not inherited and cast(float, value_at(section, low)) > cast(float, value_at(section, high)):
            yield _crossed(loaded, f"{key}.{name}", section, low, high)


def _crossed(loaded: Loaded[Study], key: str, section: object, low: str, high: str) -> BadFile:
    problem = f"{value_at(section, low)} is above {key}.{high}, which is {value_at(section, high)}"
    return loaded.fault(f"{key}.{low}", problem, "Lower it, or raise the other")


def _surrounds_origin(corners: tuple[tuple[float, float], ...]) -> bool:
    """Return True when a polygon winds around (0, 0) once, without touching it."""
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    angles = [elementary.atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1) for (x0, y0), (x1, y1) in sides]
    touches = any(abs(abs(angle) - math.pi) < 1e-9 for angle in angles)
    return len(corners) > 2 and not touches and abs(abs(math.fsum(angles)) - 2 * math.pi) < 1e-6

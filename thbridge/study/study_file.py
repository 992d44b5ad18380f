"""The study file: all settings in one YAML file. Every key may be left out.

The sections are frozen dataclasses. `param` gives each field its default, meaning, unit and bounds. The reader, its
error messages and the commented file that `thbridge study init` writes use these declarations.
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
"""Name of the built-in strategy of robots."""


class CostModel(StrEnum):
    """Pricing of moves: from where the robot stands, or only between the places of a cost file."""

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
        "path of a mapTimes file of travel costs, or name of a template set that has one (`original-2016`); if null, "
        "the "
        "file of the templates if their `set.yaml` names the map, or else the map's own file, or else the templates'",
    )
    cost_model: CostModel | None = param(
        None,
        "how moves are priced: `position`, from where each robot stands; `matrix`, the same price from all places "
        "outside "
        "rooms; if null, `position` when the map's own costs are used",
    )


@dataclass(frozen=True, slots=True)
class ShowsSection:
    """Optional parts of what participants see. They always see estimated poses and activities."""

    way: bool = param(True, "show the paths that robots are about to drive")
    uncertainty: bool = param(False, "show how certain robots are of their positions")
    truth: bool = param(False, "show the true positions of simulated robots")
    points: bool = param(True, "show the points of a treasure before the participant names it")
    answers: bool = param(True, "show after the game what was in the rooms, and the best possible score")


@dataclass(frozen=True, slots=True)
class ParticipantSection:
    """The participant: what they see and decide, and the strategy of a simulated participant."""

    strategy: str = param(
        BotStrategy.SUGGESTION.value,
        "how a simulated participant chooses rooms; or the name of an installed participant, which makes all decisions",
        choices=tuple(each.value for each in BotStrategy),
        plugins=PARTICIPANTS.group,
    )
    attitude: Attitude = param(
        Attitude.CREDULOUS,
        "how a simulated participant replies to robots: credulous, agrees whenever it can; cautious, asks for reasons "
        "and "
        "accepts them; sceptical, insists on its own choice, and gives in late or not at all",
    )
    consent: Path | None = param(
        None, "path of a text that participants agree to before they play; if null, consent is not asked for"
    )
    robots: tuple[int, int] | None = param(
        None,
        "least and most robots that a participant may choose from, e.g. [1, 4]; if null, always `robots`",
        "",
        1,
        MOST_ROBOTS,
    )
    shows: ShowsSection = param(ShowsSection(), "what participants see of robots and treasures")
    sound: bool = param(True, "allow sounds in the participant's window; participants can press M to switch them off")
    farewell: Path | None = param(
        None, "path of a text for the end of a game: thanks, and what comes next; if null, one sentence of thanks"
    )


@dataclass(frozen=True, slots=True)
class MannerSection:
    """Manner in which a robot argues. It has no effect on robots that do not argue."""

    attitude: Attitude = param(
        Attitude.CAUTIOUS,
        "what a robot accepts: credulous, everything that has a reason; cautious, everything that nothing it knows "
        "speaks "
        "against; sceptical, only what it can argue for itself",
    )
    persistence: int = param(
        2, "number of dialogues about the same matter in which a robot insists; 0: it gives in at once", "", 0, 10
    )
    talkative: bool = param(
        False, "give an argument part by part, and wait until each part is accepted; if false, give it as a whole"
    )
    gives_reasons: bool = param(True, "answer the participant's questions for reasons")
    misheard: float = param(
        0.0, "share of the participant's moves that a robot takes for a different legal move", "", 0, 1
    )
    strategy: str | None = param(None, "name of a strategy, as in dialogue.strategy; if null, that one")


@dataclass(frozen=True, slots=True)
class DialogueSection:
    """Dialogues of robots and participant."""

    condition: DialogueCondition = param(
        DialogueCondition.SCRIPT,
        "who decides: supervisor, robots obey; script, robots ask the questions of the templates; collaborator, robots "
        "argue and nothing happens before both sides agree; adviser, robots argue and the participant decides; "
        "autonomous, "
        "robots argue and decide",
    )
    manner: MannerSection = param(MannerSection(), "how robots argue")
    each: Mapping[int, MannerSection] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "robots with a different manner, by number: {2: {persistence: 0}}", "like": "manner"},
    )
    neglect: float | None = param(
        None,
        "time after which a robot that the participant does not attend to decides alone; if null, it waits, except in "
        "the condition autonomous, where it decides after 5 s",
        "s",
        1,
        3600,
    )
    language: str = param(
        "en", "language of all that participants read and hear: en, de, or the name of a folder in the words folder"
    )
    author: str | None = param(
        None,
        "name of an installed program that words the robots' sentences (entry point group `thbridge.wordings`); if "
        "null, "
        "only the language's files are used",
    )
    words: Path | None = param(
        None,
        "path of a folder of words for robots that argue, in addition to the built-in ones; if null, only those",
    )
    strategy: str = param(
        OWN_STRATEGY,
        "how robots that argue choose what to say: `manner`, according to their manner, or the name of an installed "
        "strategy",
    )
    planner: TeamPlanner = param(
        TeamPlanner.JOINT,
        "how robots choose the rooms that they suggest: by the joint plan of the team, the nearest room, the cheapest "
        "of all moves, a tour of their own, or an auction",
    )
    adviser_error_rate: float = param(
        0.0,
        "share of wrong suggestions, which name another room than planned; above 0 no suggestion compares rooms",
        "",
        0,
        1,
    )
    says_confidence: bool = param(
        False, "robots state how certain they are of a suggestion: the probability that it is not wrong"
    )
    confidence_bias: float = param(
        0.0, "number added to the confidence that robots state; the sum is kept within 0 to 1; 0: calibrated", "", -1, 1
    )
    confidence_spread: float = param(
        0.0,
        "greatest difference between a suggestion's own probability of being wrong, drawn for each suggestion, and the "
        "mean, adviser_error_rate; 0: all suggestions are equally certain",
        "",
        0,
        0.5,
    )
    games: Path | None = param(
        None, "path of a folder of dialogue games, in addition to the built-in ones; if null, only those"
    )

    def strategy_of(self, manner: MannerSection) -> str | None:
        """Return the name of the installed strategy for robots with this manner; None means the built-in strategy."""
        name = self.strategy if manner.strategy is None else manner.strategy
        # Older studies call the built-in strategy `template`.
        return None if name in {OWN_STRATEGY, "template"} else name

    @property
    def patience(self) -> float | None:
        """Time for which a robot waits for the participant, s. If None, it waits forever."""
        return 5.0 if self.neglect is None and self.condition is DialogueCondition.AUTONOMOUS else self.neglect


@dataclass(frozen=True, slots=True)
class ServerSection:
    """The text server of the game's programs."""

    host: str = param("127.0.0.1", "address to listen on; 0.0.0.0 also accepts the clients of `keys` and `open_to`")
    port: int = param(TEXT_SERVER_PORT, "TCP port; 0: any free port", "", 0, 65535)
    dialect: Dialect = param(Dialect.LEGACY_2016, "which reading of an ambiguous %%goto is tried first")
    tell_refusals: bool = param(
        False, "send `%%error Game NAME refused: WHY` to programs of the 2016 protocol, which in 2016 received nothing"
    )


@dataclass(frozen=True, slots=True)
class RecordingSection:
    """Recording of a session."""

    compression: Compression = param(
        Compression.LZ4, "compression of the bag's chunks: lz4 is fast, bz2 is small and slow; rosbag reads all of them"
    )
    detail: RecordingDetail = param(
        RecordingDetail.CHANGES,
        "changes: every other message, and of unchanged costmaps one in 10 s; all: every costmap, too",
    )
    definitions: DefinitionTexts = param(
        DefinitionTexts.OWN,
        "message definitions in the bag; own: the same on every machine; installed: those of the installed ROS, with "
        "comments, which `rosbag check` needs",
    )
    errors: bool = param(True, "record each robot's estimated pose at every scan, its errors, and whether it is lost")
    readers: Readers = param(
        Readers.OWNER,
        "accounts of this machine that may read the recording, which includes the treasures of a running game: owner, "
        "group (the account's group) or everyone",
    )
    split_size: float | None = param(
        None, "size of a file at which the recording continues in a new one; if null, there is one file", "MB", 0.1, 1e6
    )
    split_duration: float | None = param(
        None,
        "simulated time after which the recording continues in a new file; if null, one file",
        "s",
        1.0,
        1e6,
    )

    @property
    def splitting(self) -> SplitLimits:
        """Limits of a bag file before the recording continues in a new one. A megabyte is 2^20 bytes, as in rosbag."""
        size, duration = self.split_size, self.split_duration
        return SplitLimits(
            None if size is None else round(size * 2**20), None if duration is None else round(duration * 1e9)
        )


@dataclass(frozen=True, slots=True)
class WatchSection:
    """Address for researchers' windows: they see the truth, and may send requests to robots."""

    host: str = param("127.0.0.1", "address to listen on; 0.0.0.0 also accepts remote clients that hold a key")
    port: int | None = param(
        None, "TCP port, such as 6010; 0: any free port; if null, watching is not possible", "", 0, 65535
    )
    key: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`), or of a file with one key, that clients need; if null, no key is "
        "needed",
    )


@dataclass(frozen=True, slots=True)
class Study:
    """A study: map, robots, game, participant, programs."""

    map: str = param("arena8", "name of a map, or path of a map folder (with a slash, relative to this file's folder)")
    templates: str = param("original-2016", "name of a template set, or path of its folder")
    robots: int = param(2, "size of the team", "", 1, MOST_ROBOTS)
    robots_from: RobotsFrom = param(RobotsFrom.SIM, "simulated robots, or real robots of a ROS graph (section fleet)")
    external_nodes: ExternalNodes = param(
        ExternalNodes.NONE,
        "ROS nodes that replace ours for simulated robots, with `simr --ros`; both: move_base and amcl",
    )
    seed: int = param(1, "random seed; the same seed gives the same run", "", 0, 2**31 - 1)
    rate: float | None = param(
        None,
        "simulated seconds per second; 0: as fast as possible; if null, 1 if others take part, or else 0",
        "",
        0,
        1000,
    )
    game: GameSection = param(GameSection(), "rules and energy")
    participant: ParticipantSection = param(
        ParticipantSection(), "consent, display, strategy of a simulated participant"
    )
    dialogue: DialogueSection = param(DialogueSection(), "how robots and the participant talk")
    server: ServerSection = param(ServerSection(), "the text server")
    watch: WatchSection = param(WatchSection(), "researchers' windows")
    keys: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`), with which thbridge's programs and windows on other machines take "
        "part, encrypted; if null, they cannot",
    )
    open_to: tuple[str, ...] = param(
        (),
        "networks, such as 10.0.0.0/24, whose machines may use the 2016 protocol, ROS and MAVLink, which have neither "
        "keys"
        " nor encryption, on the ports that are open to other machines",
    )
    mavlink: MavlinkSection = param(MavlinkSection(), "the robots as MAVLink vehicles, for ground stations")
    recording: RecordingSection = param(RecordingSection(), "the bag")
    fleet: FleetSection = param(FleetSection(), "real robots: names of their topics and frames")
    world: WorldParameters = param(WorldParameters(), "true bodies, motors and sensors")
    robot: RobotParameters = param(RobotParameters(), "software of every robot, under ROS's names")
    each: Mapping[int, RobotParameters] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "robots with different software, by number: {2: {localization: ekf}}", "like": "robot"},
    )

    things: tuple[ThingEntry, ...] = param((), "obstacles that no map shows: each is a line - {key: value, ...}")
    mishaps: tuple[MishapEntry, ...] = param((), "scheduled robot failures: each is a line - {key: value, ...}")

    def software(self, number: RobotNumber) -> RobotParameters:
        """Return the software of the robot with this number."""
        return self.each.get(number, self.robot)


@dataclass(frozen=True, slots=True)
class StudyFile(Study):
    """A study as people write it: noise may have a section of its own, and parameters may come from ROS files."""

    noise: NoiseSection = param(NoiseSection(), "sensor noise, and the noise models of the robots' software")
    ros_parameters: tuple[Path, ...] = param(
        (),
        "ROS's YAML files for the software (amcl.yaml, local_costmap:costmap.yaml with its namespace, ...); what they"
        " leave out has ROS's default, and the section robot overrides them",
    )

    @classmethod
    def of(cls, study: Study) -> "StudyFile":
        """Return the study as it would be written to a file."""
        return cls(**_fields(study), noise=noise_section_of(study))


def _fields(study: Study) -> dict[str, Never]:
    """Return a study's fields as keyword arguments; `Never` fits every parameter's type."""
    return {field.name: cast(Never, getattr(study, field.name)) for field in dataclasses.fields(Study)}


def with_team_size(study: Study, robots: int) -> Study:
    """Return the study with a team of this size, without sections and failures of robots with higher numbers."""
    each = {number: software for number, software in study.each.items() if number <= robots}
    mishaps = tuple(mishap for mishap in study.mishaps if mishap.robot <= robots)
    manners = {number: manner for number, manner in study.dialogue.each.items() if number <= robots}
    talk = dataclasses.replace(study.dialogue, each=manners)
    return dataclasses.replace(study, robots=robots, each=each, mishaps=mishaps, dialogue=talk)


def check_manners(loaded: Loaded[Study], base: str = "") -> None:
    """Raise BadFile for manners of robots that the study cannot have, whatever number of robots people choose.

    Only a check calls this. Reading accepts such a study, because recordings of it must stay readable.

    Args:
        loaded: the study.
        base: key that contains the study, with a dot at its end. If empty, the study is a whole file.
    """
    study = loaded.value
    most = max((study.robots, *(study.participant.robots or ())))
    for number in study.dialogue.each:
        if number > most:
            problem = f"there is no robot {number}: the study has {most}"
            remedy = f"Write a number from 1 to {most}, or raise robots"
            raise loaded.fault(f"{base}dialogue.each.{number}", problem, remedy)


def load_study(path: Path) -> Loaded[Study]:
    """Read a study file, with notices about valid keys that have no effect.

    Raises:
        BadFile: the file cannot be read, or has faults. BadFiles reports all faults at once.
    """
    return load_study_tree(path, parse(path, read_text(path)))


def read_study_text(path: Path, text: str) -> Study:
    """Read a study from a text, such as the one in a bag; faults name `path` as the file. See `load_study`."""
    return load_study_tree(path, parse(path, text)).value


def study_before(path: Path, tree: Node) -> StudyFile:
    """Return the values to which a study's own lines are applied: defaults, its noise preset, its ROS files.

    Raises:
        BadFile: one of the ROS files cannot be read.
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
    """The values to which a study's own lines are applied.

    Attributes:
        study: these values.
        begun: the software's defaults before presets and ROS files: those of hunts, or those of ROS.
        ros: contents of the ROS files.
    """

    study: Study
    begun: RobotParameters
    ros: RosParameters

    def notices_about(self, study: Study, lines: Iterable[str]) -> Iterator[str]:
        """Yield sentences about the ROS files, given the whole study and the keys of its own lines."""
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
    """Return the ROS files that a study names; they are needed before the rest of it can be read."""
    entries = tree.entries if isinstance(tree, Section) else []
    lists = [child.items for key, child in entries if key.text == "ros_parameters" and isinstance(child, Listing)]
    return [path.parent / item.text for items in lists for item in items if isinstance(item, Scalar)]


def _given_twice(written: Loaded[StudyFile]) -> Iterator[BadFile]:
    """Yield faults of numbers that are written twice with different values, in `noise` and under their own key."""
    for path, home in TARGET_PATHS.items():
        key = f"noise.{path}"
        here, there = value_at(written.value.noise, path), value_at(written.value, home)
        if key in written.lines and home in written.lines and here != there:
            problem = f"{here} here, but {there} as {home} in line {written.lines[home]}"
            yield written.fault(key, problem, "Keep one of the two")


def _contradictions(loaded: Loaded[Study]) -> Iterator[BadFile]:
    """Yield faults of values that are valid alone but contradict each other."""
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
            yield loaded.fault(key, "not an address or name of a machine", "Write one such as 127.0.0.1")
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
        problem = f"the probability of a wrong suggestion would be {rate - spread:g} to {rate + spread:g}"
        remedy = f"Write at most {room:g}, or change adviser_error_rate"
        yield loaded.fault("dialogue.confidence_spread", problem, remedy)
    for index, text in enumerate(study.open_to):
        if parse_network(text) is None:
            remedy = "Write an address with the length of its prefix, such as 10.0.0.0/24; 0.0.0.0/0 is all machines"
            yield loaded.fault(f"open_to[{index}]", f"{text!r} is not a network", remedy)
    yield from faults_of_fleet(loaded, study.fleet, study.robots)
    yield from faults_of_mavlink(loaded, study.mavlink, study.robots)
    yield from faults_of_things(loaded, study.things)
    yield from faults_of_mishaps(loaded, study.mishaps, study.robots)
    if not _surrounds_origin(study.world.footprint):
        problem = "these corners do not surround the robot's center (0, 0)"
        yield loaded.fault("world.footprint", problem, "Write three or more corners in order around it")


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

"""The study file: all settings of a study in one YAML file. Every key is optional.

The sections are frozen dataclasses. `param` declares the default, help text, unit and bounds of each field. The reader,
its error messages and the commented file that `thbridge study init` writes use these declarations.
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
from thbridge.recording.bag.options import (
    Compression,
    DefinitionTexts,
    Readers,
    RecordingDetail,
    RecordingFormat,
    SplitLimits,
)
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
from thbridge.study.ros2 import Ros2Section, faults_of_ros2
from thbridge.study.seats import SeatEntry, TeamSection, faults_of_seats
from thbridge.study.things import MishapEntry, ThingEntry, faults_of_mishaps, faults_of_things
from thbridge.text_protocol.values.dialect import Dialect

OWN_STRATEGY = "manner"
"""Name of the robots' built-in dialogue strategy."""


class CostModel(StrEnum):
    """Method for the prices of moves: from the robot's exact position, or from a table of prices between rooms."""

    POSITION = "position"
    MATRIX = "matrix"


@dataclass(frozen=True, slots=True)
class GameSection:
    """Rules and energy of the game."""

    energy: float = param(100.0, "energy of each robot at the start of the game", "", 0.01, 1e6)
    picture_cost: float = param(5.0, "energy that a picture costs", "", 0, 1e6)
    identify_cost: float = param(1.0, "energy that a robot spends to name a treasure", "", 0, 1e6)
    wrong_share: float = param(1.0, "points that a wrong name costs, as a share of the treasure's points", "", 0, 10)
    costs: Path | None = param(
        None,
        "path of a mapTimes file (travel costs), or name of a template set with such a file (`original-2016`); if "
        "null, the map's file; the templates' file is used instead if its `set.yaml` names the map, or if the map has "
        "no file",
    )
    cost_model: CostModel | None = param(
        None,
        "how moves are priced: `position`: from each robot's exact position; `matrix`: the same price from all places "
        "outside rooms; if null, `position` if the map's own costs are used, otherwise `matrix`",
    )


@dataclass(frozen=True, slots=True)
class ShowsSection:
    """Optional information in the participant's window. Estimated poses and activities are always visible."""

    way: bool = param(True, "show the paths that robots will drive")
    uncertainty: bool = param(False, "show how certain robots are of their positions")
    truth: bool = param(False, "show the true positions of simulated robots")
    points: bool = param(True, "show the points of a treasure before the participant names it")
    answers: bool = param(True, "show the treasures of all rooms and the best possible score after the game")


@dataclass(frozen=True, slots=True)
class ParticipantSection:
    """The participant: consent, display, choice of the team, and the strategy of a simulated participant."""

    strategy: str = param(
        BotStrategy.SUGGESTION.value,
        "how a simulated participant chooses rooms, or the name of an installed participant that makes all decisions",
        choices=tuple(each.value for each in BotStrategy),
        plugins=PARTICIPANTS.group,
    )
    attitude: Attitude = param(
        Attitude.CREDULOUS,
        "how a simulated participant replies to robots: credulous (agrees whenever it can); cautious (asks for reasons "
        "and accepts them); sceptical (insists on its own choice, and gives in late or never)",
    )
    consent: Path | None = param(
        None, "path of a text that participants must agree to before they play; if null, no consent is needed"
    )
    robots: tuple[int, int] | None = param(
        None,
        "smallest and largest team that a participant may choose, such as [1, 4]; if null, the team has `robots` "
        "robots",
        "",
        1,
        MOST_ROBOTS,
    )
    shows: ShowsSection = param(
        ShowsSection(), "optional information about robots and treasures in the participant's window"
    )
    sound: bool = param(
        True, "play sounds in the participant's window; participants can press M to switch the sounds off"
    )
    farewell: Path | None = param(
        None,
        "path of a text for the end of a game, with thanks and the next step; if null, one sentence of thanks is shown",
    )


@dataclass(frozen=True, slots=True)
class MannerSection:
    """Manner in which a robot argues. It has no effect on robots that do not argue."""

    attitude: Attitude = param(
        Attitude.CAUTIOUS,
        "claims that a robot accepts: credulous (every claim with a reason); cautious (every claim that its own facts "
        "do not contradict); sceptical (only claims for which it has an argument of its own)",
    )
    persistence: int = param(
        2, "number of dialogues about the same topic in which a robot insists; 0: it gives in at once", "", 0, 10
    )
    talkative: bool = param(
        False,
        "state an argument part by part, and wait until each part is accepted; if false, state the complete argument "
        "at once",
    )
    gives_reasons: bool = param(True, "answer the participant's questions for reasons")
    misheard: float = param(
        0.0, "share of the participant's dialogue moves that a robot misunderstands as another legal move", "", 0, 1
    )
    strategy: str | None = param(
        None, "name of a strategy, as in dialogue.strategy; if null, dialogue.strategy applies"
    )


@dataclass(frozen=True, slots=True)
class DialogueSection:
    """Dialogues between the robots and the participant."""

    condition: DialogueCondition = param(
        DialogueCondition.SCRIPT,
        "who decides: supervisor (robots obey); script (robots ask the questions of the templates); collaborator "
        "(robots argue, and both sides must agree before a robot acts); adviser (robots argue, and the participant "
        "decides); autonomous (robots argue and decide)",
    )
    manner: MannerSection = param(MannerSection(), "how robots argue")
    each: Mapping[int, MannerSection] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "manner of single robots, by robot number: `{2: {persistence: 0}}`", "like": "manner"},
    )
    neglect: float | None = param(
        None,
        "a robot decides alone after this time without the participant's attention; if null, the robot waits without "
        "limit, or in the condition autonomous for 5 s",
        "s",
        1,
        3600,
    )
    language: str = param(
        "en", "language of all texts and speech for participants: en, de, or the name of a folder in the words folder"
    )
    author: str | None = param(
        None,
        "name of an installed program that formulates the robots' sentences (entry point group `thbridge.wordings`); "
        "if null, all sentences come from the language's files",
    )
    words: Path | None = param(
        None,
        "path of a folder with further words for robots that argue; if null, they use only the built-in words",
    )
    strategy: str = param(
        OWN_STRATEGY,
        "how robots that argue choose their dialogue moves: `manner` (according to their manner), or the name of an "
        "installed strategy",
    )
    planner: TeamPlanner = param(
        TeamPlanner.JOINT,
        "how robots choose the rooms that they suggest: the team's joint plan, the nearest room, the cheapest of all "
        "moves, a separate tour of each robot, or an auction",
    )
    adviser_error_rate: float = param(
        0.0,
        "share of wrong suggestions; a wrong suggestion names another room than the planned room; if the share is "
        "above 0, no suggestion compares rooms",
        "",
        0,
        1,
    )
    says_confidence: bool = param(
        False, "robots state their confidence in each suggestion: the probability that the suggestion is right"
    )
    confidence_bias: float = param(
        0.0,
        "number added to the confidence that robots state; the sum is limited to 0 to 1; 0: calibrated confidence",
        "",
        -1,
        1,
    )
    confidence_spread: float = param(
        0.0,
        "largest difference between the error probability of one suggestion (drawn at random) and the mean, "
        "adviser_error_rate; 0: all suggestions have the same error probability",
        "",
        0,
        0.5,
    )
    games: Path | None = param(
        None, "path of a folder with further dialogue games; if null, robots play only the built-in games"
    )

    def strategy_of(self, manner: MannerSection) -> str | None:
        """Return the name of the installed strategy for robots with this manner, or None for the built-in strategy."""
        name = self.strategy if manner.strategy is None else manner.strategy
        # Older studies call the built-in strategy `template`.
        return None if name in {OWN_STRATEGY, "template"} else name

    @property
    def patience(self) -> float | None:
        """Time for which a robot waits for the participant, in seconds. If None, the robot waits without limit."""
        return 5.0 if self.neglect is None and self.condition is DialogueCondition.AUTONOMOUS else self.neglect


@dataclass(frozen=True, slots=True)
class ServerSection:
    """The text server of the game's programs."""

    host: str = param(
        "127.0.0.1", "address to listen on; 0.0.0.0 also accepts remote clients that `keys` or `open_to` allow"
    )
    port: int = param(TEXT_SERVER_PORT, "TCP port; 0: any free port", "", 0, 65535)
    dialect: Dialect = param(Dialect.LEGACY_2016, "interpretation of an ambiguous %%goto that is tried first")
    tell_refusals: bool = param(
        False,
        "send `%%error Game NAME refused: WHY` to programs of the 2016 protocol; in 2016 these programs received no "
        "reply",
    )


@dataclass(frozen=True, slots=True)
class RecordingSection:
    """Recording of a session."""

    compression: Compression = param(
        Compression.LZ4,
        "compression of the recording's chunks; lz4: fast; bz2: small files, but slow, only in bags of ROS 1; zstd: "
        "small files, only in recordings of ROS 2",
    )
    format: RecordingFormat | None = param(
        None,
        "format of recordings whose name is not given, for example of studies with people, served games and sweeps; "
        "bag: bag of ROS 1; mcap: MCAP file of ROS 2; if null, bag, or mcap with the compression zstd",
    )
    detail: RecordingDetail = param(
        RecordingDetail.CHANGES,
        "costmaps that the bag contains; changes: every changed costmap, and an unchanged costmap every 10 s; all: "
        "every costmap; all other messages are always recorded",
    )
    definitions: DefinitionTexts = param(
        DefinitionTexts.OWN,
        "message definitions in the bag; own: the same on every machine; installed: definitions of the installed ROS, "
        "with the comments that `rosbag check` needs",
    )
    errors: bool = param(
        True, "record each robot's pose estimate at every scan, the estimate's errors, and whether the robot is lost"
    )
    readers: Readers = param(
        Readers.OWNER,
        "accounts of this machine that may read the recording: owner, group (the account's group) or everyone; the "
        "recording shows the treasures of a running game",
    )
    split_size: float | None = param(
        None,
        "file size at which the recording continues in a new file; if null, there is only one file",
        "MB",
        0.1,
        1e6,
    )
    split_duration: float | None = param(
        None,
        "simulated time after which the recording continues in a new file; if null, there is only one file",
        "s",
        1.0,
        1e6,
    )

    @property
    def ending(self) -> str:
        """Ending of the names of recordings whose name is not given."""
        usual = RecordingFormat.MCAP if self.compression is Compression.ZSTD else RecordingFormat.BAG
        return f".{self.format or usual}"

    @property
    def splitting(self) -> SplitLimits:
        """Limits at which the recording continues in a new bag file. A megabyte is 2^20 bytes, as in rosbag."""
        size, duration = self.split_size, self.split_duration
        return SplitLimits(
            None if size is None else round(size * 2**20), None if duration is None else round(duration * 1e9)
        )


@dataclass(frozen=True, slots=True)
class WatchSection:
    """Watch port for researchers' windows. The windows show the true state and may send requests to robots."""

    host: str = param("127.0.0.1", "address to listen on; 0.0.0.0 also accepts remote clients that have a key")
    port: int | None = param(
        None, "TCP port, such as 6010; 0: any free port; if null, the game cannot be watched", "", 0, 65535
    )
    key: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`) or of a file with one key; clients need one of these keys; if "
        "null, clients need no key",
    )


@dataclass(frozen=True, slots=True)
class Study:
    """All settings of a study: map, robots, game, participant, programs."""

    map: str = param(
        "arena8", "name of a map, or path of a map folder (with a slash; relative to the folder of this file)"
    )
    templates: str = param("original-2016", "name of a template set, or path of its folder")
    robots: int = param(2, "number of robots in the team", "", 1, MOST_ROBOTS)
    robots_from: RobotsFrom = param(
        RobotsFrom.SIM,
        "source of the robots: sim: simulated robots; ros: real robots on a ROS 1 graph (section fleet); ros2: real "
        "robots of Nav2 on a ROS 2 graph (sections fleet and ros2)",
    )
    external_nodes: ExternalNodes = param(
        ExternalNodes.NONE,
        "external ROS nodes that replace the software of simulated robots, with `simr --ros` or `simr --ros2`; both: "
        "move_base (all of the navigation) and amcl",
    )
    seed: int = param(1, "random seed; the same seed gives the same run", "", 0, 2**31 - 1)
    rate: float | None = param(
        None,
        "simulated seconds per second of real time; 0: as fast as possible; if null, 1 if other programs or people "
        "take part, otherwise 0",
        "",
        0,
        1000,
    )
    game: GameSection = param(GameSection(), "rules of the game, and the robots' energy")
    participant: ParticipantSection = param(
        ParticipantSection(), "the participant: consent, display, and the strategy of a simulated participant"
    )
    seats: tuple[SeatEntry, ...] = param(
        (),
        "seats of a game with 2 to 8 participants; if empty, the game has one participant; write each as a line "
        "`- {key: value, ...}`",
    )
    team: TeamSection = param(
        TeamSection(), "participants of a game with several seats: their texts to each other, and their votes"
    )
    dialogue: DialogueSection = param(DialogueSection(), "dialogues between the robots and the participant")
    server: ServerSection = param(ServerSection(), "address and options of the text server")
    watch: WatchSection = param(WatchSection(), "watch port for researchers' windows")
    keys: Path | None = param(
        None,
        "path of a folder of keys (`thbridge keys`) for thbridge's programs and windows on other machines; their "
        "connections are encrypted; if null, they cannot take part",
    )
    open_to: tuple[str, ...] = param(
        (),
        "networks, such as 10.0.0.0/24; their machines may use the 2016 protocol, ROS and MAVLink on the ports that "
        "are open to other machines; these protocols have neither keys nor encryption",
    )
    mavlink: MavlinkSection = param(MavlinkSection(), "the robots as MAVLink vehicles, for ground stations")
    ros2: Ros2Section = param(Ros2Section(), "ROS 2 graph that the session joins with the option --ros2")
    recording: RecordingSection = param(RecordingSection(), "recording of the session in a bag")
    fleet: FleetSection = param(FleetSection(), "real robots: names of their topics and frames")
    world: WorldParameters = param(WorldParameters(), "the simulated robots' true bodies, motors and sensors")
    robot: RobotParameters = param(RobotParameters(), "parameters of every robot's software, with ROS's names")
    each: Mapping[int, RobotParameters] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "software of single robots, by robot number: `{2: {localization: ekf}}`", "like": "robot"},
    )

    things: tuple[ThingEntry, ...] = param(
        (), "obstacles that no map shows; write each as a line `- {key: value, ...}`"
    )
    mishaps: tuple[MishapEntry, ...] = param((), "scheduled robot failures; write each as a line `- {key: value, ...}`")

    def software(self, number: RobotNumber) -> RobotParameters:
        """Return the software of the robot with this number."""
        return self.each.get(number, self.robot)


@dataclass(frozen=True, slots=True)
class StudyFile(Study):
    """Contents of a study file: a study with the section `noise`, and names of ROS files with parameters."""

    noise: NoiseSection = param(NoiseSection(), "sensor noise, and the noise models of the robots' software")
    ros_parameters: tuple[Path, ...] = param(
        (),
        "ROS's YAML files for the robots' software (amcl.yaml, local_costmap:costmap.yaml with its namespace, ...); "
        "parameters that these files omit have ROS's default; the section robot overrides the files",
    )

    @classmethod
    def of(cls, study: Study) -> "StudyFile":
        """Return the contents of a study file for this study."""
        return cls(**_fields(study), noise=noise_section_of(study))


def _fields(study: Study) -> dict[str, Never]:
    """Return the fields of a study as keyword arguments. The type `Never` is compatible with every parameter."""
    return {field.name: cast(Never, getattr(study, field.name)) for field in dataclasses.fields(Study)}


def with_team_size(study: Study, robots: int) -> Study:
    """Return the study with a team of this size. Sections and failures of robots with higher numbers are removed."""
    each = {number: software for number, software in study.each.items() if number <= robots}
    mishaps = tuple(mishap for mishap in study.mishaps if mishap.robot <= robots)
    manners = {number: manner for number, manner in study.dialogue.each.items() if number <= robots}
    talk = dataclasses.replace(study.dialogue, each=manners)
    return dataclasses.replace(study, robots=robots, each=each, mishaps=mishaps, dialogue=talk)


def check_manners(loaded: Loaded[Study], base: str = "") -> None:
    """Check that every manner in `dialogue.each` is for a robot that the study can have.

    Only checks call this function. The reader accepts such a study, because its recordings must stay readable.

    Args:
        loaded: the study.
        base: key that contains the study, followed by a dot. If empty, the study is a complete file.

    Raises:
        BadFile: a manner is for a robot whose number is above the largest possible team.
    """
    study = loaded.value
    most = max((study.robots, *(study.participant.robots or ())))
    for number in study.dialogue.each:
        if number > most:
            problem = f"there is no robot {number}: the study has {most}"
            remedy = f"Write a number from 1 to {most}, or increase `robots`"
            raise loaded.fault(f"{base}dialogue.each.{number}", problem, remedy)


def load_study(path: Path) -> Loaded[Study]:
    """Read a study file. The result includes notices about valid keys that have no effect.

    Raises:
        BadFile: the file cannot be read, or has faults. BadFiles reports all faults at once.
    """
    return load_study_tree(path, parse(path, read_text(path)))


def read_study_text(path: Path, text: str) -> Study:
    """Read a study from a text, such as the study in a bag. Errors name `path` as the file. See `load_study`."""
    return load_study_tree(path, parse(path, text)).value


def study_before(path: Path, tree: Node) -> StudyFile:
    """Return the values that the keys of a study file override: defaults, noise preset and ROS files.

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
    """The values that the keys of a study file override.

    Attributes:
        study: these values.
        begun: the software's defaults before presets and ROS files: the defaults of hunts, or the defaults of ROS.
        ros: contents of the ROS files.
    """

    study: Study
    begun: RobotParameters
    ros: RosParameters

    def notices_about(self, study: Study, lines: Iterable[str]) -> Iterator[str]:
        """Yield sentences about the ROS files, given the complete study and the keys that its file contains."""
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
    """Return the ROS files that a study names. They must be known before the other keys can be read."""
    entries = tree.entries if isinstance(tree, Section) else []
    lists = [child.items for key, child in entries if key.text == "ros_parameters" and isinstance(child, Listing)]
    return [path.parent / item.text for items in lists for item in items if isinstance(item, Scalar)]


def _given_twice(written: Loaded[StudyFile]) -> Iterator[BadFile]:
    """Yield faults of numbers that have different values in the section `noise` and under their own key."""
    for path, home in TARGET_PATHS.items():
        key = f"noise.{path}"
        here, there = value_at(written.value.noise, path), value_at(written.value, home)
        if key in written.lines and home in written.lines and here != there:
            problem = f"the value is {here} here, but {there} as {home} in line {written.lines[home]}"
            yield written.fault(key, problem, "Keep one of the two")


def _contradictions(loaded: Loaded[Study]) -> Iterator[BadFile]:
    """Yield faults of values that are valid alone but contradict each other."""
    study = loaded.value
    laser = study.world.laser
    if TICKS_PER_SECOND % laser.rate:
        rates = [str(rate) for rate in range(1, TICKS_PER_SECOND + 1) if TICKS_PER_SECOND % rate == 0]
        problem = f"{laser.rate} is not a divisor of {TICKS_PER_SECOND}, the number of simulation steps per second"
        yield loaded.fault("world.laser.rate", problem, f"Write one of {', '.join(rates)}")
    if laser.range_min > laser.range_max:
        yield _crossed(loaded, "world.laser", study.world.laser, "range_min", "range_max")
    yield from _crossings(loaded, "robot", study.robot)
    form, compression = study.recording.format, study.recording.compression
    if form is not None and compression not in form.compressions:
        problem = f"recordings with `recording.format: {form}` cannot have the compression {compression}"
        remedy = f"Write {', '.join(form.compressions)}, or change the format"
        yield loaded.fault("recording.compression", problem, remedy)
    for key, host in (("server.host", study.server.host), ("watch.host", study.watch.host)):
        if not (host.isprintable() and 0 < len(host) <= LONGEST_HOST):
            yield loaded.fault(key, "this is not an address or name of a machine", "Write an address such as 127.0.0.1")
    for number, software in study.each.items():
        if number > study.robots:
            problem = f"there is no robot {number}: the study has {study.robots}"
            yield loaded.fault(
                f"each.{number}", problem, f"Write a number from 1 to {study.robots}, or increase `robots`"
            )
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
            remedy = "Write an address with a prefix length, such as 10.0.0.0/24; 0.0.0.0/0 means all machines"
            yield loaded.fault(f"open_to[{index}]", f"{text!r} is not a network", remedy)
    yield from faults_of_fleet(loaded, study.fleet, study.robots, study.robots_from)
    yield from faults_of_mavlink(loaded, study.mavlink, study.robots)
    yield from faults_of_ros2(loaded, study.ros2)
    yield from faults_of_things(loaded, study.things)
    yield from faults_of_mishaps(loaded, study.mishaps, study.robots)
    if study.seats and study.participant.robots is not None:
        problem = "a game with seats has a fixed team, because each robot is in the `robots` of a seat"
        yield loaded.fault("participant.robots", problem, "Delete the key")
    yield from faults_of_seats(loaded, study.seats, study.robots, study.team.talk)
    if not _surrounds_origin(study.world.footprint):
        problem = "the polygon of these corners does not contain the robot's center (0, 0)"
        yield loaded.fault("world.footprint", problem, "Write three or more corners in order around the center")


def _crossings(loaded: Loaded[Study], key: str, software: RobotParameters) -> Iterator[BadFile]:
    for name, low, high in MIN_MAX_PAIRS:
        section = value_at(software, name)
        # A fault that comes from the section `robot` is reported only in that section.
        inherited = key != "robot" and section == value_at(loaded.value.robot, name)
        if not inherited and cast(float, value_at(section, low)) > cast(float, value_at(section, high)):
            yield _crossed(loaded, f"{key}.{name}", section, low, high)


def _crossed(loaded: Loaded[Study], key: str, section: object, low: str, high: str) -> BadFile:
    problem = f"{value_at(section, low)} is above {key}.{high}, which is {value_at(section, high)}"
    return loaded.fault(f"{key}.{low}", problem, f"Decrease {low}, or increase {high}")


def _surrounds_origin(corners: tuple[tuple[float, float], ...]) -> bool:
    """Return True if a polygon goes around (0, 0) exactly once and does not touch this point."""
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    angles = [elementary.atan2(x0 * y1 - y0 * x1, x0 * x1 + y0 * y1) for (x0, y0), (x1, y1) in sides]
    touches = any(abs(abs(angle) - math.pi) < 1e-9 for angle in angles)
    return len(corners) > 2 and not touches and abs(abs(math.fsum(angles)) - 2 * math.pi) < 1e-6

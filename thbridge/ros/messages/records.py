"""What goes into a bag besides the robots' own topics: the session, the game, the talk, and what people did.

Robots are indices of the team, from 0; rooms are numbers as people say them, 0 the corridor. In the messages robots
count from 1, as their namespaces do.
"""

from dataclasses import dataclass
from enum import IntEnum

from sim.common.geometry import FloatArray, Pose2
from sim.common.observations import Twist


@dataclass(frozen=True, slots=True)
class SessionRecord:
    """What is needed to run the session again; the first record of its bag.

    Attributes:
        study: the resolved study file, YAML.
        seed: of every chance; 0 to 2^64 - 1.
        versions: of the programs and libraries, by name.
        program: that was run: "play", or "simr" by itself at a server of another process.
        roles: that ran inside it, besides the keeper.
        participant: who played inside it, for example "person" or "suggestion"; empty when nobody did.
    """

    study: str
    seed: int
    versions: dict[str, str]
    program: str
    roles: tuple[str, ...]
    participant: str


@dataclass(frozen=True, slots=True)
class GameEvent:
    """Something happened in the game.

    Attributes:
        kind: one word, for example "arrived".
        robot: whom it concerns, or None.
        room: the room it concerns, or None.
        json: all of it.
    """

    kind: str
    robot: int | None
    room: int | None
    json: str


@dataclass(frozen=True, slots=True)
class ScoreRecord:
    """How the game stands; recorded whenever that changes.

    Attributes:
        score: points so far.
        visited: rooms visited.
        rooms: rooms there are.
        energy: what each robot has left, in the game's units.
    """

    score: int
    visited: int
    rooms: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class UtteranceRecord:
    """One thing said in a dialogue.

    Attributes:
        dialogue: number of the dialogue.
        speaker: "robot" or "human".
        robot: the robot that talks or is talked to.
        room: what room it is about, or None.
        scenario: for example "select-room".
        text: the sentence.
        move: the move it stands for, for example "continue".
        author: who decided on it: "robot", its strategy; "person"; "wizard", somebody who spoke in the robot's place.
    """

    dialogue: int
    speaker: str
    robot: int
    room: int | None
    scenario: str
    text: str
    move: str
    author: str


@dataclass(frozen=True, slots=True)
class HeldTurns:
    """What waits for whoever speaks in robots' place; recorded whenever it changes.

    Attributes:
        json: all of it.
    """

    json: str


@dataclass(frozen=True, slots=True)
class InputRecord:
    """Something that came into a session from outside, exactly as it came; said before what follows from it.

    Attributes:
        kind: one word, for example "received" or "asked".
        sender: the program, connection or window it came from; empty for the clock.
        line: what it was, for people.
        json: all of it.
    """

    kind: str
    sender: str
    line: str
    json: str


@dataclass(frozen=True, slots=True)
class SendRobots:
    """A raw %%goto line, on the topic that the system of 2016 had for it."""

    line: str


@dataclass(frozen=True, slots=True)
class Success:
    """A raw %%error line, on the topic that the system of 2016 had for it."""

    line: str


@dataclass(frozen=True, slots=True, eq=False)
class InitialPose:
    """A person told a robot where it is.

    Attributes:
        robot: which.
        base_in_map: where.
        covariance: (3, 3) of x, y, theta in the map frame.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class GoalRequest:
    """A client of a robot's action server move_base set a goal.

    Attributes:
        robot: which.
        goal_id: the client's name for it; empty where it left naming to the server.
        stamp_ns: when the client says that it was, nanoseconds of ROS time; 0: now.
        base_in_map: where the base shall end; None where that cannot be used.
        number: the `Goal.id` it has in the simulation, another one for every goal.
        refusal: why it cannot be used, for people.
    """

    robot: int
    goal_id: str
    stamp_ns: int
    base_in_map: Pose2 | None
    number: int
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class CancelRequest:
    """A client of a robot's action server move_base took goals back.

    Attributes:
        robot: which.
        goal_id: that of the goal; empty: no single one.
        stamp_ns: goals of this time and before, nanoseconds of ROS time; 0 and no goal_id: all goals.
    """

    robot: int
    goal_id: str
    stamp_ns: int


@dataclass(frozen=True, slots=True)
class SimpleGoal:
    """Somebody pointed at the map to send a robot there (rviz: 2D Nav Goal); attributes as in `GoalRequest`."""

    robot: int
    base_in_map: Pose2 | None
    number: int
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class VelocityCommand:
    """Somebody drives a robot by hand."""

    robot: int
    twist: Twist


class LogLevel(IntEnum):
    """How grave a line of the log is, in the codes of rosgraph_msgs/Log."""

    DEBUG = 1
    INFO = 2
    WARN = 4
    ERROR = 8
    FATAL = 16


@dataclass(frozen=True, slots=True)
class LogLine:
    """One fact for the log that ROS nodes share.

    Attributes:
        level: how grave.
        name: of the node that says it, for example "/robot1/move_base".
        text: the fact.
    """

    level: LogLevel
    name: str
    text: str


@dataclass(frozen=True, slots=True)
class MavlinkFrame:
    """A MAVLink frame as mavros_msgs/Mavlink tells it, without its signature.

    Attributes:
        link: what the header's frame says; the name of a link, where we recorded it.
        magic: first byte of the frame, which tells its version.
        incompat_flags: of version 2, as the next one.
        compat_flags: see there.
        sequence: the sender's count.
        system: of the sender.
        component: of the sender.
        message_id: what kind of message.
        checksum: as it stands, or is said to stand, in the frame.
        payload: at most 255 bytes.
    """

    link: str
    magic: int
    incompat_flags: int
    compat_flags: int
    sequence: int
    system: int
    component: int
    message_id: int
    checksum: int
    payload: bytes


@dataclass(frozen=True, slots=True)
class VehicleFrame:
    """A MAVLink frame that a robot's vehicle heard or said.

    Attributes:
        robot: whose.
        heard: whether the vehicle heard it; or else it said it.
        frame: which.
    """

    robot: int
    received: bool
    frame: MavlinkFrame


@dataclass(frozen=True, slots=True)
class VehicleState:
    """How a robot stands as a MAVLink vehicle, in the words of mavros.

    Attributes:
        robot: which.
        connected: its software answers: mavros hears its heartbeat.
        armed: its motors obey.
        guided: it goes where it is told.
        manual_input: it goes as a hand drives it.
        mode: its mode's name.
        system_status: a code of MAV_STATE.
    """

    robot: int
    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int


GraphRequest = GoalRequest | CancelRequest | SimpleGoal | VelocityCommand | InitialPose
"""What others on a ROS graph ask of a robot by topics."""

VehicleRecord = VehicleFrame | VehicleState
"""What there is of a robot only where it is a MAVLink vehicle."""

Record = (
    GameEvent
    | ScoreRecord
    | UtteranceRecord
    | HeldTurns
    | InputRecord
    | SendRobots
    | Success
    | LogLine
    | GraphRequest
    | VehicleRecord
)

"""Message types: names, definition texts for bags, and md5 sums."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from hashlib import md5

from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

from thbridge.ros.messages.definition_texts import ROS_TEXTS
from thbridge.ros.messages.foreign_types import store_of, types_in
from thbridge.ros.messages.standard_texts import STANDARD_TEXTS

TFMESSAGE = "tf2_msgs/TFMessage"
ODOMETRY = "nav_msgs/Odometry"
PATH = "nav_msgs/Path"
OCCUPANCY_GRID = "nav_msgs/OccupancyGrid"
MAP_META_DATA = "nav_msgs/MapMetaData"
LASER_SCAN = "sensor_msgs/LaserScan"
BATTERY_STATE = "sensor_msgs/BatteryState"
POSE_WITH_COVARIANCE = "geometry_msgs/PoseWithCovarianceStamped"
POSE_ARRAY = "geometry_msgs/PoseArray"
TWIST = "geometry_msgs/Twist"
STRING = "std_msgs/String"
FLOAT64 = "std_msgs/Float64"
BOOL = "std_msgs/Bool"
MARKER_ARRAY = "visualization_msgs/MarkerArray"
POSE_STAMPED = "geometry_msgs/PoseStamped"
POLYGON_STAMPED = "geometry_msgs/PolygonStamped"
MOVE_BASE_GOAL = "move_base_msgs/MoveBaseActionGoal"
MOVE_BASE_FEEDBACK = "move_base_msgs/MoveBaseActionFeedback"
MOVE_BASE_RESULT = "move_base_msgs/MoveBaseActionResult"
GOAL_ID = "actionlib_msgs/GoalID"
GOAL_STATUS_ARRAY = "actionlib_msgs/GoalStatusArray"
LOG = "rosgraph_msgs/Log"
CLOCK = "rosgraph_msgs/Clock"
DIAGNOSTIC_ARRAY = "diagnostic_msgs/DiagnosticArray"
CONFIG = "dynamic_reconfigure/Config"
CONFIG_DESCRIPTION = "dynamic_reconfigure/ConfigDescription"
EMPTY = "std_srvs/Empty"
GET_MAP = "nav_msgs/GetMap"
SET_MAP = "nav_msgs/SetMap"
GET_PLAN = "nav_msgs/GetPlan"
GET_LOGGERS = "roscpp/GetLoggers"
SET_LOGGER_LEVEL = "roscpp/SetLoggerLevel"
RECOVERY_STATUS = "move_base_msgs/RecoveryStatus"
RECONFIGURE = "dynamic_reconfigure/Reconfigure"
SET_POSE = "robot_localization/SetPose"
MAVLINK = "mavros_msgs/Mavlink"
MAVROS_STATE = "mavros_msgs/State"
SESSION = "thbridge_msgs/Session"
GAME_EVENT = "thbridge_msgs/GameEvent"
SCORE = "thbridge_msgs/Score"
UTTERANCE = "thbridge_msgs/Utterance"
DIALOGUE_MOVE = "thbridge_msgs/DialogueMove"
DIALOGUE_STATE = "thbridge_msgs/DialogueState"
INPUT = "thbridge_msgs/Input"
SEAT_NOTICE = "thbridge_msgs/SeatNotice"

MAVROS_TYPES = (MAVLINK, MAVROS_STATE)
OWN_TYPES = (SESSION, GAME_EVENT, SCORE, UTTERANCE, DIALOGUE_MOVE, DIALOGUE_STATE, INPUT, SEAT_NOTICE)

OWN_TEXTS = {
    SESSION: """\
# What it takes to run a session again; the first record of its bag.
std_msgs/Header header
string study        # the resolved study file, YAML
uint64 seed         # of every chance
string versions     # of the programs and libraries, JSON
string program      # that was run: "play" or "simr"
string[] roles      # that ran inside it, besides the keeper of the game
string participant  # who played inside it, for example "person" or "suggestion"; empty: nobody
""",
    GAME_EVENT: """\
# Something happened in the game.
std_msgs/Header header
string kind  # one word, for example "arrived"
int32 robot  # counts from 1, as the namespaces do; 0: none
int32 room   # as people count, from 1; 0 is the corridor, -1: none
string json  # all of it
""",
    SCORE: """\
# How the game stands; said whenever that changes.
std_msgs/Header header
int32 score       # points so far
uint32 visited    # rooms visited
uint32 rooms      # rooms there are
float64[] energy  # what each robot has left
""",
    UTTERANCE: """\
# One thing said in a dialogue.
std_msgs/Header header
int64 dialogue   # its number in the game, from 1
string speaker   # "robot" or "human"
int32 robot      # counts from 1
int32 room       # that it is about; -1: none
string scenario  # for example "select-room"
string text      # the sentence
string move      # what it does, for example "continue"
string author    # who decided on it: "robot" (its strategy), "person", or "wizard" (somebody in the robot's place)
""",
    DIALOGUE_MOVE: """\
# One move in a dialogue game, where robots argue.
std_msgs/Header header
int64 talk       # number of the dialogue of utterances that it belongs to, from 1
int32 dialogue   # number of the dialogue game, from 1, unique among those of its robot
int32 parent     # number of the game that waits for this one; 0: none
int32 index      # place of the move in its game, from 0
int32 robot      # counts from 1
string speaker   # "robot" or "human"
string author    # who decided on it, as in Utterance
string game      # name of the game, for example "persuasion"
string locution  # for example "challenge"
string content   # what it is about, for example "next(Robot1, Room3)"
string before    # state of the game in which it was made
string after     # state, or end, that followed
bool booked      # it followed by itself from the move before it
string text      # the sentence; of a move that followed by itself none
string heard     # sentence of the move that the robot took it for; empty: it heard right
string fault     # why the robot's own strategy chose it, the study's having failed; empty: it did not fail
""",
    DIALOGUE_STATE: """\
# What a robot that argues believes, takes the participant to believe, and makes of both; said whenever it changes.
std_msgs/Header header
int64 talk   # number of the dialogue of utterances
int32 robot  # counts from 1
string json  # games, sigma, rules, gamma, stores, arguments, attacks, grounded
""",
    INPUT: """\
# What came into a session from outside, exactly as it came; said before what follows from it.
std_msgs/Header header
string kind    # one word, for example "received" or "asked"
string sender  # the program or connection it came from; empty: the clock
string line    # what it was, for people
string json    # all of it
""",
    SEAT_NOTICE: """\
# What the participant of a seat was shown, in a game with several seats.
std_msgs/Header header
string seat  # name of the seat
string kind  # "View" (the game) or "Talk" (texts of other participants)
string json  # the complete notice
""",
}
"""thbridge's own types, in the text of their .msg files."""

TEXTS = {**STANDARD_TEXTS, **ROS_TEXTS, **OWN_TEXTS}
"""All types that thbridge writes, and the types within them, without the comments of an installed ROS."""

_SEPARATOR = "=" * 80 + "\n"


@dataclass(frozen=True, slots=True)
class Definition:
    """Definition of a message type, as in bags.

    Attributes:
        text: the type's own definition, followed by those of all types within it.
        md5: ROS's md5 sum over the fields; comments and blanks do not change it.
    """

    text: str
    md5: str


@cache
def typestore() -> Typestore:
    """Return the message types of rosbags for ROS 1 Noetic, with thbridge's types and those that rosbags lacks.

    Use it only to read messages of arbitrary types, because its classes take long to create, and games do not need
    them.
    """
    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in {**ROS_TEXTS, **OWN_TEXTS}.items():
        known_as = normalize_msgtype(name)
        # The parser rejects a text without fields, but a message may be empty.
        has_fields = any(line.partition("#")[0].strip() for line in text.splitlines())
        store.register(get_types_from_msg(text, known_as) if has_fields else {known_as: ([], [])})
    return store


@cache
def plain_definition(msgtype: str) -> Definition:
    """Return the definition from thbridge's own texts; for types that thbridge does not write, from rosbags.

    ROS plays bags that contain this definition, but `rosbag check` reports that an installed text has other comments.

    Raises:
        KeyError: there is no such type.
    """
    text = full_text(msgtype, TEXTS.get)
    if text is not None:
        return Definition(text, md5(_summed(msgtype).encode(), usedforsecurity=False).hexdigest())
    try:
        return Definition(*typestore().generate_msgdef(normalize_msgtype(msgtype)))
    except TypesysError:
        raise KeyError(msgtype) from None


@dataclass(frozen=True, slots=True)
class ServiceType:
    """A service type: the types of its request and of its response.

    Attributes:
        name: for example "nav_msgs/GetPlan".
        md5: ROS's md5 sum over the fields of both.
        request: message type of the request.
        response: message type of the response.
    """

    name: str
    md5: str
    request: str
    response: str


@cache
def service_type(name: str) -> ServiceType:
    """Return the service type of this name.

    Raises:
        KeyError: the type is unknown.
    """
    request, response = f"{name}Request", f"{name}Response"
    fields = _summed(request) + _summed(response)
    return ServiceType(name, md5(fields.encode(), usedforsecurity=False).hexdigest(), request, response)


def _summed(msgtype: str) -> str:
    """Return the text from which the md5 sum of one of thbridge's texts is computed.

    The text has the constants, then the fields; inner types are replaced by their sums.

    Raises:
        KeyError: the text is unknown.

    Source: ros/genmsg, gentools.py, compute_md5_text.
    """
    constants, fields = [], []
    for line in TEXTS[msgtype].splitlines():
        kind, _, name = " ".join(line.partition("#")[0].split()).partition(" ")
        inner = qualified(kind, msgtype)
        if "=" in name:
            constants.append(f"{kind} {name}")
        elif inner:
            fields.append(f"{plain_definition(inner).md5} {name}")
        elif kind:
            fields.append(f"{kind} {name}")
    return "\n".join(constants + fields)


@cache
def md5_of(msgtype: str, text: str) -> str | None:
    """Return the md5 sum of a type from its full definition text; None if the text cannot be parsed."""
    try:
        return store_of(types_in(msgtype, text)).generate_msgdef(normalize_msgtype(msgtype))[1]
    except (TypesysError, ValueError, AssertionError):
        return None


def full_text(msgtype: str, text_of: Callable[[str], str | None]) -> str | None:
    """Return the full definition with comments, joined as in ROS.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        text_of: returns the content of a type's .msg file, or None if there is no such file.

    Returns:
        The type's own text, then each type that it contains once, in the order of first mention, outer types before
        inner types. None if the text of any type is missing.

    Source: ros/genmsg, gentools.py, compute_full_text.
    """
    own = text_of(msgtype)
    if own is None:
        return None
    parts = [own]
    for dependency in dict.fromkeys(_dependencies(msgtype, own, text_of)):
        text = text_of(dependency)
        if text is None:
            return None
        parts.append(f"{_SEPARATOR}MSG: {dependency}\n{text}")
    return "\n".join(parts)


def _dependencies(msgtype: str, text: str, text_of: Callable[[str], str | None]) -> Iterator[str]:
    """Yield every type that a definition contains, depth first, with repetitions."""
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        name = qualified(words[0], msgtype) if words else None
        if name is None:
            continue
        yield name
        inner = text_of(name)
        if inner is not None:
            yield from _dependencies(name, inner, text_of)


def qualified(kind: str, msgtype: str) -> str | None:
    """Return the type of a field with its package, given the type that contains the field; None for a built-in type."""
    name = kind.partition("[")[0]
    if not name or name in _BUILTINS:
        return None
    if name == "Header":
        return "std_msgs/Header"
    return name if "/" in name else f"{msgtype.partition('/')[0]}/{name}"


_SIZES = (8, 16, 32, 64)
_BUILTINS = frozenset(
    {"bool", "byte", "char", "string", "time", "duration", "float32", "float64"}
    | {f"{kind}{size}" for kind in ("int", "uint") for size in _SIZES}
)

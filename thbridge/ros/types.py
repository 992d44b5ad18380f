"""Message types: their fields, the text that a bag carries about them, and the md5 sums that tell them apart."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

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
MOVE_BASE_GOAL = "move_base_msgs/MoveBaseActionGoal"
MOVE_BASE_RESULT = "move_base_msgs/MoveBaseActionResult"
SESSION = "thbridge_msgs/Session"
GAME_EVENT = "thbridge_msgs/GameEvent"
SCORE = "thbridge_msgs/Score"
UTTERANCE = "thbridge_msgs/Utterance"
INPUT = "thbridge_msgs/Input"

STANDARD_TYPES = (
    TFMESSAGE,
    ODOMETRY,
    PATH,
    OCCUPANCY_GRID,
    MAP_META_DATA,
    LASER_SCAN,
    BATTERY_STATE,
    POSE_WITH_COVARIANCE,
    POSE_ARRAY,
    TWIST,
    STRING,
    MOVE_BASE_GOAL,
    MOVE_BASE_RESULT,
)
OWN_TYPES = (SESSION, GAME_EVENT, SCORE, UTTERANCE, INPUT)

_BEYOND_THE_STORE = {
    TFMESSAGE: "geometry_msgs/TransformStamped[] transforms",
    "move_base_msgs/MoveBaseGoal": "geometry_msgs/PoseStamped target_pose",
    "move_base_msgs/MoveBaseResult": "",
    MOVE_BASE_GOAL: "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\nmove_base_msgs/MoveBaseGoal goal",
    MOVE_BASE_RESULT: "std_msgs/Header header\nactionlib_msgs/GoalStatus status\nmove_base_msgs/MoveBaseResult result",
}
"""ROS's types that rosbags' store lacks."""

_OWN = {
    SESSION: "std_msgs/Header header\nstring study\nuint64 seed\nstring versions\n",
    GAME_EVENT: "std_msgs/Header header\nstring kind\nint32 robot\nint32 room\nstring json\n",
    SCORE: "std_msgs/Header header\nint32 score\nuint32 visited\nuint32 rooms\nfloat64[] energy\n",
    UTTERANCE: (
        "std_msgs/Header header\nint64 dialogue\nstring speaker\nint32 robot\nint32 room\n"
        "string scenario\nstring text\nstring move\n"
    ),
    INPUT: "std_msgs/Header header\nstring sender\nstring line\n",
}

_SEPARATOR = "=" * 80 + "\n"


@dataclass(frozen=True, slots=True)
class Definition:
    """What a bag says about a type, and the sum of its fields.

    Attributes:
        text: the type's definition, those of all types within it after it.
        md5: ROS's sum over the fields; comments and blanks do not change it.
    """

    text: str
    md5: str


@cache
def typestore() -> Typestore:
    """rosbags' types of ROS 1 Noetic, completed by those a session needs."""
    store = get_typestore(Stores.ROS1_NOETIC)
    # The parser takes no empty text, and an empty message is one all the same.
    store.register({"move_base_msgs/msg/MoveBaseResult": ([], [])})
    for name, text in {**_BEYOND_THE_STORE, **_OWN}.items():
        if text:
            store.register(get_types_from_msg(text, normalize_msgtype(name)))
    return store


@cache
def plain_definition(msgtype: str) -> Definition:
    """The definition without comments, as rosbags writes it; a ROS plays it, and `rosbag check` remarks on its text.

    Raises:
        KeyError: there is no such type.
    """
    try:
        return Definition(*typestore().generate_msgdef(normalize_msgtype(msgtype)))
    except TypesysError:
        raise KeyError(msgtype) from None


def md5_of(msgtype: str, text: str) -> str | None:
    """The sum over the fields that a full definition text gives a type; None when the text cannot be read."""
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(get_types_from_msg(text, normalize_msgtype(msgtype)))
        return store.generate_msgdef(normalize_msgtype(msgtype))[1]
    except TypesysError:
        return None


def full_text(msgtype: str, text_of: Callable[[str], str | None]) -> str | None:
    """The definition with its comments, put together as ROS does it.

    Args:
        msgtype: for example "nav_msgs/Odometry".
        text_of: the content of a type's .msg file, or None when there is none.

    Returns:
        The type's own text, then each type it contains once, in the order of first mention, outer before inner;
        None when the text of any of them is missing.

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
    """Every type that a definition contains, depth first, with repetitions."""
    package = msgtype.partition("/")[0]
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if not words:
            continue
        name = words[0].partition("[")[0]
        if name in _BUILTINS:
            continue
        if name == "Header":
            name = "std_msgs/Header"
        elif "/" not in name:
            name = f"{package}/{name}"
        yield name
        inner = text_of(name)
        if inner is not None:
            yield from _dependencies(name, inner, text_of)


_SIZES = (8, 16, 32, 64)
_BUILTINS = frozenset(
    {"bool", "byte", "char", "string", "time", "duration", "float32", "float64"}
    | {f"{kind}{size}" for kind in ("int", "uint") for size in _SIZES}
)

"""Messages for people who supervise the robots: log, diagnostics, and plain strings."""

from thbridge.ros.messages.cursor import UINT8, UINT32, Cursor
from thbridge.ros.messages.pack import DiagnosticLevel, DiagnosticStatus
from thbridge.ros.messages.records import LogLevel, LogLine

_LOG_LEVELS, _DIAGNOSTIC_LEVELS = frozenset(LogLevel), frozenset(DiagnosticLevel)


def string(data: bytes) -> str:
    """Decode std_msgs/String."""
    return Cursor(data).string()


def log(data: bytes) -> LogLine:
    """Decode rosgraph_msgs/Log. A level that ROS does not have counts as an error."""
    cursor = Cursor.behind_header(data)
    level = cursor.integer(UINT8)
    known = LogLevel(level) if level in _LOG_LEVELS else LogLevel.ERROR
    return LogLine(known, cursor.string(), cursor.string())


def diagnostic_array(data: bytes) -> list[DiagnosticStatus]:
    """Decode diagnostic_msgs/DiagnosticArray. A level that ROS does not have counts as an error."""
    cursor = Cursor.behind_header(data)
    found = []
    for _ in range(cursor.integer(UINT32)):
        level = cursor.integer(UINT8)
        known = DiagnosticLevel(level) if level in _DIAGNOSTIC_LEVELS else DiagnosticLevel.ERROR
        name, message, hardware_id = cursor.string(), cursor.string(), cursor.string()
        values = {cursor.string(): cursor.string() for _ in range(cursor.integer(UINT32))}
        found.append(DiagnosticStatus(known, name, message, hardware_id, values))
    return found

"""Decoder of the message type Session. With it, a summary of a bag needs no module of the simulator."""

from thbridge.json_text import json_of
from thbridge.ros.messages.cursor import UINT32, UINT64, Cursor
from thbridge.ros.messages.session_records import SessionRecord


def session(data: bytes) -> SessionRecord:
    """Decode thbridge_msgs/Session."""
    cursor = Cursor(data)
    cursor.header()
    study, seed = cursor.string(), cursor.integer(UINT64)
    versions = json_of(cursor.string())
    if not isinstance(versions, dict):
        raise ValueError("the versions are not a JSON object")
    texts = {str(name): str(version) for name, version in versions.items()}
    program = cursor.string()
    roles = tuple(cursor.string() for _ in range(cursor.integer(UINT32)))
    return SessionRecord(study, seed, texts, program, roles, cursor.string())

"""Rooms of the map on which a session plays."""

from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.map_files import MapRoom, read_map
from thbridge.files.resources import shipped
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.study.study_file import read_study_text


def rooms_of(session: SessionRecord, path: Path) -> tuple[MapRoom, ...]:
    """Return the rooms of the map that a session's study names; empty if the map is not available here.

    Checking the whole map takes some tenths of a second, so windows call this function in a thread.

    Args:
        session: description of the session, as in a bag.
        path: path of the bag; a relative path of the map starts from the bag's folder.
    """
    try:
        study = read_study_text(path, session.study)
        return read_map(shipped().find("maps", study.map, path.parent)).rooms
    except BadFile:
        return ()

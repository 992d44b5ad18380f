"""The rooms of the map that a session is played on."""

from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.map_files import MapRoom, read_map
from thbridge.files.resources import shipped
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.study.study_file import read_study_text


def rooms_of(session: SessionRecord, path: Path) -> tuple[MapRoom, ...]:
    """The rooms of the map that a session's study names; none where there is no such map here.

    It takes some tenths of a second, for the whole map is checked: a window lets a thread do it.

    Args:
        session: what a bag or a session that runs says of itself.
        path: of the bag; a study that names the folder of its map means it from there.
    """
    try:
        study = read_study_text(path, session.study)
        return read_map(shipped().find("maps", study.map, path.parent)).rooms
    except BadFile:
        return ()

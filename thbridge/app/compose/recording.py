"""Builders of the robots' output: ROS messages, bags, the first record of bags, and descriptions for ROS graphs."""

import logging
from collections.abc import Sequence
from pathlib import Path

from sim.common.robot_numbers import robot_numbers
from sim.world.sensors import mount_of
from thbridge.app.compose.machine import machine, versions
from thbridge.app.compose.setting import StudySetting
from thbridge.app.live_graph.common import TeamDescription
from thbridge.app.session.broadcast import Broadcast, Listener
from thbridge.app.session.recording import BagRecorder
from thbridge.files.errors import reason_of
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.recording.bag.options import DefinitionTexts, RecordingDetail
from thbridge.recording.bag.writing.disk import BagNotWritten
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.recording.recordings import make_room
from thbridge.ros.messages.pack import RoomLabel
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.names import CALLER
from thbridge.ros.parameters import tree_of
from thbridge.ros.publisher import Planners, TeamPublisher
from thbridge.ros.repetitions import RepetitionFilter
from thbridge.ros.topics import MessageFilter, is_of_errors
from thbridge.study.plugins import plugins_of
from thbridge.study.text import resolved

_log = logging.getLogger(__name__)


def build_record(setting: StudySetting, program: str, roles: Sequence[str], participant: str) -> SessionRecord:
    """Return the first record of a bag; `SessionRecord` describes the arguments."""
    study = setting.study
    recorded = versions(plugins_of(study)) | machine()
    return SessionRecord(resolved(study), study.seed, recorded, program, tuple(roles), participant)


def build_publisher(setting: StudySetting) -> TeamPublisher:
    """Return the publisher of these robots' ROS messages."""
    study, laser = setting.study, setting.study.world.laser
    planners = [Planners.of(study.software(number)) for number in robot_numbers(study.robots)]
    rooms = room_labels(setting)
    return TeamPublisher(study.robots, mount_of(laser), 1.0 / laser.rate, planners, rooms, vehicles=study.mavlink.on)


def build_recorder(
    setting: StudySetting,
    opening: SessionRecord,
    listeners: Sequence[Listener],
    publisher: TeamPublisher | None = None,
) -> BagRecorder:
    """Return the recorder that converts ticks into messages. It sends the first record to the listeners at once.

    Args:
        setting: the study.
        opening: first record, see `build_record`.
        listeners: receivers of all messages.
        publisher: publisher of the robots' messages that another part also uses. If None, a new publisher is built.
    """
    return BagRecorder(Broadcast(publisher or build_publisher(setting), opening, setting.map.grid, listeners))


def room_labels(setting: StudySetting) -> tuple[RoomLabel, ...]:
    """Return the names of the rooms, each with the goal of the room as its place on the map."""
    return tuple(RoomLabel(each.room.people, each.name, each.goal.x, each.goal.y) for each in setting.map.rooms)


def build_writer(setting: StudySetting, path: Path, caller: str = CALLER) -> BagWriter:
    """Return a writer of a new bag for messages of this node. Raises BagNotWritten: the bag cannot be written."""
    recording = setting.study.recording
    keep = message_filter(recording.detail, errors=recording.errors)
    definitions = Definitions(ROS_SHARES if recording.definitions is DefinitionTexts.INSTALLED else ())
    return BagWriter(
        path,
        definitions,
        compression=recording.compression,
        splitting=recording.splitting,
        caller=caller,
        keep=keep,
    )


def begin_recording(setting: StudySetting, path: Path, caller: str = CALLER) -> BagWriter:
    """Return a writer of a new bag like `build_writer`, after renaming an older recording of this name.

    Call this after all other steps of a start, so that a start that fails does not rename anything.

    Raises:
        BadFile: the older recording cannot be renamed, or the bag cannot be written (`BagNotWritten`).
    """
    try:
        moved = make_room(path)
    except OSError as error:
        problem = f"the bag cannot be written ({reason_of(error)})"
        raise BagNotWritten(path, problem, "choose another path, or free disk space") from None
    if moved is not None:
        _log.warning("The older recording was renamed to %s.", moved)
    return build_writer(setting, path, caller)


def message_filter(detail: RecordingDetail, *, errors: bool) -> MessageFilter:
    """Return the filter that selects the recorded messages of a session; `errors` is the study's value."""
    keep: MessageFilter = list if detail is RecordingDetail.ALL else RepetitionFilter()
    return keep if errors else lambda messages: keep(each for each in messages if not is_of_errors(each.topic))


def build_team_description(setting: StudySetting, publisher: TeamPublisher) -> TeamDescription:
    """Return the description of these robots for a ROS graph."""
    rest = {name: value for name, value in tree_of(setting.study).items() if name not in {"robot", "each"}}
    return TeamDescription(
        publisher.topics, setting.map.grid, rest, setting.study.world.footprint, setting.study.external_nodes
    )

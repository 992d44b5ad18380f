"""Builder of a report from the messages of a bag: true and estimated paths, energy, game events, utterances.

Only messages are used, so reports also work for bags of other robots; they list missing data. A recording can contain
several games. Each game has a separate report, because robots, energy and score are reset between games.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.common.grid import OccupancyGrid
from sim.common.robot_numbers import namespace_of, robot_name
from sim.numerics.float_array import FloatArray
from thbridge.analysis.report.batches import MessageBatches
from thbridge.analysis.report.dialogues import DialogueGatherer
from thbridge.analysis.report.game_starts import OF_A_GAME, game_start
from thbridge.analysis.report.report import ObstacleTrack, Report, TimelineEntry, Track
from thbridge.analysis.report.robot_messages import RobotMessages
from thbridge.analysis.report.tracks import FOUND_BY_NAME, SeriesByTopic, TrajectoryTopics
from thbridge.files.errors import BadFile
from thbridge.hunt.codec import from_json
from thbridge.hunt.event_words import event_in_words, kind_in_words
from thbridge.hunt.events import TeamEntry
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.team_words import entry_in_words, seat_of_entry
from thbridge.json_text import json_of
from thbridge.recording.bag.reading.reader import RawMessage, info
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.identification import is_md5
from thbridge.ros.messages.session_records import GameEvent, ScoreRecord, SessionRecord, UtteranceRecord
from thbridge.ros.names import MAP, ROOMS, TEAM, THINGS
from thbridge.ros.robots import usual_first

_TF_OLD = "tf/tfMessage"
"""The older type of tf, with the same fields as tf2's."""


TRAJECTORIES = (types.POSE_STAMPED, types.POSE_WITH_COVARIANCE, types.ODOMETRY)
"""Message types of topics that users can name as trajectories."""


def trajectory_topics(bag: Path, truth: str | None, estimate: str | None) -> TrajectoryTopics:
    """Return the topics that the user names as a robot's trajectories (`--truth`, `--estimate`).

    Raises:
        BadFile: the bag has no such topic, the topic has another type, or the bag cannot be read.
    """
    if truth is None and estimate is None:
        return FOUND_BY_NAME
    kinds = {topic.name: topic.msgtype for topic in info(bag).topics if topic.messages}
    offered = [name for name, msgtype in kinds.items() if msgtype in TRAJECTORIES]
    for option, name in (("--truth", truth), ("--estimate", estimate)):
        if name is None or name in offered:
            continue
        problem = f"the topic is of type {kinds[name]}" if name in kinds else "the bag has no such topic"
        remedy = f"name one of {', '.join(offered)}" if offered else f"name a topic of type {', '.join(TRAJECTORIES)}"
        raise BadFile(bag, f"{name}: {problem}", remedy, key=option)
    return TrajectoryTopics(truth, estimate)


def read_report(
    messages: Iterable[RawMessage], grid: OccupancyGrid | None = None, named: TrajectoryTopics = FOUND_BY_NAME
) -> Report:
    """Return the report of a bag's messages, oldest first; unreadable messages are omitted and listed.

    Args:
        messages: messages of the bag.
        grid: map to use instead of the bag's own.
        named: topics of a robot's trajectories, if the user named them.
    """
    builder = ReportBuilder(named)
    for message in messages:
        builder.take(message)
    return builder.report(grid)


def read_games(
    messages: Iterable[RawMessage], grid: OccupancyGrid | None = None, named: TrajectoryTopics = FOUND_BY_NAME
) -> tuple[Report, ...]:
    """Return the report of each game in a bag, in order, or one report if it has no games. Arguments as `read_report`.

    Messages before the first game belong to the first game. Messages between two games belong to the earlier game.
    """
    return tuple(builder.report(grid) for builder in gather_games(messages, named))


def gather_games(messages: Iterable[RawMessage], named: TrajectoryTopics = FOUND_BY_NAME) -> list["ReportBuilder"]:
    """Gather the data for `read_games`. Gathered data are mostly on disk; a report is in memory."""
    builders = [ReportBuilder(named)]
    for message in messages:
        start = game_start(message)
        if start is not None:
            if builders[-1].has_game:
                builders.append(builders[-1].next_game(start.stamp_ns))
            builders[-1].game = start.number
        former = len(builders) > 1 and message.stamp_ns == builders[-1].first_ns and message.msgtype not in OF_A_GAME
        builders[-2 if former else -1].take(message)
    return builders


class ReportBuilder:
    """Collector of the contents of messages, by type.

    Attributes:
        first_ns: stamp that has the time 0: that of the first message, or that of the beginning of the game.
        game: number of the game that began; None before the first.
    """

    def __init__(self, named: TrajectoryTopics = FOUND_BY_NAME) -> None:
        self.first_ns: int | None = None
        self.game: int | None = None
        self._begins = 0.0
        self._last_ns = 0
        self._series = SeriesByTopic(named)
        self._session: SessionRecord | None = None
        self._grids: dict[str, OccupancyGrid] = {}
        self._scores: list[tuple[float, ScoreRecord]] = []
        self._events: list[tuple[float, GameEvent]] = []
        self._utterances: list[tuple[float, UtteranceRecord]] = []
        self._timeline: list[TimelineEntry] = []
        self._team: list[tuple[float, TeamEntry]] = []
        self._inputs = 0
        self._outlines: defaultdict[str, list[FloatArray]] = defaultdict(list)
        self._rooms = RoomNames()
        self._dialogues = DialogueGatherer()
        self._unread: dict[str, str] = {}
        self._batches = MessageBatches(self._series, self._unread, self._seconds_of)
        self._handlers: dict[str, Callable[[float, str, bytes], None]] = {
            **RobotMessages(self._series, self._seconds).handlers,
            types.OCCUPANCY_GRID: self._map,
            types.SESSION: self._take_session,
            types.SCORE: self._take_score,
            types.MARKER_ARRAY: self._things,
            types.GAME_EVENT: self._event,
            types.UTTERANCE: self._utterance,
            types.DIALOGUE_MOVE: self._dialogue_move,
            types.DIALOGUE_STATE: self._dialogue_state,
            types.INPUT: self._input,
        }

    @property
    def has_game(self) -> bool:
        """True if a game began, or if a game was already running when the recording began."""
        return self.game is not None or bool(self._scores)

    def next_game(self, begins_ns: int) -> "ReportBuilder":
        """Return the builder of the next game. Copy the session, map and rooms, because they are recorded only once."""
        builder = ReportBuilder(self._series.named)
        builder.first_ns = builder._last_ns = begins_ns
        builder._begins = self._begins + self._seconds(begins_ns)
        builder._session, builder._grids, builder._rooms = self._session, self._grids, self._rooms
        return builder

    def _seconds(self, stamp_ns: int) -> float:
        """Return the time of a stamp in seconds of the report."""
        return 0.0 if self.first_ns is None else (stamp_ns - self.first_ns) / 1e9

    def _seconds_of(self, stamps_ns: NDArray[np.int64]) -> FloatArray:
        """Return the times of stamps in seconds of the report."""
        seconds: FloatArray = (stamps_ns - (self.first_ns or 0)) / 1e9
        return seconds

    def take(self, message: RawMessage) -> None:
        """Add a message."""
        if self.first_ns is None:
            self.first_ns = message.stamp_ns
        self._last_ns = max(self._last_ns, message.stamp_ns)
        msgtype = types.TFMESSAGE if message.msgtype == _TF_OLD else message.msgtype
        handler = self._handlers.get(msgtype)
        if handler is None and not self._batches.takes(msgtype):
            return
        if message.md5 != types.plain_definition(msgtype).md5 and is_md5(message.md5):
            self._unread[message.topic] = f"{message.topic} contains {message.msgtype} of another version"
            return
        if handler is None:
            self._batches.add(message.stamp_ns, message.topic, msgtype, message.data)
            return
        try:
            handler(self._seconds(message.stamp_ns), message.topic, message.data)
        except ValueError as error:
            self._unread[message.topic] = f"{message.topic} contains a message that cannot be read: {error}"

    def report(self, grid: OccupancyGrid | None) -> Report:
        """Return the report; `grid`, if given, replaces the bag's own map."""
        duration = self._seconds(self._last_ns)
        self._batches.flush()
        tracks = self._series.thinned_tracks(duration)
        left_out = (*self._series.left_out_sentences(), *(fault for track in tracks for fault in track.faults))
        grid = grid or next((self._grids[name] for name in usual_first(self._grids, (MAP.strip("/"),))), None)
        return Report(
            duration,
            self._session,
            grid,
            tracks,
            tuple(_thing(name, outlines) for name, outlines in self._outlines.items()),
            tuple(self._timeline),
            self._scores[-1][1] if self._scores else None,
            self._inputs,
            (*self._unread.values(), *left_out, *self._missing(tracks, grid)),
            self.game,
            self._begins,
            self._rooms,
            self._dialogues.dialogues(),
            left_out,
            tuple(self._events),
            tuple(self._utterances),
            tuple(self._scores),
            tuple(self._team),
        )

    def _missing(self, tracks: tuple[Track, ...], grid: OccupancyGrid | None) -> Iterable[str]:
        if grid is None:
            yield "No map: no messages on /map (nav_msgs/OccupancyGrid)."
        if not tracks:
            yield "No robots: no topic of type nav_msgs/Odometry, and no odom frame in /tf."

        def without(part: Callable[[Track], FloatArray]) -> str:
            return ", ".join(track.label for track in tracks if not len(part(track)))

        if names := without(lambda track: track.truth):
            yield f"No true path of {names}: no topic base_pose_ground_truth, and no other known name for true poses."
        if names := without(lambda track: track.estimate):
            yield f"No estimated path of {names}: neither map -> odom in /tf nor a topic amcl_pose."
        if names := without(lambda track: track.energy):
            yield f"No energy of {names}: no topic of type sensor_msgs/BatteryState."
        if not self._timeline:
            yield "No events and no utterances: neither /hunt/events nor /dialogue/utterances."
        if not self._scores:
            yield "No score: no messages on /hunt/score."

    def _map(self, time: float, topic: str, data: bytes) -> None:
        if "costmap" not in topic:
            self._grids[topic] = unpack.occupancy_grid(data)

    def _things(self, time: float, topic: str, data: bytes) -> None:
        if topic == THINGS:
            for name, outline in unpack.outlines(data):
                if len(self._series.plausible(topic, outline)) == len(outline):
                    self._outlines[name].append(outline)
        elif topic == ROOMS:
            self._rooms = RoomNames.of(unpack.room_labels(data).items())

    def _take_session(self, time: float, topic: str, data: bytes) -> None:
        self._session = unpack.session(data)

    def _take_score(self, time: float, topic: str, data: bytes) -> None:
        self._scores.append((time, unpack.score(data)))

    def _event(self, time: float, topic: str, data: bytes) -> None:
        event = unpack.game_event(data)
        if topic == TEAM:
            entry = from_json(event.json)
            if isinstance(entry, TeamEntry):
                self._team.append((time, entry))
                what, text = kind_in_words(event.kind), entry_in_words(entry, self._rooms)
                self._timeline.append(TimelineEntry(time, what, seat_of_entry(entry), event.room, text))
            return
        self._events.append((time, event))
        who = "" if event.robot is None else robot_name(event.robot)
        if event.kind == "carried" and event.robot is not None:
            self._series.carried[namespace_of(event.robot)].append(time)
        text, points = _event_text(event)
        self._timeline.append(TimelineEntry(time, kind_in_words(event.kind), who, event.room, text, points))

    def _utterance(self, time: float, topic: str, data: bytes) -> None:
        message: UtteranceRecord = unpack.utterance(data)
        self._dialogues.take_utterance(message)
        self._utterances.append((time, message))
        robot = robot_name(message.robot)
        who = robot if message.speaker == "robot" else f"{message.seat or 'participant'} to {robot}"
        who += " (researcher)" if message.is_by_wizard else ""
        self._timeline.append(TimelineEntry(time, "said", who, message.room, message.text or message.move))

    def _dialogue_move(self, time: float, topic: str, data: bytes) -> None:
        move = unpack.dialogue_move(data)
        self._dialogues.take_move(time, move)
        if move.heard:
            self._timeline.append(TimelineEntry(time, "misheard", robot_name(move.robot), None, f"“{move.heard}”"))
        if move.fault and not move.is_booked:
            self._timeline.append(TimelineEntry(time, "strategy failed", robot_name(move.robot), None, move.fault))

    def _dialogue_state(self, time: float, topic: str, data: bytes) -> None:
        self._dialogues.take_state(unpack.dialogue_state(data))

    def _input(self, time: float, topic: str, data: bytes) -> None:
        self._inputs += unpack.outside_input(data).kind in {"said", "received", "asked"}


def _thing(name: str, outlines: list[FloatArray]) -> ObstacleTrack:
    middles = np.array([(outline[:-1] if len(outline) > 1 else outline).mean(axis=0) for outline in outlines])
    moved = np.hypot(*np.diff(middles, axis=0).T) > 0.0
    return ObstacleTrack(name, outlines[0], middles[np.concatenate(([True], moved))])


def _event_text(event: GameEvent) -> tuple[str, int | None]:
    """Return an event's simple JSON values as text for people, and its points."""
    try:
        fields = json_of(event.json)
    except ValueError:
        return event.json, None
    if not isinstance(fields, dict):
        return event.json, None
    points = fields.get("points")
    return event_in_words(event.kind, fields, besides="points"), points if isinstance(points, int) else None

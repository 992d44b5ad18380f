"""Recordings, which can be read as tables and messages, replayed, and compared."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from pathlib import Path
from typing import cast

import pyarrow as pa
from rosbags.typesys.msg import normalize_msgtype
from rosbags.typesys.store import Typestore

from thbridge.analysis.comparison import figures_of
from thbridge.analysis.export.bag_rows import rows_of_bag
from thbridge.analysis.export.exporting import ExportSummary, table_name
from thbridge.analysis.report.builder import read_games
from thbridge.api.errors import HuntError, as_hunt_errors
from thbridge.api.session import with_strategy
from thbridge.api.study import HuntStudy, Simulated, StudyValue, setting_of
from thbridge.app.replay.replay import Difference, RecordingReplay, ReplayOptions, recorded_study, session_of
from thbridge.files.tables.table_files import Array, arrow_table
from thbridge.recording.bag.damage import damage_as_bad_file
from thbridge.recording.bag.reading.reader import info, messages, recorded
from thbridge.recording.bag.recording_names import problem_of
from thbridge.ros.messages.foreign_types import check_type_name, store_of, types_in


@dataclass(frozen=True, slots=True)
class HuntReplay:
    """Result of a replay.

    Attributes:
        equal: True if all messages are identical, bit for bit.
        ticks: number of ticks of the replay.
        messages: number of equal messages.
        difference: a sentence about the first message that differs; None if all messages are equal.
        recording: the new recording, if one was requested.
    """

    equal: bool
    ticks: int
    messages: int
    difference: str | None
    recording: "HuntRecording | None"


class HuntRecording:
    """Recording of a session or of any ROS 1 robot; the data are read on demand.

    Args:
        path: path of the bag, or the common part of the paths of a split bag.
        beside: folder to which paths in the recorded study are relative.

    Raises:
        HuntError: the bag cannot be read. All methods and properties can raise this error, too.
    """

    def __init__(self, path: str | Path, beside: str | Path = ".") -> None:
        self.path = Path(path)
        self._beside = Path(beside)
        with as_hunt_errors():
            self._info = info(self.path)

    @property
    def seconds(self) -> float:
        """Seconds from the first message to the last message."""
        return self._info.duration

    @property
    def topics(self) -> Mapping[str, int]:
        """Number of messages of each topic, by topic name."""
        return {topic.name: topic.messages for topic in self._info.topics}

    @cached_property
    def study(self) -> HuntStudy:
        """The recorded study; it exists only in recordings by thbridge."""
        with as_hunt_errors():
            return HuntStudy._of(recorded_study(self.path, session_of(self.path)), self._beside)

    @property
    def participant(self) -> str:
        """Participant of a recording by thbridge: "person", the name of a strategy, or "program".

        The text is empty if the participant's program connected from outside.
        """
        with as_hunt_errors():
            return session_of(self.path).participant

    def table(self, name: str) -> pa.Table:
        """Return a table as `thbridge bag export` writes it, with one row per message.

        The column `t_s` has seconds from the beginning.

        Args:
            name: a topic, such as "/robot1/odom", or the name of a table, such as "poses" (true and estimated poses of
                all robots), "dialogues", or `TOPIC.FIELD` for lists in messages.
        """
        topics = self.topics
        if name.startswith("/") and name not in topics:
            raise HuntError(f"{self.path}: no topic is called {name}. Topics: {', '.join(topics)}.", self.path)
        wanted = table_name(name) if name.startswith("/") else name
        with as_hunt_errors():
            only = {name} if name.startswith("/") else None
            rows = rows_of_bag(self.path, ExportSummary(), only, tables={wanted.partition(".")[0]})
            pieces = [arrow_table(each.table.columns, each.values) for each in rows if each.table.name == wanted]
        if not pieces:
            problem = f"{self.path}: no table is called {name}"
            raise HuntError(f"{problem}. Give a topic ({', '.join(topics)}), poses or dialogues.", self.path)
        return pa.concat_tables(pieces)

    def arrays(self, name: str) -> dict[str, Array]:
        """Return the columns of a table as arrays, by name of the column; see `table`.

        Columns of texts or lists are arrays of objects.
        """
        table = self.table(name)
        return {column: table[column].to_numpy() for column in table.column_names}

    def messages(self, *topics: str) -> Iterator[tuple[float, str, Mapping[str, object]]]:
        """Yield the messages, oldest first, as (seconds from the beginning, topic, fields by their ROS names).

        Args:
            topics: names of topics. If none is given, all topics are read.
        """
        stores: dict[tuple[str, str], Typestore] = {}
        start_ns = self._info.start_ns or 0
        with as_hunt_errors():
            for publisher, stamp_ns, data in recorded(self.path, topics or None):
                key = publisher.msgtype, publisher.md5
                name = normalize_msgtype(publisher.msgtype)
                if key not in stores:
                    stores[key] = _store(publisher.definition, name, publisher.topic)
                with damage_as_bad_file(self.path):
                    message: object = stores[key].deserialize_ros1(data, name)
                yield (stamp_ns - start_ns) / 1e9, publisher.topic, cast(Mapping[str, object], _plain(message))

    def replay(
        self,
        changes: Mapping[str, StudyValue] | None = None,
        participant: Simulated | None = None,
        to: str | Path | None = None,
    ) -> HuntReplay:
        """Replay a recording by thbridge. The same inputs must give the same messages.

        Args:
            changes: changed values of the study, by dotted key, for what-if runs.
            participant: name of a simulated participant that replaces the recorded participant.
            to: path of the new recording. If None, nothing is recorded.

        A replay without changes stops at the first difference, unless `to` is given.
        """
        study, bag = self.study.changed(changes) if changes else self.study, None if to is None else Path(to)
        setting = setting_of(study) if participant is None else with_strategy(setting_of(study), participant)
        if bag is not None and (problem := problem_of(bag, setting.study.recording.compression)) is not None:
            raise HuntError(f"to: {problem}", bag)
        if bag is not None and bag.resolve() == self.path.resolve():
            raise HuntError(f"to: {bag} is the recording itself. Give another path.", bag)
        if participant is not None and not self.participant:
            raise HuntError(f"participant: {self.path} has no participant to replace. Omit the argument.")
        options = ReplayOptions(0.0, 0.0, bag, bool(changes or participant or bag), participant)
        with as_hunt_errors():
            with RecordingReplay(self.path, setting, options, lambda record: None) as again:
                while again.tick():
                    pass
            done = again.result(0.0)
        difference = None if done.difference is None else _sentence(done.difference)
        made = None if bag is None else HuntRecording(bag, self._beside)
        return HuntReplay(done.difference is None, done.ticks, done.messages, difference, made)

    def figures(self) -> pa.Table:
        """Return a table for the comparison of runs: score, estimation errors, distance driven, and arrivals.

        The table has one row per game and robot.
        """
        with as_hunt_errors():
            games = [figures_of(report) for report in read_games(messages(self.path))]
        rows = [
            {
                "game": run.game,
                "seconds": run.seconds,
                "score": run.score,
                "rooms_visited": run.rooms_visited,
                "robot": robot.name,
                "error_mean_m": robot.error_mean,
                "error_95_m": robot.error_95,
                "distance_m": robot.distance,
                "arrivals": len(robot.arrivals),
                "energy": robot.energy,
            }
            for run in games
            for robot in run.robots
        ]
        return pa.Table.from_pylist(rows)

    def __repr__(self) -> str:
        count = sum(self.topics.values())  # of integers
        return f"<HuntRecording {self.path}, {self.seconds:.1f} s, {count} messages of {len(self.topics)} topics>"


def _store(definition: str, name: str, topic: str) -> Typestore:
    try:
        check_type_name(name)
        return store_of(types_in(name, definition) if definition.strip() else {name: ([], [])})
    except ValueError as error:
        raise HuntError(f"{topic}: {error}. Omit this topic.") from None


def _plain(value: object) -> object:
    """Convert a message into mappings, lists, arrays, numbers and texts."""
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if not field.name.startswith("__")]
        return {name: _plain(cast(object, getattr(value, name))) for name in names}
    if isinstance(value, list):
        return [_plain(item) for item in cast(list[object], value)]
    return value


def _sentence(difference: Difference) -> str:
    place = f"message {difference.number}, number {difference.topic_number} on {difference.topic}"
    changed = "; ".join(f"{each.field} was {each.was} and is {each.now}" for each in difference.fields[:3])
    return f"{place}, at {difference.seconds:.2f} s: {difference.what}{f' ({changed})' if changed else ''}."

"""Records a session: killed at any moment, a recording loses no more than its last second."""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

from rosbags.interfaces import Connection
from rosbags.typesys.msg import normalize_msgtype

from sim.grid import OccupancyGrid
from sim.observations import LaserMount
from sim.team import TeamSnapshot
from thbridge.adapters.bag_file import BagFile
from thbridge.adapters.errors import BadFile
from thbridge.adapters.ros_definitions import Definitions
from thbridge.ros.names import CALLER
from thbridge.ros.publisher import Message, Publisher, Topic
from thbridge.ros.records import Record, Session

SYNC_SECONDS = 1.0
"""Wall time after which everything said so far is forced onto the disk."""

ACTIVE = ".active"
"""Ending of a bag that is being written, after rosbag's custom."""


class BagNotWritten(BadFile):
    """A recording could not begin or go on; the message says what is kept, and where."""

    def __init__(self, path: Path, problem: str, remedy: str) -> None:
        super().__init__(path, None, None, problem, remedy)

    def __reduce__(self) -> tuple[type["BagNotWritten"], tuple[Path, str, str]]:  # type: ignore[override]  # fewer parts
        return (type(self), (self.path, self.problem, self.remedy))


class BagWriter:
    """Writes messages into `PATH.active` and, closed, leaves them in `PATH`.

    Use it as a context manager: however its block is left, the bag is complete. Equal messages give equal bytes.

    Args:
        path: of the finished bag, customarily `*.bag`.
        definitions: of message types; None takes them from an installed ROS, where there is one.
        overwrite: whether a bag of this name, finished or cut off, may go.
        clock: seconds that never go back; says when to force the file onto the disk.

    Raises:
        BagNotWritten: there is such a bag, or the folder cannot be written to.
    """

    def __init__(
        self,
        path: Path,
        definitions: Definitions | None = None,
        overwrite: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.path = path
        self.active = path.with_name(path.name + ACTIVE)
        self._definitions = definitions or Definitions()
        self._overwrite = overwrite
        self._clock = clock
        self._connections: dict[Topic, Connection] = {}
        self._stamp_ns: int | None = None
        self._open = True
        try:
            self._make_room()
            self._file = BagFile(self.active)
            self._file.open()
        except OSError as error:
            raise BagNotWritten(path, _reason(error), "name a folder that exists and may be written to") from error
        self._synced = clock()

    def write(self, message: Message) -> None:
        """Write one message; its topic is registered with its first.

        Raises:
            BagNotWritten: the disk is full or gone; the bag is closed, and what it held is kept.
            ValueError: the message is older than the last one, or the bag is closed.
        """
        if not self._open:
            raise ValueError(f"{self.path} is closed")
        if self._stamp_ns is not None and message.stamp_ns < self._stamp_ns:
            raise ValueError(f"a message at {message.stamp_ns} ns after one at {self._stamp_ns} ns")
        connection = self._connections.get(message.topic) or self._connect(message.topic)
        try:
            self._file.write(connection, message.stamp_ns, message.data)
        except OSError as error:
            raise self._saved(error) from error
        self._stamp_ns = message.stamp_ns

    def sync_if_due(self) -> None:
        """Once a second of wall time, force everything onto the disk; to be called at least as often.

        Raises:
            BagNotWritten: the disk is full or the file was deleted.
        """
        if not self._open or self._clock() - self._synced < SYNC_SECONDS:
            return
        with self._keeping():
            self._file.sync()
        self._synced = self._clock()

    def close(self) -> None:
        """Complete the bag and give it its name; closing again does nothing.

        Raises:
            BagNotWritten: the disk is full or gone.
        """
        if not self._open:
            return
        with self._keeping():
            self._file.close()
            self._open = False
            self._rename()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def _make_room(self) -> None:
        if self._overwrite:
            self.active.unlink(missing_ok=True)
        elif self.path.exists():
            raise BagNotWritten(self.path, "there is such a file already", "choose another name, or allow overwriting")
        elif self.active.exists():
            raise BagNotWritten(
                self.active,
                "a recording of this name is being written, or was cut off",
                f"save it with `thbridge bag reindex {self.active}`, choose another name, or allow overwriting",
            )

    def _connect(self, topic: Topic) -> Connection:
        definition = self._definitions.of(topic.msgtype)
        connection = self._file.add_connection(
            topic.name,
            normalize_msgtype(topic.msgtype),
            msgdef=definition.text,
            md5sum=definition.md5,
            callerid=CALLER,
            latching=int(topic.latched),
        )
        self._connections[topic] = connection
        return connection

    def _rename(self) -> None:
        if not self._overwrite and self.path.exists():
            raise FileExistsError(f"{self.path} has appeared meanwhile")
        self.active.replace(self.path)

    @contextmanager
    def _keeping(self) -> Iterator[None]:
        """Turn an OSError into words, after saving what can be saved."""
        try:
            yield
        except OSError as error:
            raise self._saved(error) from error

    def _saved(self, error: OSError) -> BagNotWritten:
        try:
            if self._open:
                self._file.close()
            self._open = False
            self._rename()
        except OSError:
            self._open = False
            self._file.abort()
            if not self.active.exists():
                return BagNotWritten(self.path, _reason(error), "record again, into a folder that stays")
            remedy = f"it holds all but the last second: make room, then run `thbridge bag reindex {self.active}`"
            return BagNotWritten(self.active, _reason(error), remedy)
        return BagNotWritten(
            self.path, _reason(error), "it holds all but the last second; make room before recording again"
        )


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


class Recorder:
    """Records a team: its robots tick by tick, and the game, the talk and the inputs that go with them.

    The session is the bag's first record, the map and the frames that never move follow.

    Args:
        writer: an empty bag; the recorder closes it.
        publisher: of the same team.
        session: what it takes to run this session again.
        grid: the map.
    """

    def __init__(self, writer: BagWriter, publisher: Publisher, session: Session, grid: OccupancyGrid) -> None:
        self._writer = writer
        self._publisher = publisher
        for message in publisher.opening(0, session, grid):
            writer.write(message)

    @classmethod
    def open(
        cls,
        path: Path,
        session: Session,
        grid: OccupancyGrid,
        robots: int,
        mount: LaserMount,
        scan_period: float,
        overwrite: bool = False,
    ) -> Self:
        """A recorder into a new bag; see `BagWriter` and `Publisher` for the arguments and what is raised."""
        return cls(BagWriter(path, overwrite=overwrite), Publisher(robots, mount, scan_period), session, grid)

    def record(self, snapshot: TeamSnapshot, records: Iterable[Record] = ()) -> None:
        """Write down one tick. Ticks come in order, from 0 on.

        Raises:
            BagNotWritten: the disk is full or gone; the bag is closed, and what it held is kept.
        """
        for message in self._publisher.tick(snapshot, records):
            self._writer.write(message)
        self._writer.sync_if_due()

    def close(self) -> None:
        """Complete the bag and give it its name; closing again does nothing. Raises BagNotWritten."""
        self._writer.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

"""File with the trips of a stopped measurement, next to its result. With this file, another run can resume."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

import msgspec

from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile, reason_of
from thbridge.hunt.rooms import Room
from thbridge.offline.measure import MeasurementSetup, RoomTrip, TripResult
from thbridge.recording.append import append_whole

LAYOUT = 1
SUFFIX = ".trips"
_LARGEST = 1 << 28
_REMEDY = "Choose another file with --out, or free some space"


class _Head(msgspec.Struct):
    """First line of the file: digest of all values that the trips depend on."""

    layout: int
    digest: str


class _Line(msgspec.Struct):
    """Line of the file, with the result of a trip. Room numbers start at 1. Number 0 is the corridor."""

    start: int
    goal: int
    run: int
    seconds: float | None
    refusal: str | None


def kept_path(result: Path) -> Path:
    """Return the path of the file with the trips for a result."""
    return result.with_name(f"{result.name}{SUFFIX}")


def digest_of(course: MeasurementSetup, versions: Mapping[str, str]) -> str:
    """Return a digest of all values that trips depend on: map, world, robot, seed, and versions of programs."""
    place = course.place
    grid = place.grid
    depends = (
        grid.cells.shape,
        hashlib.sha256(grid.cells.tobytes()).hexdigest(),
        grid.resolution,
        grid.origin,
        [(entry.room.people, entry.goal) for entry in place.rooms],
        place.starts,
        course.world,
        course.robot,
        course.seed,
        sorted(versions.items()),
    )
    return hashlib.sha256(repr(depends).encode()).hexdigest()


class KeptTrips:
    """The trips of an unfinished measurement. Leaving the context closes the file.

    Args:
        result: file of the measurement's result.
        digest: digest of all values that the trips depend on. Trips with another digest are dropped.

    Attributes:
        done: the finished trips.
        dropped: True if trips with another map or other settings were dropped.

    Raises:
        BadFile: the file cannot be read or written.
    """

    def __init__(self, result: Path, digest: str) -> None:
        self.path = kept_path(result)
        self.done: dict[RoomTrip, TripResult] = {}
        head = msgspec.json.encode(_Head(LAYOUT, digest)) + b"\n"
        try:
            text = self._read()
            self.dropped = bool(text) and not text.startswith(head)
            file = own_target(self.path)
            self._file = file.open("wb" if self.dropped else "ab", buffering=0)
            if not text or self.dropped:
                append_whole(self._file, head, synced=False)
                return
            # A killed program left an incomplete last line. End this line; readers skip it.
            if not text.endswith(b"\n"):
                append_whole(self._file, b"\n", synced=False)
            kept = (_trip_in(line) for line in text[len(head) :].splitlines())
            self.done = {result.trip: result for result in kept if result is not None}
        except OSError as error:
            raise self._unusable(error) from None

    def add(self, result: TripResult) -> None:
        """Add a trip to the file. Raise BadFile if the file cannot be written."""
        trip = result.trip
        line = _Line(trip.start.people, trip.goal.people, trip.run, result.seconds, result.refusal)
        try:
            append_whole(self._file, msgspec.json.encode(line) + b"\n", synced=False)
        except OSError as error:
            raise self._unusable(error) from None
        self.done[trip] = result

    def __enter__(self) -> "KeptTrips":
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        self._file.close()
        if not self.done:
            self.path.unlink(missing_ok=True)

    def _read(self) -> bytes:
        try:
            return content_of(self.path, _LARGEST)
        except FileNotFoundError:
            return b""

    def _unusable(self, error: OSError) -> BadFile:
        return BadFile(self.path, f"it cannot be written ({reason_of(error)})", _REMEDY)


def _trip_in(line: bytes) -> TripResult | None:
    """Return the trip in a line, or None if the line is incomplete or damaged."""
    try:
        read = msgspec.json.decode(line, type=_Line)
        trip = RoomTrip(Room(read.start), Room(read.goal), read.run)
    except (msgspec.MsgspecError, RecursionError, ValueError):
        return None
    return TripResult(trip, read.seconds, read.refusal)

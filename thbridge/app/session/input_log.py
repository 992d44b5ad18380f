"""Log of a game's inputs, with which a game resumes after a crash of its program.

The effects of an input can be computed again, so only the inputs must not be lost. Each input is on the disk before any
message of its tick is sent. To resume a game, the program runs the game again from its study with the logged inputs, as
fast as possible, up to the last logged tick.

The first line of the file identifies the game. There are further lines for each tick with inputs, events or utterances,
for each tick that took long, and for each second of simulated time. A line for a second contains a digest of the
robots' poses and the score, so differences from the first run are noticed. Each line contains the real time of its
tick, on which games do not depend. If the program dies while it writes the last line, this incomplete line is dropped.
"""

import fcntl
import hashlib
import json
import os
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from sim.common.observations import TICKS_PER_SECOND
from thbridge.app.session import inputs
from thbridge.app.session.input_records import from_record, to_record
from thbridge.app.session.session import TickRecord
from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.synced import make_folder, sync_folder
from thbridge.files.errors import BadFile
from thbridge.json_text import json_of
from thbridge.recording.append import append_whole
from thbridge.ros.messages.session_records import InputRecord, SessionRecord
from thbridge.timing.pace_meter import LATE, PaceMeter, PaceState
from thbridge.timing.pacer import Pacer

_MACHINE_KEYS = ("libc", "processor", "compiler", "architecture")
"""Beginnings of the keys that describe the machine in a session record. Games are equal on all machines."""


class GameDiffers(BadFile):
    """Error: the inputs of a log do not lead to the game for which the log was written."""


@dataclass(frozen=True, slots=True)
class LoggedTick:
    """Tick of the log.

    Attributes:
        tick: number of the tick.
        inputs: inputs that acted in the tick, in order.
        digest: digest of poses and score after the tick; empty if the line has no digest.
        pace: real time up to the tick; None in logs of earlier releases, and after the end of the game.
    """

    tick: int
    inputs: tuple[inputs.Input, ...]
    digest: str = ""
    pace: PaceState | None = None


class InputLog:
    """Log of inputs, open for appending; the docstring of the module describes the format.

    Args:
        path: path of the file. If the file does not exist or has no complete line, a new log begins.
        record: session record of the game.
        meter: meter of the real time of ticks, which continues from the end of the log.
        pacer: pacer of the session.

    Attributes:
        ticks: the ticks in the log when it was opened, oldest first.

    Raises:
        BadFile: the file cannot be read or written, or another program is writing it.
        GameDiffers: the log belongs to another game, or to another release.
    """

    def __init__(self, path: Path, record: SessionRecord, meter: PaceMeter, pacer: Pacer) -> None:
        self._path, self._meter, self._pacer = path, meter, pacer
        self._over = False
        self._size = 0
        try:
            make_folder(path.parent)
            self._file = own_target(path).open("a+b", buffering=0)
            with ExitStack() as opened:
                opened.callback(self._file.close)
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                self.ticks = self._read_or_begin(_line({"game": _fingerprint(record)}))
                opened.pop_all()
        except BlockingIOError:
            raise BadFile(path, "another program is running this game", "stop that program first") from None
        except OSError as error:
            raise BadFile(
                path, f"the file cannot be written ({error.strerror})", "check the disk and the permissions"
            ) from None
        self._last = -1
        self._digests: dict[int, str] = {}
        self._go_on()

    def record(self, record: TickRecord) -> None:
        """Record a tick, see `TickRecorder`. A tick that is already in the log is only compared with the log.

        Raises:
            BadFile: the file cannot be written.
            GameDiffers: the tick differs from the logged tick.
        """
        digest = _digest(record) if record.tick % TICKS_PER_SECOND == 0 else ""
        was_over, self._over = self._over, record.game is not None and record.game.ended is not None
        if record.tick <= self._last:
            if digest and self._digests.get(record.tick, digest) != digest:
                raise self._differs(
                    f"at {record.tick // TICKS_PER_SECOND} s, robots have other poses than in the first run"
                )
            return
        # After the end of a game, real time does not count, because people look at the result for an arbitrary time.
        pace = None if was_over and self._over else self._meter.measure(record.tick, self._pacer)
        worth_noting = pace is not None and (record.events or record.utterances or pace.step > LATE)
        if not record.inputs and not digest and not worth_noting:
            return
        given = [[each.kind, each.json] for each in map(to_record, record.inputs)]
        line: dict[str, object] = {"tick": record.tick, "inputs": given, "digest": digest}
        if pace is not None:
            self._meter.keep()
            line["pace"] = pace.rounded()
        try:
            content = _line(line)
            append_whole(self._file, content, synced=bool(given))
            self._size += len(content)
        except OSError as error:
            problem = f"the file cannot be written ({error.strerror})"
            raise BadFile(self._path, problem, "free space on the disk") from None

    def reread(self) -> Sequence[LoggedTick]:
        """Return the ticks that another process has logged since this process was copied from it.

        Raises:
            BadFile: the file cannot be read.
        """
        try:
            self._file.seek(self._size)
            self.ticks = [self._read(0, line) for line in self._whole_lines()]
        except OSError as error:
            raise BadFile(self._path, f"the file cannot be read ({error.strerror})", "check the disk") from None
        self._go_on()
        return self.ticks

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _go_on(self) -> None:
        """Prepare for the ticks of the log, which are run again, and for the ticks after them."""
        if self.ticks:
            self._last = self.ticks[-1].tick
        self._digests = {logged.tick: logged.digest for logged in self.ticks if logged.digest}
        self._meter.go_on((logged.tick, logged.pace) for logged in self.ticks if logged.pace is not None)

    def _whole_lines(self) -> Sequence[bytes]:
        """Read the rest of the file, and drop an incomplete last line."""
        content = self._file.read()
        whole = content[: content.rfind(b"\n") + 1]
        self._size += len(whole)
        self._file.truncate(self._size)
        self._file.seek(0, os.SEEK_END)
        return whole.splitlines(keepends=True)

    def _read_or_begin(self, first: bytes) -> Sequence[LoggedTick]:
        """Read the log and drop an incomplete last line; if there is no log, write the first line."""
        self._file.seek(0)
        lines = self._whole_lines()
        if not lines:
            append_whole(self._file, first, synced=True)
            self._size = len(first)
            sync_folder(self._path.parent)
            return ()
        if lines[0] != first:
            raise self._differs("the log belongs to another study or to another release of the program")
        return [self._read(number, line) for number, line in enumerate(lines[1:], 2)]

    def _read(self, number: int, line: bytes) -> LoggedTick:
        try:
            logged = json_of(line)
            given = [from_record(InputRecord(kind, "", "", text)) for kind, text in logged["inputs"]]
            pace = PaceState(*map(float, logged["pace"])) if "pace" in logged else None
            return LoggedTick(logged["tick"], tuple(given), logged["digest"], pace)
        except (ValueError, KeyError, TypeError):
            remedy = "Move the file away; then the game starts from the beginning"
            raise BadFile(self._path, "this line is damaged", remedy, line=number) from None

    def _differs(self, problem: str) -> GameDiffers:
        return GameDiffers(self._path, problem, "Move the file away; then the game starts from the beginning")


def _fingerprint(record: SessionRecord) -> str:
    versions = {name: text for name, text in record.versions.items() if not name.startswith(_MACHINE_KEYS)}
    facts = [record.study, record.seed, sorted(versions.items()), record.program, record.roles, record.participant]
    return hashlib.blake2b(json.dumps(facts).encode(), digest_size=16).hexdigest()


def _digest(record: TickRecord) -> str:
    poses = b"" if record.snapshot is None else record.snapshot.truth.poses.tobytes()
    score = None if record.game is None else record.game.score
    return hashlib.blake2b(poses + f"{score}".encode(), digest_size=8).hexdigest()


def _line(fields: dict[str, object]) -> bytes:
    return json.dumps(fields, separators=(",", ":")).encode() + b"\n"

"""MAVLink FTP server of a vehicle, with read-only files.

Source: the MAVLink developer guide, "File Transfer Protocol (FTP)".
Differences:

* A session belongs to the station that opened it, so that stations cannot close or read each other's sessions. The
  station chooses the number of its session, because MAVProxy identifies its transfers by this number, and MAVSDK
  accepts no other number.
* A station may choose the number of an open session, because a request to close a session may be lost. The
  station gets this number if the open file was read to its end, is the requested file, or was not read for some time.
  Otherwise the answer is that no session is free.
* Requests to all vehicles at once are ignored. A file belongs to one vehicle, and bursts of all vehicles would flood
  the link.
* The last piece of a file ends its burst, and no EOF follows. If MAVSDK missed the last piece, it would treat an EOF as
  a failure.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from struct import Struct
from typing import TypeAlias

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.vehicle_interface import RobotReadings, Station
from thbridge.mavlink.vehicle.component_files.metadata_files import checksum
from thbridge.mavlink.wire.dialect import BROADCAST, Message, mav
from thbridge.mavlink.wire.outgoing import LinkId, OutgoingMessage

PIECES_PER_TICK = 3
"""Number of pieces that all bursts of one vehicle together send per tick. This is 36 kB per second."""

_HEAD = Struct("<HBBBBBxI")
"""Header: sequence, session, opcode, size of the data, opcode of the request, end of a burst, offset."""

_MOST_DATA = 239
_PAYLOAD = _HEAD.size + _MOST_DATA

_MOST_SESSIONS = 8
"""Maximum number of open sessions of one requester."""

_IDLE = 10 * TICKS_PER_SECOND
"""After this number of ticks, another session may replace an unused session. The station of the unused session may have
disappeared."""

_MOST_REQUESTERS = 32
"""Maximum number of requesters. The requester that has been silent longest is forgotten first."""

_ROOTS = ("", ".")

_WRITING = frozenset(
    {
        mav.MAV_FTP_OPCODE_CREATEFILE,
        mav.MAV_FTP_OPCODE_WRITEFILE,
        mav.MAV_FTP_OPCODE_REMOVEFILE,
        mav.MAV_FTP_OPCODE_CREATEDIRECTORY,
        mav.MAV_FTP_OPCODE_REMOVEDIRECTORY,
        mav.MAV_FTP_OPCODE_OPENFILEWO,
        mav.MAV_FTP_OPCODE_TRUNCATEFILE,
        mav.MAV_FTP_OPCODE_RENAME,
    }
)
"""Opcodes that would change a file."""

_Requester: TypeAlias = tuple[LinkId, Station]
_Transfer: TypeAlias = tuple[_Requester, int]
"""A requester, and the number of its session."""


@dataclass(frozen=True, slots=True)
class _Request:
    """Decoded request.

    Attributes:
        sequence: number of the request. The numbers of the answers follow it.
        session: number of its session.
        opcode: a code of MAV_FTP_OPCODE.
        size: size of the data, or number of requested bytes, depending on the opcode.
        offset: offset into the file, or into the list of a directory.
        data: payload data.
    """

    sequence: int
    session: int
    opcode: int
    size: int
    offset: int
    data: bytes

    @property
    def path(self) -> str:
        """Path of the file or directory, from the root."""
        return self.data[: self.size].partition(b"\0")[0].decode("utf-8", errors="replace").strip("/")

    @property
    def wanted(self) -> int:
        """Number of bytes in a piece of the answer.

        If the size is 0, pieces have the maximum size, because mavros sends 0 in reads. ArduPilot does the same in
        bursts.
        """
        return self.size or _MOST_DATA


@dataclass(frozen=True, slots=True)
class _Refused:
    """Refusal of a request. `error` is a code of MAV_FTP_ERR."""

    error: int


@dataclass(slots=True)
class _Session:
    """Open file.

    Attributes:
        content: content of the file.
        used: tick of its last use.
        is_read: True if its last byte has been sent.
    """

    content: bytes
    used: int
    is_read: bool = False


@dataclass(slots=True)
class _Client:
    """State of a requester.

    Attributes:
        sessions: its open files, by number.
        answered: for each session, the last request that had an immediate answer, and this answer.
    """

    sessions: dict[int, _Session] = field(default_factory=dict)
    answered: dict[int, tuple[bytes, bytes]] = field(default_factory=dict)

    def before(self, session: int, asked: bytes) -> bytes | None:
        """Return the earlier answer if a request is the same as the last request of its session."""
        last, answer = self.answered.get(session, (b"", b""))
        return answer if asked == last else None

    def remember(self, session: int, asked: bytes, answer: bytes | None) -> None:
        """Store the answer to a request. None is for a burst, because a repeated request restarts a burst."""
        self.answered.pop(session, None)
        if answer is not None:
            while len(self.answered) >= _MOST_SESSIONS:
                del self.answered[next(iter(self.answered))]
            self.answered[session] = asked, answer


@dataclass(slots=True)
class _Burst:
    """Transfer of a file to a station, piece by piece.

    Attributes:
        session: session of the transfer.
        offset: offset of the next piece.
        size: size of a piece, bytes.
        sequence: sequence number of the last piece.
    """

    session: _Session
    offset: int
    size: int
    sequence: int


class FileTransfer:
    """File server of one vehicle. It is a `Microservice`.

    Args:
        files: returns the contents by file name. All files are in the root directory.
    """

    def __init__(self, files: Callable[[], Mapping[str, bytes]]) -> None:
        self._files = files
        self._tick = 0
        self._clients: dict[_Requester, _Client] = {}
        # Bursts take turns in this order. After each piece, a burst moves to the end.
        self._bursts: dict[_Transfer, _Burst] = {}

    def handle_message(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Answer a request. A repeated request gets the same answer as before."""
        if not isinstance(message, mav.MAVLink_file_transfer_protocol_message) or message.target_system == BROADCAST:
            return
        asked = bytes(message.payload)
        request = _request_of(asked)
        if request.opcode >= mav.MAV_FTP_OPCODE_ACK:
            # This is an answer. Two servers that reply to each other's answers would never stop.
            return
        requester = link, sender
        client = self._client(requester)
        # The answer may have been lost. If a repeated request were executed again, its answer could be wrong. For
        # example, the second request to close a session would fail.
        answer = client.before(request.session, asked)
        if answer is None:
            answer = self._outcome(requester, client, request)
            client.remember(request.session, asked, answer)
        if answer is not None:
            yield _message(requester, answer)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Send the next pieces of the bursts. The bursts take turns."""
        self._tick = tick
        for _ in range(PIECES_PER_TICK):
            if not self._bursts:
                return
            transfer = next(iter(self._bursts))
            burst = self._bursts.pop(transfer)
            requester, number = transfer
            yield _message(requester, self._piece(burst, number))
            if burst.offset < len(burst.session.content):
                self._bursts[transfer] = burst

    def forget(self, link: LinkId) -> None:
        """Forget a closed link and its requesters."""
        for requester in [known for known in self._clients if known[0] == link]:
            self._dismiss(requester)

    def _client(self, requester: _Requester) -> _Client:
        # The last requester is always at the end, so the first one has the oldest last request.
        client = self._clients.pop(requester, None) or _Client()
        if len(self._clients) >= _MOST_REQUESTERS:
            self._dismiss(next(iter(self._clients)))
        self._clients[requester] = client
        return client

    def _dismiss(self, requester: _Requester) -> None:
        for number in self._clients.pop(requester).sessions:
            self._bursts.pop((requester, number), None)

    def _outcome(self, requester: _Requester, client: _Client, request: _Request) -> bytes | None:
        """Return the answer to a request. Return None for a burst, whose pieces follow in `step`."""
        if request.size > _MOST_DATA:
            return _answer(request, _WRONG_SIZE)
        match request.opcode:
            case mav.MAV_FTP_OPCODE_NONE:
                return _answer(request, b"")
            case mav.MAV_FTP_OPCODE_TERMINATESESSION:
                return _answer(request, self._close(requester, client, request.session))
            case mav.MAV_FTP_OPCODE_RESETSESSION:
                client.answered.clear()
                for number in [*client.sessions]:
                    self._close(requester, client, number)
                return _answer(request, b"")
            case mav.MAV_FTP_OPCODE_LISTDIRECTORY:
                return _answer(request, self._listed(request))
            case mav.MAV_FTP_OPCODE_OPENFILERO:
                return self._open(requester, client, request)
            case mav.MAV_FTP_OPCODE_READFILE:
                return _answer(request, self._read(client, request))
            case mav.MAV_FTP_OPCODE_BURSTREADFILE:
                return self._begin(requester, client, request)
            case mav.MAV_FTP_OPCODE_CALCFILECRC:
                content = self._files().get(request.path)
                return _answer(request, _NOT_FOUND if content is None else checksum(content).to_bytes(4, "little"))
        return _answer(request, _PROTECTED if request.opcode in _WRITING else _UNKNOWN)

    def _open(self, requester: _Requester, client: _Client, request: _Request) -> bytes:
        content = self._files().get(request.path)
        if content is None:
            return _answer(request, _NOT_FOUND)
        sessions = client.sessions
        before = sessions.get(request.session)
        if before is not None and not (before.is_read or before.content == content or self._is_idle(before)):
            return _answer(request, _NO_ROOM)
        if before is None and len(sessions) >= _MOST_SESSIONS:
            idle = next((number for number, open_ in sessions.items() if self._is_idle(open_)), None)
            if idle is None:
                return _answer(request, _NO_ROOM)
            self._close(requester, client, idle)
            client.answered.clear()
        self._close(requester, client, request.session)
        sessions[request.session] = _Session(content, self._tick)
        return _answer(request, len(content).to_bytes(4, "little"))

    def _is_idle(self, session: _Session) -> bool:
        return self._tick - session.used >= _IDLE

    def _close(self, requester: _Requester, client: _Client, number: int) -> bytes | _Refused:
        self._bursts.pop((requester, number), None)
        return _NO_SESSION if client.sessions.pop(number, None) is None else b""

    def _listed(self, request: _Request) -> bytes | _Refused:
        """List files from the requested offset on, up to the maximum size of an answer."""
        if request.path not in _ROOTS:
            return _NOT_FOUND
        entries = [f"F{name}\t{len(content)}\0".encode() for name, content in self._files().items()]
        listed = b""
        for entry in entries[request.offset :]:
            if len(listed) + len(entry) > _MOST_DATA:
                break
            listed += entry
        # In this protocol, EOF in answer to an offset means that the list has no further entries.
        return listed or _END

    def _read(self, client: _Client, request: _Request) -> bytes | _Refused:
        session = self._used(client, request)
        if session is None:
            return _NO_SESSION
        piece = session.content[request.offset : request.offset + request.wanted]
        session.is_read |= request.offset + len(piece) >= len(session.content)
        return piece or _END

    def _begin(self, requester: _Requester, client: _Client, request: _Request) -> bytes | None:
        """Start a burst. It replaces an earlier burst of this session. Its pieces follow in the next ticks."""
        session = self._used(client, request)
        if session is None:
            return _answer(request, _NO_SESSION)
        self._bursts.pop((requester, request.session), None)
        if request.offset >= len(session.content):
            return _answer(request, _END)
        self._bursts[requester, request.session] = _Burst(session, request.offset, request.wanted, request.sequence)
        return None

    def _used(self, client: _Client, request: _Request) -> _Session | None:
        session = client.sessions.get(request.session)
        if session is not None:
            session.used = self._tick
        return session

    def _piece(self, burst: _Burst, number: int) -> bytes:
        """Encode the next piece of a burst, and advance the burst."""
        content, offset = burst.session.content, burst.offset
        data = content[offset : offset + burst.size]
        burst.session.used = self._tick
        burst.sequence = burst.sequence + 1 & 0xFFFF
        burst.offset += len(data)
        burst.session.is_read |= burst.offset >= len(content)
        head = _HEAD.pack(
            burst.sequence,
            number,
            mav.MAV_FTP_OPCODE_ACK,
            len(data),
            mav.MAV_FTP_OPCODE_BURSTREADFILE,
            burst.offset >= len(content),
            offset,
        )
        return head + data


_NOT_FOUND = _Refused(mav.MAV_FTP_ERR_FILENOTFOUND)
_PROTECTED = _Refused(mav.MAV_FTP_ERR_FILEPROTECTED)
_NO_SESSION = _Refused(mav.MAV_FTP_ERR_INVALIDSESSION)
_NO_ROOM = _Refused(mav.MAV_FTP_ERR_NOSESSIONSAVAILABLE)
_WRONG_SIZE = _Refused(mav.MAV_FTP_ERR_INVALIDDATASIZE)
_UNKNOWN = _Refused(mav.MAV_FTP_ERR_UNKNOWNCOMMAND)
_END = _Refused(mav.MAV_FTP_ERR_EOF)


def _request_of(payload: bytes) -> _Request:
    sequence, session, opcode, size, _, _, offset = _HEAD.unpack_from(payload)
    return _Request(sequence, session, opcode, size, offset, payload[_HEAD.size :])


def _answer(request: _Request, outcome: bytes | _Refused) -> bytes:
    """Encode the payload of an answer."""
    if isinstance(outcome, _Refused):
        opcode, data = mav.MAV_FTP_OPCODE_NAK, bytes((outcome.error,))
    else:
        opcode, data = mav.MAV_FTP_OPCODE_ACK, outcome
    head = _HEAD.pack(
        request.sequence + 1 & 0xFFFF,
        request.session,
        opcode,
        len(data),
        request.opcode,
        0,
        request.offset,
    )
    return head + data


def _message(requester: _Requester, payload: bytes) -> OutgoingMessage:
    link, station = requester
    padded = list(payload.ljust(_PAYLOAD, b"\0"))
    return OutgoingMessage(
        mav.MAVLink_file_transfer_protocol_message(0, station.system, station.component, padded), link
    )

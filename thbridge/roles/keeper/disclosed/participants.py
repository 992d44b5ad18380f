"""The participants' programs, and the notices to them: texts, floor plan, views, and pieces of pictures."""

import base64
from collections import deque
from collections.abc import Iterator, Sequence

from sim.common.observations import TICKS_PER_SECOND
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.shared.notices import PicturePiece
from thbridge.roles.shared.team_notices import TalkLine, TeamTalk
from thbridge.roles.shared.view import View
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, encode_notice

MOST_PARTICIPANTS = 64
"""Maximum number of participants' programs at the same time."""
MOST_NUMBERS = 256
"""Maximum number of stored request numbers for a program. The latest numbers are stored; repetitions come quickly."""
PIECE_SIZE = 30_000
"""Number of bytes of a picture in one line: 40,000 characters in base 64."""
PIECE_PERIOD = TICKS_PER_SECOND // 12
"""Number of ticks between two pieces. Without pauses, a large picture would overload a slow connection, and the server
would close this connection."""


TALK_LINES = 8
"""Greatest number of texts in one line. Even if each character is escaped, they fit into a line of 64 KiB."""


class Participants:
    """The connected programs of participants. Each program receives all changes. A new program receives all data.

    Args:
        sender: name of the sending role.
        briefing: briefing of the study.
    """

    def __init__(self, sender: str, briefing: Briefing) -> None:
        self._sender = sender
        self._briefing = briefing
        # By program: id of its run, and numbers of its latest requests, oldest first.
        self._members: dict[str, tuple[str, dict[int, None]]] = {}
        self._newcomers: dict[str, None] = {}
        self._unreachable: set[str] = set()
        self._shown: View | None = None
        # First, by room, the pictures that all programs except new programs have. Then the queue of pieces with their
        # receivers.
        self._taken: dict[int, str] = {}
        self._pieces: deque[tuple[str, PicturePiece]] = deque()
        self._next_piece = 0
        # Game of the texts, and the number of texts that all programs except new programs have.
        self._talk_of = self._talk_shown = 0

    def __contains__(self, name: str) -> bool:
        return name in self._members

    @property
    def is_empty(self) -> bool:
        """True if no participant's program is connected."""
        return not self._members

    def join(self, name: str, map_name: str | None, run: str = "") -> list[TextMessage]:
        """Add a participant's program, and return the first messages to it. Empty if there are too many programs.

        If there are too many programs, the new program replaces a program that could not be reached. A program may join
        several times.

        Args:
            name: name of the program.
            map_name: name of the robots' map, or None if it is unknown.
            run: id of this run of the program. Each run counts its requests from 1. Empty if unknown.
        """
        if name not in self._members and len(self._members) >= MOST_PARTICIPANTS:
            gone = next((member for member in self._members if member in self._unreachable), None)
            if gone is None:
                return []
            self._remove(gone)
        self._unreachable.discard(name)
        if not run or self._members.get(name, ("",))[0] != run:
            self._members[name] = (run, {})
        self._newcomers[name] = None
        self._pieces = deque(piece for piece in self._pieces if piece[0] != name)
        briefed = [] if self._briefing.texts is None else [encode_notice(self._sender, name, self._briefing.texts)]
        plan = self._briefing.floor_plan
        # The robots may use another map than the server. A wrong plan would be worse than no plan.
        if plan is not None and map_name in {None, plan.map}:
            briefed.append(encode_notice(self._sender, name, plan))
        return briefed

    def is_another_program(self, name: str, run: str) -> bool:
        """Return True if a program with this name has joined before, in another run."""
        return bool(run) and self._members.get(name, (run,))[0] != run

    def is_repetition(self, request: Notice) -> bool:
        """Return True if the sender has already used the request's number in this run, and store the number.

        A request without a number never counts as a repetition.
        """
        number = request.request
        if number is None or request.sender not in self._members:
            return False
        numbers = self._members[request.sender][1]
        if number in numbers:
            return True
        if len(numbers) >= MOST_NUMBERS:
            del numbers[next(iter(numbers))]
        numbers[number] = None
        return False

    @property
    def reachable(self) -> list[str]:
        """Names of the programs that are connected, as far as it is known."""
        return [name for name in self._members if name not in self._unreachable]

    def note_unreachable(self, name: str) -> None:
        """Record that a program was disconnected, or that a notice to it could not be delivered."""
        if name in self._members:
            self._unreachable.add(name)

    def _remove(self, name: str) -> None:
        del self._members[name]
        self._newcomers.pop(name, None)
        self._unreachable.discard(name)
        self._pieces = deque(piece for piece in self._pieces if piece[0] != name)

    def show(self, view: View) -> list[TextMessage]:
        """Return the messages with the view for all programs without this view. `pieces` later sends its pictures."""
        self._queue_pictures(view)
        receivers = self._newcomers if view == self._shown else self._members
        self._shown = view
        outgoing = [encode_notice(self._sender, name, view) for name in receivers]
        self._newcomers = {}
        return outgoing

    def show_talk(self, game: int, lines: Sequence[TalkLine]) -> list[TextMessage]:
        """Return the messages with texts of other participants, for all programs that do not have them.

        Call this before `show`, which completes the joining of programs.
        """
        if game != self._talk_of:
            self._talk_of, self._talk_shown = game, 0
        outgoing = []
        for name in self._members:
            first = 0 if name in self._newcomers else self._talk_shown
            for start in range(first, len(lines), TALK_LINES):
                outgoing.append(
                    encode_notice(self._sender, name, TeamTalk(game, tuple(lines[start : start + TALK_LINES])))
                )
        self._talk_shown = len(lines)
        return outgoing

    def pieces(self, tick: int) -> list[TextMessage]:
        """Return the message with the next piece of a picture if it is due, otherwise no message."""
        if not self._pieces or tick < self._next_piece:
            return []
        self._next_piece = tick + PIECE_PERIOD
        name, piece = self._pieces.popleft()
        return [encode_notice(self._sender, name, piece)]

    def _queue_pictures(self, view: View) -> None:
        if self._shown is not None and self._shown.game != view.game:
            self._taken.clear()
            self._pieces.clear()
        known = self._briefing.pictures
        taken = {room.room: room.picture for room in view.rooms if room.picture is not None and room.picture in known}
        for room, image in taken.items():
            receivers = self._newcomers if self._taken.get(room) == image else self._members
            for name in receivers:
                self._pieces += [(name, piece) for piece in _pieces(view.game, room, known[image])]
        self._taken = taken


def _pieces(game: int, room: int, image: bytes) -> Iterator[PicturePiece]:
    """Yield the pieces of a picture."""
    starts = range(0, len(image), PIECE_SIZE)
    for number, start in enumerate(starts):
        data = base64.b64encode(image[start : start + PIECE_SIZE]).decode("ascii")
        yield PicturePiece(game, room, number, len(starts), data)

"""Pictures of treasures, assembled from pieces that arrive one by one."""

import binascii
from base64 import b64decode

from thbridge.roles.shared.notices import PicturePiece

MOST_BYTES = 1 << 28
"""Maximum size in bytes of all pictures of a game and their pieces: enough for 100 rooms with large pictures."""


class Pictures:
    """Pictures of one game: the game of the piece that arrived last. Pieces may arrive before the game's first view."""

    def __init__(self) -> None:
        self._game = 0
        self._held = 0
        self._pieces: dict[int, dict[int, bytes]] = {}
        self._whole: dict[int, bytes] = {}

    def receive(self, piece: PicturePiece) -> None:
        """Add a piece; malformed pieces and pieces beyond the limit are ignored."""
        if piece.game != self._game:
            self.forget()
            self._game = piece.game
        if piece.room in self._whole or not 0 <= piece.piece < piece.pieces:
            return
        try:
            data = b64decode(piece.data, validate=True)
        except binascii.Error:
            return
        held = self._held + len(data) - len(self._pieces.get(piece.room, {}).get(piece.piece, b""))
        if held > MOST_BYTES:
            return
        self._held = held
        pieces = self._pieces.setdefault(piece.room, {})
        pieces[piece.piece] = data
        if len(pieces) == piece.pieces:
            self._whole[piece.room] = b"".join(pieces[number] for number in sorted(pieces))
            del self._pieces[piece.room]

    def forget(self) -> None:
        """Drop all pictures, because a new game has the same number."""
        self._held = 0
        self._pieces.clear()
        self._whole.clear()

    def of(self, game: int, room: int) -> bytes | None:
        """Return the image file of the picture taken in a room of a game; None until the file is complete."""
        return self._whole.get(room) if game == self._game else None

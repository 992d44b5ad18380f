from base64 import b64encode

from hypothesis import given
from hypothesis import strategies as st

from thbridge.roles.shared.notices import PicturePiece
from ui.model.playing.memory.pictures import Pictures


def pieces(data, size, game=1, room=3):
    cut = [data[start : start + size] for start in range(0, len(data), size)]
    return [PicturePiece(game, room, number, len(cut), b64encode(part).decode()) for number, part in enumerate(cut)]


@given(st.binary(min_size=1, max_size=60), st.integers(1, 30), st.randoms(use_true_random=False))
def test_pieces_in_any_order_and_twice_are_the_picture(data, size, chance):
    album = Pictures()
    parts = pieces(data, size)
    for piece in chance.sample(parts, len(parts)) + parts:
        album.receive(piece)
    assert album.of(1, 3) == data
    assert album.of(1, 2) is album.of(2, 3) is None


def test_a_picture_is_not_there_before_its_last_piece():
    album = Pictures()
    first, second = pieces(b"abcd", 2)
    album.receive(second)
    assert album.of(1, 3) is None
    album.receive(first)
    assert album.of(1, 3) == b"abcd"


def test_another_game_has_other_pictures():
    album = Pictures()
    for piece in (*pieces(b"old", 9), *pieces(b"new", 9, game=2)):
        album.receive(piece)
    assert (album.of(1, 3), album.of(2, 3)) == (None, b"new")


def test_what_is_no_piece_is_passed_over():
    album = Pictures()
    for piece in (PicturePiece(1, 3, 0, 1, "?"), PicturePiece(1, 3, 5, 2, "aGE="), PicturePiece(1, 3, -1, 2, "aGE=")):
        album.receive(piece)
    assert album.of(1, 3) is None


def test_pictures_that_no_game_has_take_no_memory(monkeypatch):
    monkeypatch.setattr("ui.model.playing.memory.pictures.MOST_BYTES", 10)
    album = Pictures()
    for room in range(3):
        for piece in pieces(b"abcd", 2, room=room):
            album.receive(piece)
            album.receive(piece)
    assert [album.of(1, room) for room in range(3)] == [b"abcd", b"abcd", None]
    for piece in pieces(b"abcd", 2, game=2):
        album.receive(piece)
    assert album.of(2, 3) == b"abcd"

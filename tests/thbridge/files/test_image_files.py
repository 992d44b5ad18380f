"""Pictures of maps: what Pillow cannot read is refused in words, whatever it raises."""

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from thbridge.files.errors import BadFile
from thbridge.files.image_files import read_image

STRIP_OFFSETS, FLOAT = 273, 11


def test_a_tiff_with_a_place_that_is_a_float_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.tiff"
    pixels = np.full((10, 20), 254, np.uint8)
    Image.fromarray(pixels).save(path)
    assert np.array_equal(read_image(path), pixels)
    data = bytearray(path.read_bytes())
    (directory,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, directory)
    entries = range(directory + 2, directory + 2 + 12 * count, 12)
    at = next(entry for entry in entries if struct.unpack_from("<H", data, entry) == (STRIP_OFFSETS,))
    struct.pack_into("<H", data, at + 2, FLOAT)
    path.write_bytes(data)
    with pytest.raises(BadFile, match="the image is damaged"):
        read_image(path)


SHADES = np.array([[10, 254, 205], [13, 0, 35]], np.uint8)
"""Shades that a header can be taken for: 10 is a line's end, 13 another, 35 begins a comment."""


def netpbm(kind: str, line_end: str, comment: str = "") -> bytes:
    """A picture of these shades, of one kind, with one kind of line ends in its header."""
    deep = kind == "P5 of 16 bit"
    head = [kind[:2], *([comment] if comment else []), "3 2", *([] if kind == "P4" else ["65535" if deep else "255"])]
    if kind in {"P2", "P3"}:
        values = np.repeat(SHADES.ravel(), 3 if kind == "P3" else 1)
        head += [" ".join(map(str, values))]
    rasters = {
        "P4": bytes([0b10100000, 0b01000000]),
        "P5": SHADES.tobytes(),
        "P6": np.repeat(SHADES, 3).tobytes(),
        "P5 of 16 bit": (SHADES.astype(">u2") * 257).tobytes(),
    }
    return line_end.join([*head, ""]).encode() + rasters.get(kind, b"")


@pytest.mark.parametrize("comment", ["", "# CREATOR: an editor"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("kind", ["P2", "P3", "P4", "P5", "P6", "P5 of 16 bit"])
def test_every_end_of_the_lines_in_a_header(kind: str, line_end: str, comment: str, tmp_path: Path) -> None:
    path = tmp_path / "a.ppm"
    path.write_bytes(netpbm(kind, line_end, comment))
    pixels = read_image(path)
    expected = 255 * (1 - np.array([[1, 0, 1], [0, 1, 0]])) if kind == "P4" else SHADES
    assert np.array_equal(pixels if pixels.ndim == 2 else pixels[..., 0], expected)


@pytest.mark.parametrize("kind", ["P4", "P5", "P6", "P5 of 16 bit"])
def test_a_comment_right_behind_the_header(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "a.ppm"
    whole = netpbm(kind, "\n")
    raster = {"P4": 2, "P5": 6, "P6": 18, "P5 of 16 bit": 12}[kind]
    path.write_bytes(whole[: -raster - 1] + b"# drawn by hand\r\n" + whole[-raster:])
    (tmp_path / "plain.ppm").write_bytes(whole)
    assert np.array_equal(read_image(path), read_image(tmp_path / "plain.ppm"))


def test_a_first_pixel_that_looks_like_a_line_end(tmp_path: Path) -> None:
    """One CR ends the header, and the first pixel is 10."""
    path = tmp_path / "a.pgm"
    path.write_bytes(b"P5 3 2 255\r" + SHADES.tobytes())
    assert np.array_equal(read_image(path), SHADES)


def test_a_picture_in_colours_that_is_too_large_is_refused_by_its_header(tmp_path: Path) -> None:
    path = tmp_path / "a.ppm"
    path.write_bytes(b"P6\r\n100000 100000\r\n255\r\n")
    with pytest.raises(BadFile, match="100000 x 100000 pixels"):
        read_image(path)

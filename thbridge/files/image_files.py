"""Images of maps: PGM files and headers of PBM and PPM are read here, other formats by Pillow; pixels have 8 bits."""

import io
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile

MOST_PIXELS = 32_000_000
"""Maximum number of pixels: 280 m x 280 m at 0.05 m. Localization needs 32 bytes per cell: for this map, a gigabyte."""
MOST_WORDS = 8_000_000
"""Maximum number of pixels that are written as text (P2), because each takes 40 bytes."""
LARGEST_IMAGE = 1 << 29
"""Largest size of a file, bytes."""

_FORMATS = ("PNG", "PPM", "JPEG", "BMP", "GIF", "TIFF", "WEBP", "TGA", "PCX", "XPM")
"""Formats of Pillow that map_server also reads. For other formats, such as EPS, Pillow would run other programs."""


def read_image(path: Path) -> NDArray[np.uint8]:
    """Return the pixels of an image: PGM (P2 and P5, 8 and 16 bit), PNG, JPEG, BMP, GIF, TIFF, WebP, TGA, PCX, XPM.

    Returns:
        (rows, cols) gray or (rows, cols, 3 or 4) colors, row 0 at the top; pixels with more than 8 bits are scaled down
        to 8 bits, as in the image library of map_server.

    Raises:
        BadFile: the file is not an image, or a part of the image is missing.
    """
    try:
        data = content_of(path, LARGEST_IMAGE)
    except OSError as error:
        raise BadFile(path, f"it cannot be read ({error.strerror})", "Check that it is a file") from None
    if data[:2] in {b"P2", b"P5"}:
        return _read_pgm(path, data)
    if data[:2] in {b"P4", b"P6"}:
        data = _with_plain_header(path, data)
    elif data[:2] in {b"P1", b"P3"}:
        data = _COMMENT.sub(b"", data)  # in Pillow, a comment ends only at LF
    # Pillow is imported here, because the import is slow and few maps need Pillow.
    from PIL import Image, UnidentifiedImageError  # noqa: PLC0415

    try:
        with Image.open(io.BytesIO(data), formats=_FORMATS) as image:
            if image.width * image.height > MOST_PIXELS:
                raise _too_large(path, image.width, image.height)
            if image.mode.startswith("I;16"):
                return (np.asarray(image).astype(np.uint32) >> 8).astype(np.uint8)
            transparent = image.mode in {"LA", "PA", "La"} or "transparency" in image.info
            mode = "L" if image.mode in {"1", "L"} and not transparent else "RGBA" if transparent else None
            mode = mode or ("RGBA" if image.mode in {"RGBA", "RGBa"} else "RGB")
            return np.asarray(image.convert(mode), dtype=np.uint8)
    except (UnidentifiedImageError, Image.DecompressionBombError):
        raise BadFile(path, "this is not a readable image", "Save it as PGM or PNG") from None
    # Pillow raises many kinds of errors for wrong tags, such as an offset that is a float.
    except (OSError, SyntaxError, ValueError, TypeError, LookupError, ArithmeticError) as error:
        raise BadFile(path, f"the image is damaged ({error})", "Save it again as PGM or PNG") from None


def _too_large(path: Path, width: int, height: int) -> BadFile:
    problem = f"{width} x {height} pixels are more than {MOST_PIXELS}"
    return BadFile(path, problem, "Save the map at a coarser resolution")


def _with_plain_header(path: Path, data: bytes) -> bytes:
    """Return a binary PBM or PPM with a header for Pillow: Pillow ends the header at the first byte of a line end."""
    kind, count = data[:2], _HEADER_NUMBERS[data[:2]]
    numbers, end = _netpbm_header(path, data, count)
    if numbers[0] * numbers[1] > MOST_PIXELS:
        raise _too_large(path, numbers[0], numbers[1])
    # Values above 255 take two bytes each in a PPM.
    row = (numbers[0] + 7) // 8 if count == 2 else 3 * numbers[0] * (1 + (numbers[2] > 255))
    begin = _raster_begin(data, end, row * numbers[1])
    return kind + b"\n" + b" ".join(str(number).encode() for number in numbers) + b"\n" + data[begin:]


def _read_pgm(path: Path, data: bytes) -> NDArray[np.uint8]:
    (width, height, deepest), end = _netpbm_header(path, data, _HEADER_NUMBERS[data[:2]])
    if width < 1 or height < 1:
        raise BadFile(path, f"the image has {width} x {height} pixels", "Save the image again")
    if not 1 <= deepest <= 65535:
        raise BadFile(path, f"the largest value in the header is {deepest}", "Save the image with 8 or 16 bits")
    if width * height > MOST_PIXELS:
        raise _too_large(path, width, height)
    if data[:2] == b"P2" and width * height > MOST_WORDS:
        problem = f"{width} x {height} pixels in text form are more than {MOST_WORDS}"
        raise BadFile(path, problem, "Save the map as a binary PGM (P5), or as PNG")
    if data[:2] == b"P5":
        depth = np.dtype(np.uint8) if deepest < 256 else np.dtype(">u2")
        size = width * height * depth.itemsize
        begin = _raster_begin(data, end, size)
        raster = data[begin : begin + size]
        if len(raster) < size:
            found = len(raster) // (width * depth.itemsize)
            raise _truncated(path, width, height, f"{found} rows")
        values = np.frombuffer(raster, dtype=depth)
    else:
        words = b" ".join(line.partition(b"#")[0] for line in data[end:].splitlines()).split()
        if len(words) < width * height:
            raise _truncated(path, width, height, f"{len(words)} values")
        wrong = next((word for word in words[: width * height] if not word.isdigit() or len(word) > 5), None)
        if wrong is not None:
            raise BadFile(path, f"{wrong!r} is not a gray value", "Save the image again")
        values = np.array(words[: width * height], dtype=np.uint32)
    if values.max() > deepest:
        problem = f"a gray value of {values.max()} is above the header's largest value, {deepest}"
        raise BadFile(path, problem, "Save the image again")
    shades = (np.arange(deepest + 1) * 255 // deepest).astype(np.uint8)
    drawn: NDArray[np.uint8] = shades[values].reshape(height, width)
    return drawn


def _truncated(path: Path, width: int, height: int, found: str) -> BadFile:
    problem = f"the image is cut off: its header says {width} x {height} pixels, but the file has only {found}"
    return BadFile(path, problem, "Copy or save the image again")


_HEADER_NUMBERS = {b"P2": 3, b"P4": 2, b"P5": 3, b"P6": 3}
"""Count of numbers in each kind of header: width, height, and the largest value (not for black and white)."""
_COMMENT = re.compile(rb"#[^\r\n]*")
_LINE_END = re.compile(rb"[\r\n]")


def _raster_begin(data: bytes, end: int, size: int) -> int:
    """Return the offset of the pixels, which have `size` bytes; the last number of the header ends at `end`.

    Exactly one blank ends the header. The next byte is a pixel, even if it has the value of a blank. But if an editor
    has written CR LF as line ends, both bytes end the header. A comment directly after the last number ends at the end
    of its line.
    """
    if data[end : end + 1] == b"#":
        found = _LINE_END.search(data, end)
        end = len(data) if found is None else found.start()
    both = data[end : end + 2] == b"\r\n" and len(data) >= end + 2 + size
    return end + 2 if both else end + 1


def _netpbm_header(path: Path, data: bytes, count: int) -> tuple[list[int], int]:
    """Return the numbers of a header, and the offset of the end of the last number."""
    numbers: list[int] = []
    position = 2
    while len(numbers) < count:
        if data[position : position + 1].isspace():
            position += 1
        elif data[position : position + 1] == b"#":
            found = _LINE_END.search(data, position)
            position = len(data) if found is None else found.start()
        else:
            end = position
            while data[end : end + 1].isdigit() and end - position < 10:
                end += 1
            if end == position:
                raise BadFile(path, "the PGM header is damaged", "Save the image again as PGM")
            numbers.append(int(data[position:end]))
            position = end
    return numbers, position

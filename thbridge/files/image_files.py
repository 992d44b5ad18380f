"""Images of maps: PGM files are read here, all others by Pillow; pixels have 8 bits."""

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile

MOST_PIXELS = 32_000_000
"""Largest number of pixels: 280 m x 280 m at 0.05 m. To localise on such a map takes 32 bytes a cell, a gigabyte."""
MOST_WORDS = 8_000_000
"""Largest number of pixels that are written as words (P2), for each takes 40 bytes."""
LARGEST_IMAGE = 1 << 29
"""Largest file in bytes."""

_FORMATS = ("PNG", "PPM", "JPEG", "BMP", "GIF", "TIFF", "WEBP", "TGA", "PCX", "XPM")
"""Those of Pillow's formats that map_server reads as well; for others, such as EPS, Pillow runs other programs."""


def read_image(path: Path) -> NDArray[np.uint8]:
    """The pixels of an image: PGM (P2 and P5, 8 and 16 bit), PNG, JPEG, BMP, GIF, TIFF, WebP, TGA, PCX, XPM.

    Returns:
        (rows, cols) grey or (rows, cols, 3 or 4) colours, row 0 at the top; deeper pixels are scaled down to 8 bit as
        the library behind map_server does.

    Raises:
        BadFile: it is not an image, or a part of it is missing.
    """
    try:
        data = content_of(path, LARGEST_IMAGE)
    except OSError as error:
        raise BadFile(path, f"it cannot be read ({error.strerror})", "Check that it is a file") from None
    if data[:2] in {b"P2", b"P5"}:
        return _read_pgm(path, data)
    # Imported here because it is slow and few maps need it.
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
        raise BadFile(path, "not a picture that can be read", "Save it as PGM or PNG") from None
    # Pillow raises whatever comes of a wrong tag, such as a place that is a float.
    except (OSError, SyntaxError, ValueError, TypeError, LookupError, ArithmeticError) as error:
        raise BadFile(path, f"the picture is damaged ({error})", "Save it anew as PGM or PNG") from None


def _too_large(path: Path, width: int, height: int) -> BadFile:
    problem = f"{width} x {height} pixels are more than {MOST_PIXELS}"
    return BadFile(path, problem, "Save the map with a coarser resolution")


def _read_pgm(path: Path, data: bytes) -> NDArray[np.uint8]:
    tokens = _pgm_header(path, data)
    (width, _), (height, _), (deepest, end) = tokens
    if width < 1 or height < 1:
        raise BadFile(path, f"the picture is {width} x {height} pixels", "Save it anew")
    if not 1 <= deepest <= 65535:
        raise BadFile(path, f"the header's greatest value is {deepest}", "Save it with 8 or 16 bit")
    if width * height > MOST_PIXELS:
        raise _too_large(path, width, height)
    if data[:2] == b"P2" and width * height > MOST_WORDS:
        problem = f"{width} x {height} pixels as words are more than {MOST_WORDS}"
        raise BadFile(path, problem, "Save the map as a binary PGM (P5), or as PNG")
    if data[:2] == b"P5":
        depth = np.dtype(np.uint8) if deepest < 256 else np.dtype(">u2")
        # Exactly one blank ends the header; the byte after it is a pixel, even if it is a blank, too.
        raster = data[end + 1 : end + 1 + width * height * depth.itemsize]
        if len(raster) < width * height * depth.itemsize:
            found = len(raster) // (width * depth.itemsize)
            raise _truncated(path, width, height, f"{found} rows")
        values = np.frombuffer(raster, dtype=depth)
    else:
        words = b" ".join(line.partition(b"#")[0] for line in data[end:].splitlines()).split()
        if len(words) < width * height:
            raise _truncated(path, width, height, f"{len(words)} values")
        wrong = next((word for word in words[: width * height] if not word.isdigit() or len(word) > 5), None)
        if wrong is not None:
            raise BadFile(path, f"{wrong!r} stands among the grey values", "Save the picture anew")
        values = np.array(words[: width * height], dtype=np.uint32)
    if values.max() > deepest:
        problem = f"a grey value of {values.max()} above the header's greatest, {deepest}"
        raise BadFile(path, problem, "Save the picture anew")
    shades = (np.arange(deepest + 1) * 255 // deepest).astype(np.uint8)
    drawn: NDArray[np.uint8] = shades[values].reshape(height, width)
    return drawn


def _truncated(path: Path, width: int, height: int, found: str) -> BadFile:
    problem = f"the picture is cut off: its header says {width} x {height} pixels, but there are {found} only"
    return BadFile(path, problem, "Copy or save it anew")


def _pgm_header(path: Path, data: bytes) -> list[tuple[int, int]]:
    """Width, height and greatest value, each with the offset of its end."""
    numbers: list[tuple[int, int]] = []
    position = 2
    while len(numbers) < 3:
        if data[position : position + 1].isspace():
            position += 1
        elif data[position : position + 1] == b"#":
            newline = data.find(b"\n", position)
            position = len(data) if newline < 0 else newline
        else:
            end = position
            while data[end : end + 1].isdigit() and end - position < 10:
                end += 1
            if end == position:
                raise BadFile(path, "the PGM header is damaged", "Save the picture anew as PGM")
            numbers.append((int(data[position:end]), end))
            position = end
    return numbers

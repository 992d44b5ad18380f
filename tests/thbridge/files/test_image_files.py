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
    with pytest.raises(BadFile, match="the picture is damaged"):
        read_image(path)

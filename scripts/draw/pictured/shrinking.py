"""Reduction of pictures of windows to small files, with few colors, but with all important colors."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

LARGEST = 60_000
"""Target size of a picture, bytes; a picture with much detail and double resolution may exceed it."""
PALETTES = (128, 64, 40, 26)
"""Numbers of colors to try, starting with the largest."""
RARE = 100_000
"""A color is important if at least one in this number of pixels has it."""
_WEIGHTS = np.array([65536, 256, 1], dtype=np.uint32)


def shrunk(picture: Image.Image) -> bytes:
    """Return a PNG with as many colors as are possible within `LARGEST` bytes."""
    pixels = np.asarray(picture, dtype=np.uint32)
    codes, places, counts = np.unique(pixels @ _WEIGHTS, return_inverse=True, return_counts=True)
    colours = (codes[:, None] // _WEIGHTS % 256).astype(np.float32)
    data = b""
    for number in PALETTES:
        chosen = colours[palette_of(colours, counts, number)]
        nearest = np.argmin(((colours[:, None] - chosen[None]) ** 2).sum(axis=2), axis=1).astype(np.uint8)
        few = Image.fromarray(nearest[places].reshape(pixels.shape[:2]), "P")
        few.putpalette(chosen.astype(np.uint8).tobytes())
        buffer = io.BytesIO()
        few.save(buffer, "PNG", optimize=True)
        data = buffer.getvalue()
        if len(data) <= LARGEST:
            break
    return data


def palette_of(colours: NDArray[np.float32], counts: NDArray[np.int64], number: int) -> list[int]:
    """Return the indices of the (n, 3) colors to keep.

    Half of them are the most frequent colors, so that backgrounds stay the same. Then the color that is farthest from
    all kept colors is added, again and again. So rare but important colors, such as a robot's color, are kept.
    """
    kept: list[int] = np.argsort(-counts, kind="stable")[: number // 2].tolist()
    frequent = counts >= counts.sum() / RARE
    distance = ((colours[:, None] - colours[kept][None]) ** 2).sum(axis=2).min(axis=1)
    while len(kept) < min(number, len(colours)):
        kept.append(int(np.argmax(np.where(frequent, distance, 0.0))))
        distance = np.minimum(distance, ((colours - colours[kept[-1]]) ** 2).sum(axis=1))
    return kept

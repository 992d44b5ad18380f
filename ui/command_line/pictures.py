"""Picture files without dates, so that the same picture always gives the same bytes."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from thbridge.files.disk.whole import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of the supported formats."""


def write_picture(draw: Callable[[], "Figure"], to: Path, option: str) -> None:
    """Draw a picture into a file, in the format of its suffix (one of `PICTURES`).

    Args:
        draw: function that draws the picture.
        to: file to write.
        option: option that names the file, for the error message.

    Raises:
        BadFile: the file cannot be written.
    """
    from matplotlib import rc_context  # noqa: PLC0415 - it takes half a second to load

    dates = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
    undated = dates.get(to.suffix.lower(), {"CreationDate": None, "Creator": None, "Producer": None})
    drawn = io.BytesIO()
    with rc_context({"svg.hashsalt": "thbridge"}):
        draw().savefig(drawn, format=to.suffix.lower().removeprefix("."), metadata=undated)
    write_whole(to, drawn.getvalue(), f"choose another file with {option}")

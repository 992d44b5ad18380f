"""Programs of other people, such as strategies and authors of wordings: their errors, and texts for these errors."""

import re
import traceback
from pathlib import Path

import sim

RAISED = (Exception, SystemExit, GeneratorExit)
"""Exceptions of another program that do not end this program. Interrupts are not included: people cause them."""
LONGEST_FAULT = 300
"""Longest text of a fault, in characters."""
_OURS = (Path(__file__).parents[1], Path(sim.__path__[0]))
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def told_error(error: BaseException) -> str:
    """Return the text of another program's error, with its location there; the text is the same on each machine."""
    text = in_a_line(traceback.format_exception_only(error)[-1])
    frames = traceback.extract_tb(error.__traceback__)
    # The last frame in the other program itself; it may have called functions of thbridge.
    theirs = [frame for frame in frames if not any(map(Path(frame.filename).is_relative_to, _OURS))]
    return f"{text} ({Path(theirs[-1].filename).name}, line {theirs[-1].lineno})" if theirs else text


def in_a_line(text: str) -> str:
    """Return a text of another program for a recording, without memory addresses, which differ each time."""
    line = " ".join(_ADDRESS.sub("", text).split()).encode("utf-8", "replace").decode()
    return line if len(line) <= LONGEST_FAULT else f"{line[:LONGEST_FAULT]}..."

"""Text cells of CSV files that spreadsheets would take for formulas, written so that they are texts.

Such a cell, which begins with = + - @, a tab or a carriage return and is no number, gets an apostrophe before it. So
does one that has apostrophes before such a sign already: whoever leaves out one apostrophe has the text again.

Source: OWASP, CSV Injection.
"""

import re

import pyarrow as pa
from pyarrow import compute

FORMULA = r"^('*[=+\-@\t\r])"
NUMBER = r"^[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?$"
SENTENCE = (
    "In CSV, texts that spreadsheets would take for formulas (they begin with `=`, `+`, `-` or `@`) have a `'` before."
)
"""What readers are told of it."""


def text_cell(text: str) -> str:
    """The cell of a text."""
    return f"'{text}" if re.search(FORMULA, text) and not re.fullmatch(NUMBER, text) else text


def text_cells(texts: pa.Array) -> pa.Array:
    """The cells of texts, of which some may be missing."""
    escaped = compute.replace_substring_regex(texts, FORMULA, r"'\1")
    return compute.if_else(compute.match_substring_regex(texts, NUMBER), texts, escaped)

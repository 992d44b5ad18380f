"""Text cells of CSV files that look like formulas to spreadsheets, marked so that they stay texts.

A cell looks like a formula if it begins with = + - @, a tab or a carriage return and is not a number. Such a cell gets
an apostrophe in front. A cell that already has apostrophes before one of these characters gets one more apostrophe.
Readers restore the text by removing one apostrophe.

Source: OWASP, CSV Injection.
"""

import re

import pyarrow as pa
from pyarrow import compute

FORMULA = r"^('*[=+\-@\t\r])"
NUMBER = r"^[+\-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+\-]?[0-9]+)?$"
SENTENCE = (
    "In CSV, texts that look like formulas to spreadsheets (they begin with `=`, `+`, `-` or `@`) have a `'` in front."
)
"""Explanation for readers of the tables."""


def text_cell(text: str) -> str:
    """Return a text as the content of a CSV cell. Texts that look like formulas get an apostrophe in front."""
    return f"'{text}" if re.search(FORMULA, text) and not re.fullmatch(NUMBER, text) else text


def text_cells(texts: pa.Array) -> pa.Array:
    """Return texts as the contents of CSV cells; some texts may be missing."""
    escaped = compute.replace_substring_regex(texts, FORMULA, r"'\1")
    return compute.if_else(compute.match_substring_regex(texts, NUMBER), texts, escaped)

"""`docs/reference/mavlink-conformance.md` names tests that there are."""

import re

import pytest

from tests.support.project import ROOT

TABLE = (ROOT / "docs" / "reference" / "mavlink-conformance.md").read_text()
FOLDERS = dict(re.findall(r"`(\w+)` =\s+`(tests/[\w/]+)`", TABLE))
NAMED = re.findall(r"`(\w+)/([\w/]+\.py)::(\w+)`", TABLE)


@pytest.mark.parametrize(("folder", "file", "name"), NAMED)
def test_a_test_that_is_named_is_there(folder: str, file: str, name: str) -> None:
    text = (ROOT / FOLDERS[folder] / file).read_text()
    assert re.search(rf"^\s*(async def|def|class) {name}\b", text, re.MULTILINE)


def test_every_row_names_one() -> None:
    rows = [line for line in TABLE.splitlines() if line.startswith("|") and not line.startswith(("| rule", "|---"))]
    assert rows
    assert all("::" in row for row in rows)
    assert TABLE.count("::") == len(NAMED) + 1, "one stands where it is said how they are named"

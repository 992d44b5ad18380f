"""The examples of docs and README do what they say."""

import re
from pathlib import Path

import pytest

from tests.support.project import ROOT


@pytest.mark.parametrize(
    ("page", "examples"),
    [
        ("README.md", 1),
        ("docs/reference/api.md", 7),
        pytest.param("docs/how-to/learning.md", 3, marks=pytest.mark.slow),
    ],
)
def test_the_examples_of_a_page_run_one_after_the_other(
    page: str, examples: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / page).read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) == examples
    known: dict[str, object] = {}
    for number, block in enumerate(blocks, start=1):
        exec(compile(block, f"{page}, example {number}", "exec"), known)

"""The examples of docs/api.md do what they say."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"


def blocks(page: str) -> list[str]:
    """Return the Python examples of a page, in order."""
    return re.findall(r"^```python\n(.*?)^```$", (DOCS / page).read_text(), re.MULTILINE | re.DOTALL)


def test_the_examples_of_the_interface_run_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    known: dict[str, object] = {}
    examples = blocks("api.md")
    assert len(examples) > 4
    for number, example in enumerate(examples, start=1):
        exec(compile(example, f"docs/api.md, example {number}", "exec"), known)


def test_the_examples_of_learning_run_one_after_the_other() -> None:
    known: dict[str, object] = {}
    for number, example in enumerate(blocks("learning.md"), start=1):
        exec(compile(example, f"docs/learning.md, example {number}", "exec"), known)
    assert known["random_return"] != known["cheapest_return"]

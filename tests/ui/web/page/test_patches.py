"""Differences between two pages lead from one to the other, in Python's words and in the browser's."""

import json
import shutil
import subprocess
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.programs.browser_client import applied
from tests.support.project import ROOT
from ui.model.playing.screen import ChooseRobot
from ui.web.page.messages import decode_act
from ui.web.page.patches import patch, tree


@dataclass(frozen=True)
class Leaf:
    number: int
    words: tuple[str, ...]


@dataclass(frozen=True)
class Page:
    title: str
    leaves: tuple[Leaf, ...]
    best: Leaf | None
    numbers: tuple[int, ...]


leaves = st.builds(Leaf, st.integers(0, 3), st.lists(st.sampled_from("ab"), max_size=3).map(tuple))
pages = st.builds(
    Page,
    st.sampled_from(["", "x"]),
    st.lists(leaves, max_size=5).map(tuple),
    st.none() | leaves,
    st.lists(st.integers(0, 2), max_size=6).map(tuple),
)


@given(pages, pages)
def test_a_difference_leads_from_one_page_to_the_other(before: Page, after: Page) -> None:
    change = patch(before, after)
    assert (change is None) == (before == after)
    if change is not None:
        assert applied(tree(before), change) == tree(after)


@given(pages)
def test_equal_pages_differ_in_nothing(page: Page) -> None:
    assert patch(page, Page(page.title, page.leaves, page.best, page.numbers)) is None


@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_the_browser_applies_differences_as_this_test_does(tmp_path: object) -> None:
    examples = [
        (Page("x", (Leaf(1, ("a",)),), None, (1, 2)), Page("", (Leaf(1, ("b",)), Leaf(2, ())), Leaf(0, ()), (1,))),
        (Page("x", (Leaf(1, ("a",)), Leaf(2, ())), Leaf(3, ()), ()), Page("x", (Leaf(1, ("a",)),), None, (0, 0, 0))),
    ]
    given_ = [[tree(before), patch(before, after)] for before, after in examples]
    program = (
        f"import {{ applied }} from {json.dumps(str(ROOT / 'ui/web/static/patches.js'))};"
        f"console.log(JSON.stringify({json.dumps(given_)}.map(([b, p]) => applied(b, p))));"
    )
    done = subprocess.run(
        ["node", "--input-type=module", "-e", program], capture_output=True, text=True, timeout=60, check=True
    )
    assert json.loads(done.stdout) == [tree(after) for _, after in examples]


def test_an_act_comes_back_as_it_was_sent() -> None:
    sent = tree(ChooseRobot(2))
    assert sent == {"act": "ChooseRobot", "robot": 2}
    assert decode_act({"act": "ChooseRobot", "robot": 2}) == ChooseRobot(2)


@pytest.mark.parametrize(
    "given_", [{}, {"act": "Screen"}, {"act": "ChooseRobot"}, {"act": "ChooseRobot", "robot": "2"}, {"act": 3}]
)
def test_a_malformed_act_is_none(given_: dict[str, str | int | bool | None]) -> None:
    assert decode_act(given_) is None

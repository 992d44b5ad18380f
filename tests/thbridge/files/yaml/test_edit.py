import difflib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.files.yaml.edit import EditRefusalReason, with_value, without
from thbridge.files.yaml.places import path_of, source_of, steps_of
from thbridge.files.yaml.tree import Node, parse
from thbridge.hunt.refusals import RequestRefused

TEXT = """\
# mine
robots: 3  # two are too few
game: {energy: 5, costs: }
noise:
  # quiet
  preset: perfect  # really

  # after
things:
- name: x
  shape: door
- {name: y}
world:  # as it is
each: {}
server:
  host: a"""


def test_a_value_changes_and_its_comment_stays() -> None:
    assert with_value(TEXT, "robots", "4") == TEXT.replace("robots: 3", "robots: 4")


def test_a_key_is_added_behind_those_that_come_before_it() -> None:
    added = with_value(TEXT, "noise.gyro_noise", "0.1")
    assert added == TEXT.replace("  # really\n", "  # really\n  gyro_noise: 0.1\n")
    first = with_value("b: 1\nd: 2\n", "c", "3", lambda _: ("a", "b", "c", "d"))
    assert first == "b: 1\nc: 3\nd: 2\n"


def test_missing_sections_are_added_with_the_indentation_of_their_neighbours() -> None:
    assert with_value("a:\n    b: 1\n", "a.c.d", "2") == "a:\n    b: 1\n    c:\n      d: 2\n"
    assert with_value(TEXT, "world.laser.rate", "5") == TEXT.replace(
        "world:  # as it is", "world:  # as it is\n  laser:\n    rate: 5"
    )
    assert with_value(TEXT, "each.2.localization", "ekf") == TEXT.replace(
        "each: {}", "each:\n  2:\n    localization: ekf"
    )
    assert with_value("", "a.b", "1") == "a:\n  b: 1\n"
    assert with_value("# nothing yet", "a", "1") == "# nothing yet\na: 1\n"


def test_brackets_stay_brackets() -> None:
    assert with_value(TEXT, "things[1].shape", "door") == TEXT.replace("{name: y}", "{name: y, shape: door}")
    assert with_value(TEXT, "game.costs", "a") == TEXT.replace("costs: }", "costs: a }")
    assert with_value("a: {b: }", "a.c", "1") == "a: {b: , c: 1 }"
    assert without(TEXT, "game.energy") == TEXT.replace("energy: 5, ", "")


def test_a_removed_key_takes_empty_sections_along_but_no_comment() -> None:
    assert without(TEXT, "noise.preset") == TEXT.replace("noise:\n", "").replace(
        "  preset: perfect  # really\n", "  # really\n"
    )
    assert without("a:\n  b:\n    c: 1\nd: 2\n", "a.b.c") == "d: 2\n"
    assert without(TEXT, "robots") == TEXT.replace("robots: 3  # two are too few", "# two are too few")
    assert without(TEXT, "seed") == TEXT


def test_items_are_added_and_removed() -> None:
    assert with_value(TEXT, "things[2]", "{name: z}") == TEXT.replace("- {name: y}", "- {name: y}\n- {name: z}")
    assert without(TEXT, "things[0]") == TEXT.replace("- name: x\n  shape: door\n", "")
    assert without(TEXT, "things[0].name") == TEXT.replace("- name: x\n  shape", "- shape")
    assert with_value("things: []\n", "things[0]", "{name: z}") == "things:\n  - {name: z}\n"


def test_a_list_in_lines_becomes_one_line_when_it_changes() -> None:
    assert with_value("a:  # why\n- 1\n- 2\nb: 3\n", "a", "[4]") == "a: [4]  # why\nb: 3\n"


def test_lines_keep_the_ends_they_have() -> None:
    text = "a: 1\r\nb:\r\n  c: 2\r\n"
    assert with_value(text, "b.d", "3") == "a: 1\r\nb:\r\n  c: 2\r\n  d: 3\r\n"
    assert without(text, "a") == "b:\r\n  c: 2\r\n"


def test_what_is_no_yaml_is_refused() -> None:
    refused = with_value(TEXT, "robots", "[1")
    assert isinstance(refused, RequestRefused)
    assert refused.reason == EditRefusalReason.NOT_YAML


def test_a_file_written_in_another_way_is_refused_rather_than_spoilt() -> None:
    refused = with_value("? a\n: b: 1\n", "a.c", "2")
    assert isinstance(refused, RequestRefused) or "b: 1" in refused
    assert isinstance(with_value("a: 1\n...\n", "b.c", "2"), str | RequestRefused)
    assert isinstance(with_value("a: word\n", "a.b", "2"), RequestRefused)
    assert isinstance(with_value("a:\n- 1\nd:\nb: 1\n", "a.d", "1"), RequestRefused)


@pytest.mark.parametrize("path", ["a", "a.b", "things[0]", "things[0].at[2]", "each.2.amcl"])
def test_paths_are_taken_apart_and_put_together(path: str) -> None:
    assert path_of(steps_of(path)) == path


NAMES = st.sampled_from(["a", "b", "c", "d"])
COMMENTS = st.sampled_from(["", "  # why", " # a: 1"])


WRITTEN = {"scalar": " 1", "quoted": " 'x # y'", "empty": "", "flow": " {b: 1, c: {d: 2}}", "none": " {}"}


@st.composite
def documents(draw: st.DrawFn, depth: int = 0) -> list[str]:
    """Lines of a section, in all the ways that people write them."""
    lines = []
    for name in draw(st.lists(NAMES, unique=True, min_size=0 if depth == 0 else 1, max_size=3)):
        lines += draw(st.sampled_from([[], ["# above"], [""], ["  # askew"]]))
        comment = draw(COMMENTS)
        kind = draw(st.sampled_from(["scalar", "quoted", "empty", "flow", "none", "list"] + ["section"] * (depth < 2)))
        if kind == "section":
            inner = draw(documents(depth + 1))
            width = draw(st.sampled_from([1, 2, 4]))
            lines += [f"{name}:{comment}", *(" " * width + line if line else "" for line in inner)]
        elif kind == "list":
            lines += [f"{name}:{comment}", "- 1", "- {b: 2}", "- b: 3", "  c: 4"]
        else:
            lines.append(f"{name}:{WRITTEN[kind]}{comment}")
    return lines


PATHS = st.lists(NAMES, min_size=1, max_size=3).map(".".join)
VALUES = st.sampled_from(["1", "0.5", '"two words"', "[1, [2, 3]]", "true", "null", "{b: 7}"])


@given(documents(), st.sampled_from(["\n", "\r\n"]), PATHS, VALUES, st.booleans())
def test_any_change_is_made_and_nothing_else_moves(
    lines: list[str], newline: str, key: str, value: str, ended: bool
) -> None:
    text = newline.join(lines) + (newline if ended else "")
    changed = with_value(text, key, value)
    if isinstance(changed, RequestRefused):
        return
    assert source_of(changed, parse_of(changed), key) == value
    before, after = text.splitlines(), changed.splitlines()
    if source_of(text, parse_of(text), key) is None:
        # All old lines are there and in order, but for one that may have got its brackets filled or lost them.
        assert sum(opcode[2] - opcode[1] for opcode in changes_of(before, after)) <= 1
    removed = without(changed, key)
    if isinstance(removed, str):
        assert source_of(removed, parse_of(removed), key) is None
        comments = sorted(line.partition("# ")[2] for line in after if "# " in line and "'" not in line)
        kept = sorted(line.partition("# ")[2] for line in removed.splitlines() if "# " in line and "'" not in line)
        assert kept == comments


def changes_of(before: list[str], after: list[str]) -> list[tuple[str, int, int, int, int]]:
    codes = difflib.SequenceMatcher(None, before, after, autojunk=False).get_opcodes()
    return [code for code in codes if code[0] in {"replace", "delete"}]


def parse_of(text: str) -> Node:
    return parse(Path("x"), text)

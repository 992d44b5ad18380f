"""Argumentation frameworks in the formats of solvers."""

from pathlib import Path

import pytest
from hypothesis import given

from tests.support.dialogue.random_frameworks import frameworks
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.files.argument_files import read_framework
from thbridge.files.errors import BadFile


@given(framework=frameworks())
def test_what_was_written_is_read(tmp_path_factory: pytest.TempPathFactory, framework: ArgumentationFramework) -> None:
    folder = tmp_path_factory.mktemp("frameworks")
    names, attacks = framework.arguments, sorted(framework.attacks)
    apx = [*(f"arg({name})." for name in names), *(f"att({one}, {other})." for one, other in attacks)]
    tgf = [*names, "#", *(f"{one} {other}" for one, other in attacks)]
    for name, lines in (("a.apx", apx), ("a.tgf", tgf)):
        (folder / name).write_text("\n".join(lines))
        assert read_framework(folder / name) == framework
    number = {name: str(place) for name, place in zip(names, range(1, len(names) + 1), strict=True)}
    numbered = [(number[one], number[other]) for one, other in attacks]
    (folder / "a.af").write_text("\n".join(["# ours", f"p af {len(names)}", *map(" ".join, numbered)]))
    assert read_framework(folder / "a.af") == ArgumentationFramework.of(number.values(), numbered)


def test_facts_may_share_a_line_and_have_comments(tmp_path: Path) -> None:
    path = tmp_path / "a.apx"
    path.write_text("% two\narg(x).arg( y ) . att(x,y). % one attack\n\n")
    assert read_framework(path) == ArgumentationFramework.of("xy", [("x", "y")])


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.apx", "arg(a).\narg(b)\n", ["line 2: the full stop after arg(b) is missing."]),
        ("a.apx", "arg(a).\natt(a b).\n", ["line 2: 'att(a b).' cannot be read. Write arg(NAME)."]),
        ("a.apx", "<p>\n" * 1000, [f"line {number}: '<p>' cannot be read." for number in range(1, 21)]),
        ("a.apx", f"({'a' * 100})", [f"line 1: '({'a' * 59}...' cannot be read."]),
        (
            "a.apx",
            "arg(a).\narg(\x1b[31mred).\n",
            [r"line 2: the name '\x1b[31mred' has characters that cannot be printed. Choose other characters."],
        ),
        ("a.apx", "arg(a).\narg(a).\n", ["line 2: the argument a is defined twice, first in line 1."]),
        (
            "a.apx",
            "arg(a).\natt(a,b).\natt(c,a).\n",
            ["line 2: no argument b is defined.", "line 3: no argument c is defined."],
        ),
        ("a.tgf", "a\n#\na\n", ["line 3: 'a' is not an attack."]),
        ("a.tgf", "a\n#\na b\n", ["line 3: no argument b is defined."]),
        (
            "a.tgf",
            "a\na b\n",
            ["line 2: the argument a is defined twice, first in line 1. Delete one of the two; write"],
        ),
        ("a.tgf", "arg(a).\n", ["line 1: 'arg(a).' is not a name of an argument."]),
        ("a.af", "1 2\n", ["line 1: '1 2' does not give the number of arguments. Begin with p af"]),
        ("a.af", "p af 10000001\n", ["line 1: 'p af 10000001' does not give the number of arguments."]),
        ("a.af", "# nothing\n", ["a.af: the number of arguments is missing."]),
        (
            "a.af",
            "p af 2\n1 3\n0 1\n1 2 3\np af 2\n1 \uff12\n",
            [
                f"line {number}: {text!r} is not an attack."
                for number, text in enumerate(["1 3", "0 1", "1 2 3", "p af 2", "1 \uff12"], 2)
            ],
        ),
        ("a.txt", "arg(a).", ["the suffix does not show the format."]),
    ],
)
def test_every_fault_has_its_line(tmp_path: Path, name: str, text: str, told: list[str]) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(BadFile) as refused:
        read_framework(path)
    lines = str(refused.value).splitlines()
    assert len(lines) == len(told)
    assert all(sentence in line for sentence, line in zip(told, lines, strict=True))

"""`thbridge argue`."""

import json
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "case.apx"
    path.write_text("arg(a). arg(b). arg(c). arg(d).\natt(b,a). att(c,b). att(c,d). att(d,c).\n")
    return path


def argue(*arguments: object) -> str:
    done = invoke("argue", *arguments)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_extensions_are_told_sorted(file: Path) -> None:
    assert argue(file, "--semantics", "PR") == "{a, c}\n{b, d}\n"
    told = json.loads(argue(file, "--semantics", "co", "--json"))
    assert told == {"semantics": "CO", "extensions": [[], ["a", "c"], ["b", "d"]]}


def test_numbers_are_sorted_as_numbers(tmp_path: Path) -> None:
    path = tmp_path / "case.af"
    path.write_text("p af 11\n1 2\n2 1\n10 11\n11 10\n")
    ends = ("3, 4, 5, 6, 7, 8, 9, 10", "3, 4, 5, 6, 7, 8, 9, 11")
    assert argue(path, "--semantics", "ST") == "".join(f"{{{first}, {end}}}\n" for first in (1, 2) for end in ends)


def test_an_argument_is_asked_about(file: Path) -> None:
    assert "a is in some extension." in argue(file, "--semantics", "ST", "--query", "a")
    told = json.loads(argue(file, "--query", "a", "--explain", "--json"))
    assert (told["credulous"], told["sceptical"], told["grounded"]) == (False, False, False)
    assert told["label"] == "undecided"
    assert told["discussion"][:2] == [{"locution": "HTB", "argument": "a"}, {"locution": "CB", "argument": "b"}]
    assert "Opponent:  But b attacks a.\n" in argue(file, "--query", "a", "--explain")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--query", "z"), "--query: there is no argument z"),
        (("--explain",), "--explain requires an argument to explain."),
    ],
)
def test_what_cannot_be_is_told(file: Path, options: tuple[str, ...], told: str) -> None:
    done = invoke("argue", file, *options)
    assert done.exit_code == 2
    assert told in done.stderr


def test_clingo_finds_the_same(file: Path) -> None:
    pytest.importorskip("clingo", reason="clingo is not installed: make setup")
    for semantics in ("GR", "CO", "PR", "ST"):
        options = (file, "--semantics", semantics, "--query", "a", "--explain")
        assert argue(*options, "--engine", "clingo") == argue(*options)


def test_clingo_that_is_not_installed_is_told_with_the_remedy(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ui.commands.argue.argue.find_spec", lambda _name: None)
    done = invoke("argue", file, "--engine", "clingo")
    assert done.exit_code == 2
    assert "--engine: the package clingo is not installed. Run: pip install 'thbridge[argumentation]'" in done.stderr

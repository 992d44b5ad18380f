"""`docs/glossary.md` speaks of what there is, and public class names are used once."""

import ast
import gc
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import get_args

from sim.inputs import TEAM_INPUTS
from tests.support.project import ROOT
from thbridge.roles.shared.robot_requests import REQUESTS, CommandRequest
from thbridge.roles.shared.view import DeclineConsent, ParticipantRequest
from thbridge.text_protocol.wire.notice_format import kind_of
from ui.model.playing.screen import Act

TABLES = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in (ROOT / "docs" / "glossary.md").read_text().splitlines()
    if line.startswith("|") and not line.startswith(("|---", "| term ", "| action "))
]
ROWS = [row for row in TABLES if len(row) == 4]
ACTIONS = [row for row in TABLES if len(row) == 5]


@cache
def _trees() -> list[tuple[Path, ast.Module]]:
    files = [file for top in ("sim", "thbridge", "ui") for file in sorted((ROOT / top).rglob("*.py"))]
    # These objects stay for good and have no cycles. The garbage collector would take longer than the parser.
    gc.disable()
    try:
        return [(file, ast.parse(file.read_text())) for file in files]
    finally:
        gc.freeze()
        gc.enable()


@cache
def _definitions() -> list[tuple[Path, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef]]:
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    return [(file, node) for file, tree in _trees() for node in _statements(tree) if isinstance(node, kinds)]


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and the statements in it, without looking through expressions, which are most of a tree."""
    yield node
    for name in ("body", "orelse", "finalbody", "handlers", "cases"):
        inner = getattr(node, name, ())
        for child in inner if isinstance(inner, list) else ():
            yield from _statements(child)


def test_every_term_of_the_glossary_is_in_the_code() -> None:
    text = "\n".join(file.read_text() for file, _ in _trees())
    named = [(row[0], name) for row in ROWS for name in re.findall(r"`(\w+)`", row[2])]
    assert len(named) == len(ROWS) > 60
    there = {name for pair in re.findall(r"^ *class (\w+)|^(\w+)\b.*=", text, re.MULTILINE) for name in pair}
    assert [(term, name) for term, name in named if name not in there] == []


def test_the_table_of_actions_has_all_requests_with_their_tags() -> None:
    tags = {request.__name__: tag for tag, request in {**REQUESTS, **TEAM_INPUTS}.items()}
    tags |= {request.__name__: kind_of(request) for request in (*get_args(ParticipantRequest), DeclineConsent)}
    listed = [
        (re.findall(r"`(\w+)`", f"{own} {stations}"), re.findall(r"`(\w+)`", tag))
        for _, own, stations, tag, _ in ACTIONS
    ]
    assert [names for names, written in listed if [tags[name] for name in names] != written] == []
    of_people = {request.__name__ for request in (*get_args(ParticipantRequest), *get_args(CommandRequest))}
    assert of_people <= {name for names, _ in listed for name in names}


def test_an_act_of_the_window_has_the_name_of_its_request() -> None:
    requests = {request.__name__ for request in (*get_args(ParticipantRequest), DeclineConsent)}
    acts = {act.__name__ for act in Act.__subclasses__() if act.__name__.endswith("Act")}
    assert {act.removesuffix("Act") for act in acts} == requests - {"SendRobot", "SenseTreasure", "OpenDialogue"}


def test_terms_stand_once() -> None:
    terms = [row[0] for row in ROWS]
    assert sorted(set(terms)) == sorted(terms)


def test_a_public_class_name_is_used_once() -> None:
    places: dict[str, list[str]] = defaultdict(list)
    for file, node in _definitions():
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            places[node.name].append(str(file.relative_to(ROOT)))
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_docstrings_begin_with_what_the_thing_is_or_does() -> None:
    riddles = ("What ", "Who ", "How ", "Where ", "Whether ", "Which ", "Why ", "Whoever ", "Of ")
    found = [
        f"{file.relative_to(ROOT)}: {text.splitlines()[0]}"
        for file, node in _definitions()
        if (text := ast.get_docstring(node)) is not None and text.startswith(riddles)
    ]
    assert found == []

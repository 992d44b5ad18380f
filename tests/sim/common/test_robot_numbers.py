"""Robots are counted from 0 in the program, and their numbers are made in one place."""

import ast
import itertools
import re
from collections.abc import Iterator

import pytest

from sim.common.robot_numbers import index_of, namespace_of, number_of, robot_name, robot_numbers
from tests.support.project import ROOT

HOME = ROOT / "sim" / "common" / "robot_numbers.py"
ROBOT = re.compile(r"(int\()?(\w+\.)*_?robots?\)?")
"""A variable or field that holds a robot or their number: `robot`, `event.robot`, `int(robot)`, `study.robots`."""
LABEL = re.compile("robot ?$", re.IGNORECASE)
SUSPECT = re.compile(r"[-+] 1\b|enumerate\(|robot ?\{", re.IGNORECASE)
"""Files without any of these have no such expression, as they are formatted, and need not be parsed."""


def test_the_first_robot_has_number_1_and_index_0() -> None:
    assert (number_of(0), index_of(1)) == (1, 0)
    assert (robot_name(0), namespace_of(0)) == ("robot 1", "robot1")
    assert robot_numbers(3) == [1, 2, 3]
    assert [index_of(number) for number in robot_numbers(64)] == list(range(64))


def conversions(tree: ast.Module) -> Iterator[ast.expr]:
    """Yield expressions that count robots from 1, or back: sums, `enumerate(robots, 1)`, texts like "robot{i + 1}"."""
    slices = {bound for node in ast.walk(tree) if isinstance(node, ast.Slice) for bound in (node.lower, node.upper)}
    for node in ast.walk(tree):
        match node:
            case ast.BinOp(left, ast.Add() | ast.Sub(), ast.Constant(1)) if node not in slices:
                if ROBOT.fullmatch(ast.unparse(left)):
                    yield node
            case ast.Call(ast.Name("enumerate"), [counted, *starts], keywords) if starts or keywords:
                if re.search(r"robots|pilots", ast.unparse(counted)):
                    yield node
            case ast.JoinedStr(parts):
                for before, value in itertools.pairwise(parts):
                    match before, value:
                        case ast.Constant(str(text)), ast.FormattedValue(ast.BinOp()) if LABEL.search(text):
                            yield node


def test_robots_are_counted_from_1_in_one_module_only() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}"
        for top in ("sim", "thbridge", "ui")
        for path in sorted((ROOT / top).rglob("*.py"))
        if path != HOME and SUSPECT.search(text := path.read_text())
        for node in conversions(ast.parse(text))
    ]
    assert found == []


@pytest.mark.parametrize(
    "text",
    [
        "robot + 1",
        "event.robot + 1",
        "int(robot) - 1",
        "range(1, study.robots + 1)",
        "enumerate(self._robots, 1)",
        "enumerate(pilots, start=1)",
        "f'robot{i + 1}'",
        "f'There is no Robot {found + 1}.'",
    ],
)
def test_such_arithmetic_is_found(text: str) -> None:
    assert len(list(conversions(ast.parse(text)))) == 1


@pytest.mark.parametrize("text", ["ends[: robot + 1]", "2 * robot + 1", "enumerate(robots)", "f'robot {number}'"])
def test_other_arithmetic_is_left_alone(text: str) -> None:
    assert list(conversions(ast.parse(text))) == []

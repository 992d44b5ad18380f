"""Whatever a session is made of has no arithmetic whose last bits depend on the machine, beside what ruff refuses.

`a @ b` and `a.dot(b)` add up in the order of BLAS's kernel for this processor, `x**y` is libm's pow (even `x**2` is not
always `x * x`), `sum` of floats is compensated from Python 3.12 on, an unstable sort orders equal keys by the width of
vectors, and `fastmath` and `parallel` let a compiler reorder. Kernels multiply where a power is a written integer.
"""

import ast
import math
from collections.abc import Iterator

import pytest

from tests.support.project import ROOT

CARRIERS = {"live_graph", "recording", "rosgraph", "sockets"}
"""Folders of those who only carry what is said."""
AFTERWARDS = {"analysis", "batch", "experiment", "offline"}
"""Folders of what is calculated from sessions that are over."""
MARK = "# of integers"
"""A comment on the line of a sum or a power that nothing rounds."""


def _is_power_of_two(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and (
        isinstance(node.value, int) or (isinstance(node.value, float) and math.frexp(node.value)[0] == 0.5)
    )


def _counts(node: ast.expr) -> bool:
    """True where a sum's elements are seen to be integers: truth values and lengths."""
    element = node.elt if isinstance(node, ast.GeneratorExp | ast.ListComp) else node
    if isinstance(element, ast.Call) and isinstance(element.func, ast.Name):
        return element.func.id in {"len", "isinstance"}
    return isinstance(element, ast.Compare) or (isinstance(element, ast.BinOp) and isinstance(element.op, ast.LShift))


def _is_kernel(node: ast.AST) -> bool:
    return isinstance(node, ast.FunctionDef) and any("njit" in ast.unparse(each) for each in node.decorator_list)


def _in_call(node: ast.Call) -> Iterator[str]:
    match node:
        case ast.Call(ast.Name("pow")):
            yield "pow"
        case ast.Call(ast.Name("sum"), [summed, *_]) if not _counts(summed):
            yield "sum of floats? math.fsum is exact"
        case ast.Call(ast.Attribute(_, "dot")):
            yield "sums in BLAS's order; see sim.numerics.matrices"
        case ast.Call(ast.Attribute(_, "argpartition")):
            yield "unstable order of equal keys"
        case ast.Call(ast.Attribute(_, "argsort"), _, keywords):
            if not any(each.arg in {"kind", "stable"} for each in keywords):
                yield 'unstable order of equal keys; kind="stable"'
    yield from (f"{each.arg} reorders" for each in node.keywords if each.arg in {"fastmath", "parallel"})


def faults(source: str) -> list[tuple[int, str]]:
    """Lines of a module with arithmetic that depends on the machine, and what it is."""
    tree, lines = ast.parse(source), source.splitlines()
    kernels = {inner for each in ast.walk(tree) if _is_kernel(each) for inner in ast.walk(each)}

    def found(node: ast.AST) -> Iterator[str]:
        match node:
            case ast.BinOp(op=ast.MatMult()) | ast.AugAssign(op=ast.MatMult()):
                yield "sums in BLAS's order; see sim.numerics.matrices"
            case ast.BinOp(base, ast.Pow(), exponent) | ast.AugAssign(base, ast.Pow(), exponent):
                is_written = isinstance(exponent, ast.Constant) and isinstance(exponent.value, int)
                if not (_is_power_of_two(base) or (node in kernels and is_written)):
                    yield "libm's pow; write a product"
            case ast.Call():
                yield from _in_call(node)

    return [
        (node.lineno, what)
        for node in ast.walk(tree)
        for what in found(node)
        if isinstance(node, ast.expr | ast.stmt) and MARK not in lines[(node.end_lineno or node.lineno) - 1]
    ]


def test_arithmetic_of_sessions_is_the_same_on_every_machine() -> None:
    every = [path for folder in ("sim", "thbridge") for path in sorted((ROOT / folder).rglob("*.py"))]
    paths = [path for path in every if not (CARRIERS | AFTERWARDS).intersection(path.parts)]
    assert len(paths) > 300
    assert [
        f"{path.relative_to(ROOT)}:{line}: {what}" for path in paths for line, what in faults(path.read_text())
    ] == []


@pytest.mark.parametrize(
    "line",
    [
        "a @ b",
        "a @= b",
        "a.dot(b)",
        "x**2",
        "x **= 2",
        "0.05**2",
        "2.5**n",
        "pow(x, 2)",
        "sum(costs)",
        "sum(each.cost for each in moves)",
        "np.argsort(x)",
        "x.argsort(axis=0)",
        "np.argpartition(x, 3)",
        "njit(cache=True, fastmath=True)",
        "@njit(cache=True)\ndef f(x, n):\n    return x**n",
        "@njit(cache=True)\ndef f(x):\n    return x**0.5",
    ],
)
def test_arithmetic_that_depends_on_the_machine_is_found(line: str) -> None:
    assert len(faults(line)) == 1


@pytest.mark.parametrize(
    "line",
    [
        "2**n",
        "2.0**-400",
        "10**6",
        "n**2  # of integers",
        "sum(room.points for room in rooms)  # of integers",
        "sum(len(each) for each in found)",
        "sum(each == 1 for each in found)",
        "math.fsum(costs)",
        'np.argsort(x, kind="stable")',
        "@njit(cache=True)\ndef f(x):\n    return x**2",
    ],
)
def test_arithmetic_of_integers_and_in_a_fixed_order_is_let_be(line: str) -> None:
    assert faults(line) == []

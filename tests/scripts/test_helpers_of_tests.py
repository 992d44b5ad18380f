"""What tests share stands in helpers: in tests/support, or in the folder of the tests that use them, or above it."""

import ast
from functools import cache
from pathlib import Path

from tests.support.project import ROOT

SUPPORT = ROOT / "tests" / "support"
FILES = [file for folder in ("tests", "scripts") for file in sorted((ROOT / folder).rglob("*.py"))]


@cache
def imported(file: Path) -> list[Path]:
    """Modules of tests that a file imports, or imports from, without their suffix."""
    found = []
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [alias.name for alias in node.names] if ROOT.joinpath(*node.module.split(".")).is_dir() else []
            found += [f"{node.module}.{name}" for name in names] or [node.module]
    return [ROOT.joinpath(*name.split(".")) for name in found if name.startswith("tests.")]


def test_no_module_imports_a_test_module() -> None:
    assert [str(file) for file in FILES if any(place.name.startswith("test_") for place in imported(file))] == []


def test_helpers_are_near_the_tests_that_use_them_or_in_support() -> None:
    far = [
        (str(file), str(place))
        for file in FILES
        for place in imported(file)
        if ROOT / "tests" in file.parents and place.parent not in file.parents and SUPPORT not in place.parents
    ]
    assert far == []

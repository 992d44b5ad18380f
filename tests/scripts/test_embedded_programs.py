"""Programs that tests hold as text import what there is: no type check reads them, and the slow ones seldom run."""

import ast
import importlib
import re

from tests.support.project import ROOT

OURS = re.compile(r"^\s*from ((?:sim|thbridge|ui|tests)(?:\.\w+)*) import ([\w, ]+)", re.MULTILINE)
MADE = {"sim.caller", "sim.callee"}
"""Modules that a test writes itself."""


def _imports() -> set[tuple[str, str, str]]:
    """File, module and name of each import in a text."""
    return {
        (str(path.relative_to(ROOT)), module, name.split()[0])
        for folder in ("tests", "scripts")
        for path in (ROOT / folder).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        for module, names in OURS.findall(node.value)
        if module not in MADE
        for name in names.split(",")
    }


def _is_there(module: str, name: str) -> bool:
    try:
        if not hasattr(importlib.import_module(module), name):
            importlib.import_module(f"{module}.{name}")
    except ImportError:
        return False
    return True


def test_what_an_embedded_program_imports_is_there() -> None:
    imports = _imports()
    assert len(imports) > 20
    assert [each for each in sorted(imports) if not _is_there(*each[1:])] == []

"""Programs that tests hold as text import what there is: no type check reads them, and the slow ones seldom run."""

import ast
import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OURS = re.compile(r"^\s*from ((?:sim|thbridge|ui|tests)(?:\.\w+)*) import ([\w, ]+)", re.MULTILINE)
MADE = {"sim.caller", "sim.callee"}
"""Modules that a test writes itself."""
IMPORTS = sorted(
    {
        (str(path.relative_to(ROOT)), module, name.split()[0])
        for folder in ("tests", "scripts")
        for path in (ROOT / folder).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        for module, names in OURS.findall(node.value)
        if module not in MADE
        for name in names.split(",")
    }
)


@pytest.mark.parametrize(("file", "module", "name"), IMPORTS)
def test_what_an_embedded_program_imports_is_there(file: str, module: str, name: str) -> None:
    if not hasattr(importlib.import_module(module), name):
        importlib.import_module(f"{module}.{name}")

import ast
from pathlib import Path

import pytest

from sim.numerics.sources import ROOT, key_of, reached


def imported(file: Path) -> set[Path]:
    """Files of `sim` that a file imports, by its syntax tree."""
    modules: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            modules |= {str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)}
    paths = [ROOT.joinpath(*module.split(".")) for module in modules if module.partition(".")[0] == "sim"]
    return {file for path in paths for file in (path.with_suffix(".py"), path / "__init__.py") if file.exists()}


@pytest.mark.parametrize("module", ["team.py", "robot/costmap/obstacle.py", "numerics/noise_arrays.py"])
def test_what_a_file_reaches_is_what_its_syntax_says(module: str) -> None:
    files = reached(ROOT / "sim" / module)
    assert len(files) > 5
    assert not set().union(*map(imported, files)) - files


def test_a_key_belongs_to_one_file() -> None:
    assert key_of(ROOT / "sim/team.py") == key_of(ROOT / "sim/team.py") != key_of(ROOT / "sim/inputs.py")

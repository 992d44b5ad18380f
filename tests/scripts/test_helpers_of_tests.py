"""What tests share stands in helpers: in tests/support, or in the folder of the tests that use them, or above it."""

import re
from functools import cache
from pathlib import Path

from tests.support.project import ROOT

IMPORT = re.compile(r"^\s*(?:from|import) (tests(?:\.\w+)*)(?: import (\([^)]*\)|[^\n]*))?", re.MULTILINE)
SUPPORT = ROOT / "tests" / "support"
FILES = [file for folder in ("tests", "scripts") for file in sorted((ROOT / folder).rglob("*.py"))]


@cache
def imported(file: Path) -> list[Path]:
    """Modules of tests that a file imports, or imports from, without their suffix."""
    found = []
    for module, names in IMPORT.findall(file.read_text(encoding="utf-8")):
        is_folder = ROOT.joinpath(*module.split(".")).is_dir()
        words = re.findall(r"^\s*(\w+)|,\s*(\w+)", names.strip("( \n"), re.MULTILINE)
        inner = [f"{module}.{first or other}" for first, other in words] if is_folder else []
        found += inner or [module]
    return [ROOT.joinpath(*name.split(".")) for name in found]


def test_no_module_imports_a_test_module() -> None:
    # A program that a test holds as text may import that test's own module.
    others = {file: [place for place in imported(file) if place != file.with_suffix("")] for file in FILES}
    assert [str(file) for file, places in others.items() if any(each.name.startswith("test_") for each in places)] == []


def test_helpers_are_near_the_tests_that_use_them_or_in_support() -> None:
    far = [
        (str(file), str(place))
        for file in FILES
        for place in imported(file)
        if ROOT / "tests" in file.parents and place.parent not in file.parents and SUPPORT not in place.parents
    ]
    assert far == []

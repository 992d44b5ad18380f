"""Everything that the windows draw can be read and told apart, and the page that says so is current."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest

from tests.support.project import ROOT
from ui.model.shared.theme import DARK, LIGHT, SIMULATED, Palette

WINDOWS = ROOT / "ui" / "windows"
SPEC = importlib.util.spec_from_file_location("write_contrast", ROOT / "scripts" / "write_contrast.py")
assert SPEC is not None and SPEC.loader is not None
script = importlib.util.module_from_spec(SPEC)
sys.modules["write_contrast"] = script
SPEC.loader.exec_module(script)

PALETTES = pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
ROLE = re.compile(r"(?:palette|colours(?:\(\))?)\.(\w+)")


def roles_named_in(module: Path) -> set[str]:
    """The roles of the palette whose names a module speaks."""
    named = {"robots" if role == "robot" else role for role in ROLE.findall(module.read_text())}
    return named & set(Palette.__slots__)


def roles_in_table(module: str) -> set[str]:
    rows = [f"{pair.inks} {pair.grounds}" for pair in script.PAIRS if pair.module == module]
    rows += [f"{ink} {tint} {ground}" for name, _, ink, tint, _, ground in script.TINTED if name == module]
    return set(" ".join(rows).split())


@PALETTES
def test_every_pair_that_is_drawn_is_seen(palette: Palette) -> None:
    weak = [
        (pair.module, pair.what, round(script.ratio(pair, palette), 2))
        for pair in script.PAIRS
        if script.ratio(pair, palette) < script.LEAST[pair.kind]
    ]
    assert weak == []
    assert all(ratio >= script.LEAST["text"] for *_, ratio in script.tinted(palette))


@PALETTES
@pytest.mark.parametrize("vision", sorted(SIMULATED))
def test_colours_that_tell_something_differ_in_every_eye(palette: Palette, vision) -> None:
    close = {
        told: round(script.apart(palette, roles, vision), 1)
        for told, roles in script.TOLD_APART.items()
        if script.apart(palette, roles, vision) < told[2]
    }
    assert close == {}


def test_every_colour_that_a_window_names_is_in_the_table() -> None:
    modules = {str(path.relative_to(WINDOWS)): roles_named_in(path) for path in WINDOWS.rglob("*.py")}
    assert sum(map(len, modules.values())) > 80, "the pattern finds colours"
    missing = {name: roles - roles_in_table(name) for name, roles in modules.items()}
    assert {name: roles for name, roles in missing.items() if roles} == {}
    assert {pair.module for pair in script.PAIRS} | {module for module, *_ in script.TINTED} <= modules.keys()


def test_what_is_not_seen_well_is_told_somewhere_else() -> None:
    assert all(pair.besides for pair in script.PAIRS if pair.kind == "shown elsewhere")


def test_the_page_is_current() -> None:
    page = ROOT / "docs" / "reference" / "accessibility.md"
    assert page.read_text() == script.page(), "run scripts/write_contrast.py"

"""The pictures of the windows are those that the script draws, and it draws them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "draw" / "windows.py"
PICTURES = ROOT / "docs" / "pictures" / "windows"


@pytest.fixture(scope="module")
def names() -> list[str]:
    listed = subprocess.run([sys.executable, SCRIPT, "--list"], check=True, capture_output=True, text=True, cwd="/")
    return listed.stdout.split()


@pytest.mark.slow
def test_the_pictures_are_those_that_the_script_draws_and_the_gallery_shows_all(names: list[str]) -> None:
    gallery = (ROOT / "docs" / "reference" / "windows-gallery.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"!\[[^]]*]\(\.\./pictures/windows/(.*?)\)", gallery))
    assert {file.name for file in PICTURES.iterdir()} == shown
    assert {f"{name}-{look}.png" for name in names for look in ("light", "dark")} <= shown


@pytest.mark.slow
def test_a_window_is_drawn_light_and_dark_and_the_important_ones_at_all_sizes(tmp_path: Path) -> None:
    command = [sys.executable, SCRIPT, "--only", "start", "connecting", "--into", tmp_path]
    subprocess.run(command, check=True, capture_output=True, cwd="/")
    light, dark = (Image.open(tmp_path / f"connecting-{look}.png").convert("L") for look in ("light", "dark"))
    assert light.size == dark.size == (1200, 800)
    assert light.getpixel((5, 5)) > 200 > 60 > dark.getpixel((5, 5))
    for text in (100, 125, 150):
        for size in ((800, 500), (1024, 600), (1366, 768), (1920, 1080)):
            assert Image.open(tmp_path / f"start-{size[0]}x{size[1]}-{text}.png").size == size
    assert len(list(tmp_path.iterdir())) == 4 + 12

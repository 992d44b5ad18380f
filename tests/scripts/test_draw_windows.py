"""The pictures of the windows are those that the script draws, and it draws them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts" / "draw_windows.py"
PICTURES = ROOT / "docs" / "pictures" / "windows"


@pytest.fixture(scope="module")
def names() -> list[str]:
    listed = subprocess.run([sys.executable, SCRIPT, "--list"], check=True, capture_output=True, text=True, cwd="/")
    return listed.stdout.split()


def test_the_pictures_are_those_that_the_script_draws(names: list[str]) -> None:
    drawn = {f"{name}-{look}-{scale}.png" for name in names for look in ("light", "dark") for scale in (100, 200)}
    assert {file.name for file in PICTURES.iterdir()} == drawn


def test_the_gallery_shows_all_of_them(names: list[str]) -> None:
    gallery = (ROOT / "docs" / "windows-gallery.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"pictures/windows/(.*?)-light-100\.png", gallery))
    assert shown == set(names)


def test_a_window_is_drawn_light_and_dark(tmp_path: Path) -> None:
    command = [sys.executable, SCRIPT, "--only", "connecting", "--scale", "200", "--into", tmp_path]
    # With Qt's scale as it has to be, the script draws itself, and starts no other process for it.
    environment = {**os.environ, "QT_SCALE_FACTOR": "2.0"}
    subprocess.run(command, check=True, capture_output=True, cwd="/", env=environment)
    light, dark = (Image.open(tmp_path / f"connecting-{look}-200.png").convert("L") for look in ("light", "dark"))
    assert light.size == dark.size == (2400, 1600)
    assert light.getpixel((5, 5)) > 200 > 60 > dark.getpixel((5, 5))

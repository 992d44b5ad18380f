"""Draw every window and dialogue, and the page that shows them, `docs/windows-gallery.md`.

The pictures are `docs/pictures/windows/<name>-<light|dark>-<100|200>.png`. Run it from the project's folder:
`.venv/bin/python scripts/draw_windows.py`. What is shown are real games and a real recording, made on the spot in
simulated time; nothing appears on a screen. The same code, fonts and Qt give the same pictures. The typeface is Inter,
as everywhere (Debian: fonts-inter).
"""

import argparse
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from pictured.shot import Shot, Story
from pictured.shrinking import shrunk
from pictured.stories import STORIES
from PIL import Image
from PySide6.QtCore import QBuffer
from PySide6.QtWidgets import QApplication, QWidget

from ui.model.theme import DARK, LIGHT
from ui.windows.look import apply_palette

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures" / "windows"
GALLERY = ROOT / "docs" / "windows-gallery.md"
SCALES = (100, 200)
"""Scales, per cent. Qt takes one for a process, so that each has a process of its own."""
ABOUT = (
    "Light and dark at 100 %; a click on a picture shows it at 200 %. `make pictures` draws them from real games and a",
    "real recording, and writes this page. What is seen in them is explained in [windows.md](windows.md),",
    "[watching.md](watching.md) and [study-edit.md](study-edit.md).",
)
SCREEN = (1920, 1080)
"""Width and height of the screen, logical pixels; windows keep within it. That of `offscreen` is 800 x 800."""
SETTLE_TIMEOUT = 10.0
"""Seconds that a window may need to come to rest."""


def screen_at(scale: int) -> dict[str, int]:
    """Return a screen on which all windows have the size that they want, in the words of Qt's platform `offscreen`."""
    width, height = (side * scale // 100 for side in SCREEN)
    return {"x": 0, "y": 0, "width": width, "height": height, "logicalDpi": 96, "logicalBaseDpi": 96, "dpr": 1}


def draw(into: Path, scale: int, wanted: frozenset[str]) -> None:
    """Draw the pictures with these names at the scale that Qt was started with."""
    application = QApplication([])
    apply_palette(application, LIGHT)
    application.setCursorFlashTime(0)
    for story in STORIES:
        if not wanted.intersection(story.pictures):
            continue
        last = [name for name in story.pictures if name in wanted][-1]
        for shot in story.tell():
            for look, palette in (("light", LIGHT), ("dark", DARK)):
                if shot.name not in wanted:
                    continue
                apply_palette(application, palette)
                shot.wear(palette)
                settle(application, shot)
                small = shrunk(grabbed(shot))
                (into / f"{shot.name}-{look}-{scale}.png").write_bytes(small)
                print(f"{shot.name}-{look}-{scale}.png", len(small) // 1000, "kB", flush=True)
            apply_palette(application, LIGHT)
            shot.wear(LIGHT)
            if shot.name == last:
                break


def settle(application: QApplication, shot: Shot) -> None:
    """Wait until the window has come to rest. Raises TimeoutError when it does not."""
    end = time.monotonic() + SETTLE_TIMEOUT
    # A window looks at its model each frame; the layout follows, and then what is drawn into it.
    calm = 0
    while calm < 12:
        if time.monotonic() > end:
            raise TimeoutError(f"{shot.name} does not come to rest")
        time.sleep(0.01)
        application.processEvents()
        calm = calm + 1 if shot.settled() else 0


def grabbed(shot: Shot) -> Image.Image:
    """Return the window as an image, with the dialogue above its middle."""
    picture = image_of(shot.window)
    if shot.over is not None:
        above = image_of(shot.over)
        framed = Image.new("RGB", (above.width + 2, above.height + 2), "#7f7f7f")
        framed.paste(above, (1, 1))
        dimmed = Image.blend(picture, Image.new("RGB", picture.size, "#000000"), 0.25)
        dimmed.paste(framed, ((picture.width - framed.width) // 2, (picture.height - framed.height) // 2))
        picture = dimmed
    return picture


def image_of(widget: QWidget) -> Image.Image:
    """Return a widget as an image."""
    buffer = QBuffer()
    buffer.open(QBuffer.OpenModeFlag.WriteOnly)
    widget.grab().save(buffer, "PNG")
    return Image.open(io.BytesIO(buffer.data().data())).convert("RGB")


def gallery(stories: Sequence[Story]) -> str:
    """Return the page that shows all pictures."""
    lines = ["# The windows in pictures", "", *ABOUT]
    for story in stories:
        lines += ["", f"## {story.title}"]
        for name, caption in story.pictures.items():
            files = [f"pictures/windows/{name}-{look}" for look in ("light", "dark")]
            shown = [f"[![{caption}]({file}-100.png)]({file}-200.png)" for file in files]
            lines += ["", f"{caption}:", "", "| light | dark |", "|---|---|", f"| {shown[0]} | {shown[1]} |"]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--into", type=Path, default=PICTURES, help="the folder")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="draw these and no others")
    parser.add_argument("--list", action="store_true", help="say the names of all pictures, and draw none")
    parser.add_argument("--scale", type=int, choices=SCALES, help="per cent; both by default")
    options = parser.parse_args()
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    known = [name for story in STORIES for name in story.pictures]
    if options.list:
        print("\n".join(known))
        return
    unknown = set(options.only or ()) - set(known)
    if unknown:
        parser.error(f"there are no pictures called {', '.join(sorted(unknown))}; --list says which there are")
    options.into.mkdir(parents=True, exist_ok=True)
    if os.environ.get("QT_SCALE_FACTOR") != str((options.scale or 0) / 100):
        for scale in SCALES if options.scale is None else (options.scale,):
            environment = {**os.environ, "QT_SCALE_FACTOR": str(scale / 100)}
            command = [sys.executable, *sys.argv, "--scale", str(scale)]
            subprocess.run(command, env=environment, check=True)
        if options.into == PICTURES and not options.only:
            GALLERY.write_text(gallery(STORIES), encoding="utf-8")
        return
    with tempfile.TemporaryDirectory() as folder:
        screen = Path(folder) / "screen.json"
        screen.write_text(json.dumps({"screens": [screen_at(options.scale)]}), encoding="utf-8")
        os.environ["QT_QPA_PLATFORM"] = f"offscreen:configfile={screen}"
        draw(options.into, options.scale, frozenset(options.only or known))


if __name__ == "__main__":
    main()

"""Draw every window and dialog, and write the page with the pictures, `docs/reference/windows-gallery.md`.

Run this script from the project's folder: `.venv/bin/python scripts/draw/windows.py`. The pictures are
`docs/pictures/windows/<name>-<light|dark>.png`. Pictures of `SIZED` are also drawn at four sizes with three sizes of
text, as `<name>-<width>x<height>-<text>.png`. The pictures show real games and a real recording, which the script makes
in simulated time. No window appears on the screen. The same code, fonts and Qt give the same pictures. The typeface is
Inter, as in the windows (Debian: fonts-inter).
"""

import argparse
import io
import json
import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from pictured import language
from pictured.shot import Shot, Story
from pictured.shrinking import shrunk
from pictured.stories import STORIES
from PIL import Image
from PySide6.QtCore import QBuffer, QSize
from PySide6.QtWidgets import QApplication, QWidget

from thbridge.files.language_texts import ENGLISH
from ui.model.shared.theme import DARK, LIGHT, Palette
from ui.windows.application import application as open_application
from ui.windows.look import apply_palette, apply_text_size, usual_growth

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "pictures" / "windows"
GALLERY = ROOT / "docs" / "reference" / "windows-gallery.md"
SIZES = ((800, 500), (1024, 600), (1366, 768), (1920, 1080))
"""Widths and heights of windows, logical pixels."""
TEXTS = (100, 125, 150)
"""Sizes of text, percent of the normal size on a screen that is as large as the window."""
SIZED = (
    *("start", "consent", "practice", "begin", "talk", "treasure", "picture", "verdict-wrong", "playing", "queue"),
    *("help", "over", "six-robots", "recording", "live-wizard", "study-section", "study-noise"),
    *("properties", "argue-questions", "argue-found", "argue-adviser", "arena", "templates-treasures", "desk"),
    *("kiosk-form", "kiosk-consent"),
)
"""Pictures that are drawn at all sizes."""
ABOUT = (
    "For everyone who wants to see a window before using it.",
    "",
    "Each window in light and dark colors; the most important windows at four sizes with text of 100, 125 and 150 %.",
    "`make pictures` draws them from real games and a real recording, and writes this page. The windows are",
    "explained in [windows.md](windows.md), [watching.md](../how-to/watching.md),",
    "[study-edit.md](../how-to/study-edit.md) and the pages *Your own ...*.",
)
SCREEN = (1920, 1080)
"""Width and height of the screen, logical pixels, which limit all windows. The default of `offscreen` is 800 x 800."""
SETTLE_TIMEOUT = 120.0
"""Timeout for a window to settle, seconds."""


def draw(into: Path, wanted: frozenset[str], palette: Palette) -> None:
    """Draw the pictures with these names. Pictures at all sizes have this palette."""
    application = open_application()
    apply_palette(application, LIGHT)
    application.setCursorFlashTime(0)
    for story in STORIES:
        if not wanted.intersection(story.pictures):
            continue
        last = [name for name in story.pictures if name in wanted][-1]
        for shot in story.shots():
            if shot.name in wanted:
                draw_looks(into, shot, application)
            if shot.name in wanted.intersection(SIZED):
                draw_sizes(into, shot, application, palette)
            if shot.name == last:
                break


def draw_looks(into: Path, shot: Shot, application: QApplication) -> None:
    """Draw a state in light and in dark colors."""
    for look, palette in (("dark", DARK), ("light", LIGHT)):
        apply_palette(application, palette)
        shot.wear(palette)
        save(into / f"{shot.name}-{look}.png", shot, application)


def draw_sizes(into: Path, shot: Shot, application: QApplication, palette: Palette) -> None:
    """Draw a state at all sizes."""
    before = shot.window.size()
    apply_palette(application, palette)
    shot.wear(palette)
    for text in TEXTS:
        for size in SIZES:
            apply_text_size(application, text / 100 * usual_growth(QSize(*size)))
            shot.window.resize(*size)
            save(into / sized(shot.name, size, text), shot, application)
    apply_text_size(application, 1.0)
    shot.window.resize(before)
    apply_palette(application, LIGHT)
    shot.wear(LIGHT)


def sized(name: str, size: tuple[int, int], text: int) -> str:
    """Return the file name of a picture at a size."""
    return f"{name}-{size[0]}x{size[1]}-{text}.png"


def save(file: Path, shot: Shot, application: QApplication) -> None:
    """Wait until a window has settled, and write its picture."""
    settle(application, shot)
    small = shrunk(grabbed(shot))
    file.write_bytes(small)
    print(file.name, len(small) // 1000, "kB", flush=True)


def settle(application: QApplication, shot: Shot) -> None:
    """Wait until the window has settled. Raise TimeoutError at the end of the timeout."""
    end = time.monotonic() + SETTLE_TIMEOUT
    # In each frame, a window reads its model, then changes its layout, and then paints itself.
    calm = 0
    while calm < 12:
        if time.monotonic() > end:
            raise TimeoutError(f"{shot.name} does not settle")
        time.sleep(0.01)
        application.processEvents()
        calm = calm + 1 if shot.settled() else 0


def grabbed(shot: Shot) -> Image.Image:
    """Return the window as an image; if there is a dialog, it is over the middle of the window."""
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
            shown = [f"![{caption}](../pictures/windows/{name}-{look}.png)" for look in ("light", "dark")]
            lines += ["", f"{caption}:", "", "| light | dark |", "|---|---|", f"| {shown[0]} | {shown[1]} |"]
            if name in SIZED:
                lines += ["", *table_of_sizes(name, caption)]
    return "\n".join(lines) + "\n"


def table_of_sizes(name: str, caption: str) -> list[str]:
    """Return the lines that show a state at all sizes."""
    heads = [f"{width} x {height}" for width, height in SIZES]
    lines = [f"| text | {' | '.join(heads)} |", "|---|" + "---|" * len(SIZES)]
    for text in TEXTS:
        files = [f"../pictures/windows/{sized(name, size, text)}" for size in SIZES]
        shown = [f"[![{caption}, {head}]({file})]({file})" for head, file in zip(heads, files, strict=True)]
        lines.append(f"| {text} % | {' | '.join(shown)} |")
    return lines


def main() -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--into", type=Path, default=PICTURES, help="output folder (default docs/pictures/windows)")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="draw only these pictures")
    parser.add_argument(
        "--language", default=ENGLISH, help="language of participants' windows (default en); others require --into"
    )
    parser.add_argument("--dark", action="store_true", help="draw the pictures at all sizes in dark colors")
    parser.add_argument("--list", action="store_true", help="list the names of all pictures, and exit")
    options = parser.parse_args()
    known = [name for story in STORIES for name in story.pictures]
    if options.list:
        print("\n".join(known))
        return
    unknown = set(options.only or ()) - set(known)
    if unknown:
        parser.error(f"unknown pictures: {', '.join(sorted(unknown))}. Run with --list for all names")
    if options.into == PICTURES and (options.language != ENGLISH or options.dark):
        parser.error("the gallery shows English and light windows; choose another folder with --into")
    language.speak(options.language)
    options.into.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        width, height = SCREEN
        screen = {"x": 0, "y": 0, "width": width, "height": height, "logicalDpi": 96, "logicalBaseDpi": 96, "dpr": 1}
        file = Path(folder) / "screen.json"
        file.write_text(json.dumps({"screens": [screen]}), encoding="utf-8")
        os.environ["QT_QPA_PLATFORM"] = f"offscreen:configfile={file}"
        draw(options.into, frozenset(options.only or known), DARK if options.dark else LIGHT)
    if options.into == PICTURES and not options.only:
        GALLERY.write_text(gallery(STORIES), encoding="utf-8")


if __name__ == "__main__":
    main()

"""Draw the pages of the browser, and write the page with the pictures, `docs/reference/pages-gallery.md`.

Run this script from the project's folder: `.venv/bin/python scripts/draw/pages.py`. It needs Debian's Chromium. The
pages show the states of the windows' pictures (`windows.py`), and states that only a browser has, in the real gateway.
Each picture in `docs/pictures/pages` shows the states of one group side by side, at one width, in light or dark colors.
"""

import argparse
import io
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from pictured import kiosk, language, participant  # noqa: E402
from pictured.pages import BROWSER_ONLY, GROUPS, state_of  # noqa: E402

from tests.support.programs.chromium import Chromium  # noqa: E402
from tests.support.programs.shown_pages import PageState, StateServer  # noqa: E402
from ui.windows.application import application as open_application  # noqa: E402

PICTURES = ROOT / "docs" / "pictures" / "pages"
GALLERY = ROOT / "docs" / "reference" / "pages-gallery.md"
SIZES = {390: (844, 1.0, 4), 1024: (768, 0.5, 3), 1440: (900, 0.5, 2)}
"""Width of the page to its height, the scale of pictures that show a group, and pages next to each other."""
LOOKS = ("light", "dark")
GAP = 12
SHOWN = (
    "document.querySelector('#main > article:not(#first), #main > .game, #connection:not([hidden]),"
    " #trouble:not([hidden])') !== null"
)
SETTLED = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 80))))"
ABOUT = (
    "For everyone who wants to see what a participant sees in a browser.",
    "",
    "Each picture shows several states at one width, in light or dark colors: 390 pixels as on a phone, 1024 as on a",
    "tablet, and 1440 as on a laptop. `scripts/draw/pages.py` draws them in Chromium from the states of the",
    "[windows' pictures](windows-gallery.md), and writes this page.",
    "[Serve games to browsers](../how-to/serve-browsers.md) explains how people get there.",
)


def states(wanted: frozenset[str]) -> Iterator[PageState]:
    """Yield the wanted states."""
    bases = {base for name, (base, _) in BROWSER_ONLY.items() if name in wanted}
    for story in (*participant.STORIES, *kiosk.STORIES):
        if not (wanted | bases).intersection(story.pictures):
            continue
        for shot in story.shots():
            state = state_of(shot)
            if state is None:
                continue
            if shot.name in wanted:
                yield state
            for name, (base, change) in BROWSER_ONLY.items():
                if base == shot.name and name in wanted:
                    yield replace(change(state), name=name)


def drawn(browser: Chromium, server: StateServer, state: PageState, width: int, text: int) -> dict[str, Image.Image]:
    """Return the pictures of a state at one width, by their look."""
    server.state = state
    browser.resize(width, SIZES[width][0], touch=width < 500)
    browser.prefer(still=True)
    # The settings of the page change the size of its text.
    size = f"localStorage.setItem('size', {text});"
    browser.open(server.address, size + state.before, state.blocked)
    browser.until(SHOWN)
    browser.evaluate(SETTLED)
    if state.deed:
        browser.evaluate(f"new Promise((done) => setTimeout(() => {{ {state.deed}; setTimeout(done, 200); }}, 450))")
    pictures = {}
    for look in LOOKS:
        browser.prefer(dark=look == "dark", still=True)
        browser.evaluate(SETTLED)
        pictures[look] = Image.open(io.BytesIO(browser.picture())).convert("RGB")
    return pictures


def sheet(pictures: list[Image.Image], width: int, look: str) -> Image.Image:
    """Return the pictures of a group side by side."""
    _, scale, columns = SIZES[width]
    small = [
        picture.resize([round(scale * side) for side in picture.size], Image.Resampling.LANCZOS) for picture in pictures
    ]
    wide, high = small[0].size
    columns = min(columns, len(small))
    rows = -(-len(small) // columns)
    size = columns * (wide + GAP) + GAP, rows * (high + GAP) + GAP
    whole = Image.new("RGB", size, "#9aa3b0" if look == "light" else "#4a5260")
    for at, picture in enumerate(small):
        whole.paste(picture, (GAP + at % columns * (wide + GAP), GAP + at // columns * (high + GAP)))
    return whole


def gallery() -> str:
    """Return the page that shows all pictures."""
    lines = ["# The browser's pages in pictures", "", *ABOUT]
    for slug, (title, shown) in GROUPS.items():
        captions = "; ".join(f"{number}. {caption}" for number, caption in enumerate(shown.values(), start=1))
        lines += [
            "",
            f"## {title}",
            "",
            f"From left to right: {captions}.",
            "",
            "| width | light | dark |",
            "|---|---|---|",
        ]
        for width in SIZES:
            files = [f"../pictures/pages/{slug}-{width}-{look}.webp" for look in LOOKS]
            lines.append(
                f"| {width} | " + " | ".join(f"[![{title}, {width}]({file})]({file})" for file in files) + " |"
            )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--into", type=Path, help="folder for single pictures of states (default: the gallery's pictures)"
    )
    parser.add_argument("--only", nargs="+", metavar="NAME", help="draw only these groups or states")
    parser.add_argument("--widths", nargs="+", type=int, choices=SIZES, default=list(SIZES), help="widths in pixels")
    parser.add_argument("--language", default="en", help="language (default en); others require --into")
    parser.add_argument("--text", type=int, default=100, help="size of the text in percent (default 100)")
    parser.add_argument("--list", action="store_true", help="list the names of all groups and states, and exit")
    options = parser.parse_args()
    if options.list:
        print("\n".join(f"{slug}: {' '.join(shown)}" for slug, (_, shown) in GROUPS.items()))
        return
    if options.into is None and (options.language != "en" or options.text != 100):
        parser.error(
            "the gallery shows English pages with text of 100 %; choose a folder for other pictures with --into"
        )
    language.speak(options.language, in_browser=True)
    only = frozenset(options.only or GROUPS)
    groups = {
        slug: [name for name in shown if slug in only or name in only]
        for slug, (_, shown) in GROUPS.items()
        if slug in only or only.intersection(shown)
    }
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    open_application()
    (options.into or PICTURES).mkdir(parents=True, exist_ok=True)
    made: dict[tuple[str, int, str], Image.Image] = {}
    with StateServer(language.texts()).running() as server, Chromium() as browser:
        for state in states(frozenset(name for names in groups.values() for name in names)):
            for width in options.widths:
                for look, picture in drawn(browser, server, state, width, options.text).items():
                    made[state.name, width, look] = picture
                    if options.into is not None:
                        picture.save(options.into / f"{state.name}-{width}-{look}.png")
            print(state.name, flush=True)
    if options.into is not None:
        return
    for slug, names in groups.items():
        for width in options.widths:
            for look in LOOKS:
                whole = sheet([made[name, width, look] for name in names], width, look)
                whole.save(PICTURES / f"{slug}-{width}-{look}.webp", quality=55, method=6)
    if not options.only:
        GALLERY.write_text(gallery(), encoding="utf-8")


if __name__ == "__main__":
    main()

"""Write `docs/reference/accessibility.md`: every pair of colors that the windows draw, and how well it is seen.

python scripts/write_contrast.py [FILE]
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Literal

from ui.model.shared.theme import DARK, LIGHT, SIMULATED, Palette, Vision, contrast, difference

ROOT = Path(__file__).parents[1]

Kind = Literal["text", "sign", "told besides"]

LEAST: dict[Kind, float] = {"text": 4.5, "sign": 3.0, "told besides": 0.0}
"""WCAG 2.2, AA: 1.4.3 for text, 1.4.11 for edges and signs."""

APART = 15.0
"""Least distance (CIE76) in everybody's eyes of colors that distinguish things; 2.3 is just noticed."""

FLOORS = "unvisited reserved visited won lost"
GROUNDS = f"window panel floor {FLOORS}"


@dataclass(frozen=True, slots=True)
class Pair:
    """Colors drawn on other colors.

    Attributes:
        module: path in ui/windows.
        what: the thing drawn.
        inks: roles of the palette, "robots" for all of theirs; each may be seen.
        grounds: roles that may be below.
        kind: how well it has to be seen; "told besides" where nothing depends on it, for the reason in `besides`.
        opacity: of the ink, 0 to 1.
        besides: where else its information is found.
    """

    module: str
    what: str
    inks: str
    grounds: str
    kind: Kind = "text"
    opacity: float = 1.0
    besides: str = ""


PAIRS = (
    Pair("look.py", "words of labels, buttons, lists, tool tips", "text", "window panel track"),
    Pair("look.py", "lesser words, placeholders, what cannot be pressed", "muted", "window panel track"),
    Pair("look.py", "trouble", "bad", "window panel"),
    Pair("look.py", "main button, selected rows", "on_accent", "accent"),
    Pair("look.py", "links", "accent", "window panel"),
    Pair("look.py", "edges of buttons and lists, handles of scroll bars", "line", "window panel track", "sign"),
    Pair("look.py", "ring of the focus", "accent text", "window panel", "sign"),
    Pair("look.py", "shadow of the style", "wall", "window", "told besides", besides="it says nothing"),
    Pair("controls.py", "arrow of a list to choose from that is closed to use", "muted", "window panel", "sign"),
    Pair("controls.py", "tick of a box", "on_accent", "accent", "sign"),
    Pair("controls.py", "tick of a box that cannot be changed", "panel", "muted line", "sign"),
    Pair("kiosk/items/line.py", "line and its mark on a scale", "muted accent", "panel", "sign"),
    Pair("kiosk/items/line.py", "edge of the mark", "panel", "accent", "told besides", besides="the mark itself"),
    Pair("kiosk/items/panel.py", "ring of the item with the focus", "accent", "window", "sign"),
    Pair("participant/history.py", "what was said", "text muted", "panel"),
    Pair("participant/pages/pages.py", "keys on the sheet of help", "text", "panel"),
    Pair("participant/top.py", "banner of a note", "text", "panel"),
    Pair("participant/top.py", "banner of trouble", "panel", "bad"),
    Pair("participant/top.py", "edge of the banner", "line bad", "window", "sign"),
    Pair("participant/cards.py", "name, state, who else commands it, mast, energy", "text", "panel track"),
    Pair("participant/cards.py", "place, key", "muted", "panel track"),
    Pair("participant/cards.py", "trouble, energy that does not suffice", "bad", "panel track"),
    Pair("participant/cards.py", "edge, also of the selected", "accent line", "window panel", "sign"),
    Pair("participant/cards.py", "ring of the focus", "text accent", "panel track", "sign"),
    Pair("participant/cards.py", "how many things wait", "on_accent", "accent"),
    Pair("participant/cards.py", "energy and progress on what is used up", "robots", "track", "sign"),
    Pair("participant/cards.py", "hatched part of the energy", "robots bad", "panel", "sign"),
    Pair("participant/score.py", "score", "text muted", "window"),
    Pair("participant/score.py", "points won and lost", "good bad", "window"),
    Pair("participant/widgets/buttons.py", "words", "text", "panel track"),
    Pair("participant/widgets/buttons.py", "key, hint, what cannot be pressed", "muted", "panel track"),
    Pair("participant/widgets/buttons.py", "main button", "on_accent", "accent"),
    Pair("participant/widgets/buttons.py", "edge", "line accent", "window panel", "sign"),
    Pair("participant/widgets/buttons.py", "ring of the focus", "accent", "panel track", "sign"),
    Pair("participant/popups/finding.py", "colour, footprint, verdict", "text good bad", "panel"),
    Pair("participant/popups/finding.py", "names of the figures, place of the picture", "muted", "panel track"),
    Pair("participant/popups/finding.py", "edges of picture and swatch", "line", "panel", "sign"),
    Pair("participant/popups/finding.py", "edge of a picture pointed at, ring of the focus", "accent", "panel", "sign"),
    Pair("participant/widgets/panels.py", "what was said", "text", "track"),
    Pair("participant/widgets/panels.py", "what was said before", "muted", "track"),
    Pair("participant/widgets/panels.py", "who said it", "robots accent", "panel track", "sign"),
    Pair("participant/widgets/painting.py", "robot's chip", "robots", GROUNDS, "sign"),
    Pair("participant/waiting.py", "what waits", "text", "panel track"),
    Pair("participant/waiting.py", "its key", "muted", "panel track"),
    Pair("participant/waiting.py", "its edge", "accent", "window panel track", "sign"),
    Pair("participant/tiles.py", "room, cost, sign, ring of the focus", "text", FLOORS),
    Pair("participant/tiles.py", "name; a room that cannot be chosen", "muted", FLOORS),
    Pair("participant/tiles.py", "edge", "accent line", f"window panel {FLOORS}", "sign"),
    Pair("map/ground.py", "walls", "wall", f"floor unknown {FLOORS}", "sign"),
    Pair("map/scale_bar.py", "scale", "muted", "panel"),
    Pair("map/view.py", "numbers at the axes", "muted", "window"),
    Pair("map/view.py", "axes", "line", "window", "sign"),
    Pair("map/rooms.py", "number", "text", f"floor {FLOORS}"),
    Pair("map/rooms.py", "name", "muted", f"floor {FLOORS}"),
    Pair("map/rooms.py", "frame of a room to choose or looked at", "accent", FLOORS, "sign"),
    Pair("map/rooms.py", "what was found", "text", "panel"),
    Pair("map/rooms.py", "its edge, sign of state", "line robots", f"panel {FLOORS}", "sign"),
    Pair("map/rooms.py", "dot, tick or cross of a visited room", "panel", "line robots", "sign"),
    Pair(
        "map/rooms.py",
        "stripes and dots of the floor",
        "text",
        "reserved visited won lost",
        "told besides",
        46 / 255,
        "the room's sign: circle, arrows, dot, tick, cross",
    ),
    Pair("map/badges.py", "robot's number, who else commands it, mast", "text", "panel"),
    Pair("map/badges.py", "the same of the selected robot", "panel", "robots"),
    Pair("map/badges.py", "edge of the label", "robots", f"panel floor {FLOORS}", "sign"),
    Pair("map/badges.py", "warning sign", "bad", "panel", "sign"),
    Pair("map/badges.py", "the mark in it", "panel", "bad"),
    Pair("map/robots.py", "robot, way ahead, outline of its ellipse", "robots", f"floor {FLOORS}", "sign"),
    Pair("map/robots.py", "nose", "panel", "robots", "sign"),
    Pair("map/robots.py", "where it really is", "text", f"floor {FLOORS}", "sign"),
    Pair("map/robots.py", "ring of the selected", "accent", "panel", "sign"),
    Pair("map/robots.py", "trail, at its newest", "robots", f"floor {FLOORS}", "told besides", 0.5, "it drove there"),
    Pair("map/robots.py", "inside of the ellipse", "robots", "floor", "told besides", 40 / 255, "its outline"),
    Pair("researcher/map/overlays.py", "scans, plans, goals", "robots", f"floor {FLOORS}", "sign"),
    Pair("arena/window.py", "lines that were left out of a plan", "accent", "floor", "sign"),
    Pair("arena/marks.py", "outlines, goals and start poses", "text accent bad", f"panel floor {FLOORS}", "sign"),
    Pair("researcher/map/preview.py", "what a tool is about to do", "accent", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "things in the way", "bad", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "their names", "text", f"floor {FLOORS}"),
    Pair("researcher/map/overlays.py", "paths", "robots", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "particles of the selected robot", "text", f"floor {FLOORS}", "sign", 0.6),
    Pair("researcher/docks/playback.py", "time to come, time past", "line accent", "window panel", "sign"),
    Pair("researcher/docks/playback.py", "marks", "muted robots", "window panel", "sign"),
    Pair("researcher/docks/playback.py", "bookmarks", "text", "window panel", "sign"),
    Pair("researcher/docks/topics.py", "boxes", "text accent", "panel", "sign"),
    Pair("researcher/docks/log.py", "who", "robots", "panel"),
    Pair("researcher/docks/log.py", "rows still to come, times", "muted", "panel"),
    Pair("tables.py", "times", "muted", "panel"),
    Pair("researcher/docks/attack_graph.py", "number and tick of an argument", "text", "panel"),
    Pair("researcher/docks/attack_graph.py", "edges of arguments, attacks", "text line good", "window panel", "sign"),
    Pair("researcher/docks/team.py", "robot in trouble", "bad", "panel"),
    Pair("researcher/docks/team.py", "robot's chip in its edge", "robots", "panel", "sign"),
    Pair("researcher/docks/team.py", "that edge in a row that is selected", "panel", "accent", "sign"),
    Pair("researcher/docks/plots.py", "titles", "text", "panel"),
    Pair("researcher/docks/plots.py", "numbers", "muted", "panel"),
    Pair("researcher/docks/plots.py", "axes, the moment shown", "line accent", "panel", "sign"),
    Pair("researcher/docks/plots.py", "curve of the selected robot", "robots", "panel", "sign"),
    Pair("researcher/docks/plots.py", "the other curves", "robots", "panel", "told besides", 0.55, "select its robot"),
    Pair(
        "researcher/docks/plots.py",
        "two standard deviations",
        "robots",
        "panel",
        "told besides",
        0.18,
        "the plot below",
    ),
    Pair("editing/changes.py", "lines that a change adds, takes away", "good bad muted", "panel"),
    Pair("study/pictures.py", "paths driven and believed, walls", "text wall robots", "panel", "sign"),
    Pair("study/pictures.py", "ruler", "muted", "panel"),
    Pair("study/pictures.py", "beams", "line", "panel", "told besides", 70 / 255, "the crosses at their ends"),
    Pair("study/window.py", "edges of fields, ring of the focus", "line accent", "window panel", "sign"),
)
"""All pairs of colors. Faults in the text of a study have a tinted ground, too; see `TINTED`."""

TINTED = (("study/pages.py", "text on the line of a fault", "text", "bad", 48 / 255, "panel"),)
"""Module, what it is, its ink; the ground: a color, its opacity, and what is below it."""

HEAD = """\
# Who can see and use the windows

`scripts/write_contrast.py` writes this page out of the windows' palettes (`ui/model/shared/theme.py`). Ratios are those
of WCAG 2.2: level AA wants 4.5 for text (1.4.3), 3 for edges, signs and curves (1.4.11). Each row shows the worst of
its pairs; where a robot's colour is one of them, the worst of ten. *Told besides*: nothing rests on it, because the
same is said elsewhere.

All that can be done can be done by keyboard; every part has a name that screen readers say; the focus goes through
each part of a window as the eye does, from top to bottom and from left to right (`tests/ui/windows`). Nothing is told
by colour alone: rooms have signs and patterns, robots have numbers, trouble has a warning sign and words, what cannot
be pressed has a dashed edge and says why. Text is made larger and smaller from 80 to 200 % (1.4.4), and windows fit a
screen of 1024 x 600 with each of these sizes.
"""


def mixed(ink: str, opacity: float, ground: str) -> str:
    """Return the color seen of an ink through which the ground shows."""
    channels = (
        round(opacity * int(ink[at : at + 2], 16) + (1.0 - opacity) * int(ground[at : at + 2], 16)) for at in (1, 3, 5)
    )
    return "#" + "".join(f"{channel:02x}" for channel in channels)


def colours(palette: Palette, roles: str) -> list[str]:
    """Return the colors of some roles."""
    found: list[str] = []
    for role in roles.split():
        colour = getattr(palette, role)
        found += [colour] if isinstance(colour, str) else colour
    return found


def ratio(pair: Pair, palette: Palette) -> float:
    """Return the worst contrast of a pair."""
    return min(
        contrast(mixed(ink, pair.opacity, ground), ground)
        for ink in colours(palette, pair.inks)
        for ground in colours(palette, pair.grounds)
    )


def tinted(palette: Palette) -> Iterator[tuple[str, str, float]]:
    """Return module, thing and contrast of each text on a tinted ground."""
    for module, what, ink, tint, opacity, ground in TINTED:
        below = mixed(getattr(palette, tint), opacity, getattr(palette, ground))
        yield module, what, contrast(getattr(palette, ink), below)


ReportedPair = tuple[str, str, float]
"""Things distinguished by colors, by what besides, and the least distance of these colors (CIE76)."""

TOLD_APART: dict[ReportedPair, tuple[str, ...]] = {
    ("robots", "numbers", APART): ("robots",),
    ("points won from points lost", "+ and -, words", APART): ("good", "bad"),
    ("what the robot has, from what it has not enough of", "hatching, words", APART): ("text", "bad"),
    ("the selected card from others", "width of the edge", APART): ("accent", "line"),
    ("states of rooms", "signs, patterns, words", 6.0): tuple(FLOORS.split()),
}


def apart(palette: Palette, roles: tuple[str, ...], vision: Vision) -> float:
    """Return the least difference among the colors of some roles."""
    return min(difference(a, b, vision) for a, b in combinations(colours(palette, " ".join(roles)), 2))


def page() -> str:
    """Return the whole page."""
    lines = [HEAD, "## Contrast", "", "| where | what | on | wants | light | dark |", "|---|---|---|---|---|---|"]
    for pair in PAIRS:
        wants = f"told besides: {pair.besides}" if pair.kind == "told besides" else f"{LEAST[pair.kind]:g}"
        figures = " | ".join(f"{ratio(pair, palette):.1f}" for palette in (LIGHT, DARK))
        lines.append(f"| `{pair.module}` | {pair.what} | {pair.grounds.replace(' ', ', ')} | {wants} | {figures} |")
    for (module, what, light), (*_, dark) in zip(tinted(LIGHT), tinted(DARK), strict=True):
        lines.append(f"| `{module}` | {what} | tinted panel | 4.5 | {light:.1f} | {dark:.1f} |")
    lines += [
        "",
        "## Colours in everybody's eyes",
        "",
        "Least distance (CIE76; 2.3 is just noticed) of colours that tell",
    ]
    lines += [
        "something, seen by all kinds of cones, or without those for red (protan), green (deutan) or blue (tritan)."
    ]
    visions: list[Vision] = list(SIMULATED)
    lines += ["", f"| what is told apart | told besides by | palette | wants | {' | '.join(visions)} |"]
    lines += ["|---|---|---|---|" + "---|" * len(visions)]
    for (what, besides, least), roles in TOLD_APART.items():
        for name, palette in (("light", LIGHT), ("dark", DARK)):
            figures = " | ".join(f"{apart(palette, roles, vision):.0f}" for vision in visions)
            lines.append(f"| {what} | {besides} | {name} | {least:g} | {figures} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    usual = ROOT / "docs" / "reference" / "accessibility.md"
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", default=usual, help="by default the page itself")
    options = parser.parse_args()
    options.file.write_text(page())


if __name__ == "__main__":
    main()

"""Write `docs/reference/accessibility.md`: the contrast of all pairs of colors that the windows draw.

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

Kind = Literal["text", "sign", "shown elsewhere"]

LEAST: dict[Kind, float] = {"text": 4.5, "sign": 3.0, "shown elsewhere": 0.0}
"""Smallest ratios of WCAG 2.2, AA: 1.4.3 for text, 1.4.11 for edges and signs."""

APART = 15.0
"""Smallest distance (CIE76) of colors that distinguish things, for all kinds of color vision; a distance of 2.3 is just
noticeable.
"""

FLOORS = "unvisited reserved visited won lost"
GROUNDS = f"window panel floor {FLOORS}"


@dataclass(frozen=True, slots=True)
class Pair:
    """Colors that are drawn on other colors.

    Attributes:
        module: path in ui/windows.
        what: part of the window that is drawn.
        inks: roles of the palette that may be the drawn color; "robots" for all robot colors.
        grounds: roles of the palette that may be the color below.
        kind: required visibility; "shown elsewhere" if the same information is also in `besides`.
        opacity: opacity of the ink, 0 to 1.
        besides: other place with the same information.
    """

    module: str
    what: str
    inks: str
    grounds: str
    kind: Kind = "text"
    opacity: float = 1.0
    besides: str = ""


PAIRS = (
    Pair("look.py", "text of labels, buttons, lists, tool tips", "text", "window panel track"),
    Pair("look.py", "secondary text, placeholders, disabled buttons", "muted", "window panel track"),
    Pair("look.py", "problems", "bad", "window panel"),
    Pair("look.py", "main button, selected rows", "on_accent", "accent"),
    Pair("look.py", "links", "accent", "window panel"),
    Pair("look.py", "edges of buttons and lists, handles of scroll bars", "line", "window panel track", "sign"),
    Pair("look.py", "focus ring", "accent text", "window panel", "sign"),
    Pair("look.py", "shadow of the style", "wall", "window", "shown elsewhere", besides="the shadow has no meaning"),
    Pair("controls.py", "arrow of a disabled combo box", "muted", "window panel", "sign"),
    Pair("controls.py", "tick of a check box", "on_accent", "accent", "sign"),
    Pair("controls.py", "tick of a disabled check box", "panel", "muted line", "sign"),
    Pair("kiosk/items/line.py", "line and its mark on a scale", "muted accent", "panel", "sign"),
    Pair("kiosk/items/line.py", "edge of the mark", "panel", "accent", "shown elsewhere", besides="the mark itself"),
    Pair("kiosk/items/panel.py", "ring of the item with the focus", "accent", "window", "sign"),
    Pair("participant/history.py", "sentences", "text muted", "panel"),
    Pair("participant/people.py", "edge of a text that is not delivered yet", "line", "panel", "sign"),
    Pair("participant/people.py", "edge on the side of the author", "accent muted", "panel track", "sign"),
    Pair("participant/pages/pages.py", "keys on the help sheet", "text", "panel"),
    Pair("participant/top.py", "banner of a note", "text", "panel"),
    Pair("participant/top.py", "banner of a problem", "panel", "bad"),
    Pair("participant/top.py", "edge of the banner", "line bad", "window", "sign"),
    Pair("participant/cards.py", "name, state, other commander, mast, energy", "text", "panel track"),
    Pair("participant/cards.py", "place, key", "muted", "panel track"),
    Pair("participant/cards.py", "problem, insufficient energy", "bad", "panel track"),
    Pair("participant/cards.py", "edge, also of the selected card", "accent line", "window panel", "sign"),
    Pair("participant/cards.py", "focus ring", "text accent", "panel track", "sign"),
    Pair("participant/cards.py", "number of waiting items", "on_accent", "accent"),
    Pair("participant/cards.py", "energy and progress on the used part", "robots", "track", "sign"),
    Pair("participant/cards.py", "hatched part of the energy", "robots bad", "panel", "sign"),
    Pair("participant/score.py", "score", "text muted", "window"),
    Pair("participant/score.py", "points won and lost", "good bad", "window"),
    Pair("participant/widgets/buttons.py", "text", "text", "panel track"),
    Pair("participant/widgets/buttons.py", "key, hint, disabled button", "muted", "panel track"),
    Pair("participant/widgets/buttons.py", "main button", "on_accent", "accent"),
    Pair("participant/widgets/buttons.py", "edge", "line accent", "window panel", "sign"),
    Pair("participant/widgets/buttons.py", "focus ring", "accent", "panel track", "sign"),
    Pair("participant/popups/finding.py", "color, footprint, verdict", "text good bad", "panel"),
    Pair("participant/popups/finding.py", "names of the figures, place of the picture", "muted", "panel track"),
    Pair("participant/popups/finding.py", "edges of picture and swatch", "line", "panel", "sign"),
    Pair("participant/popups/finding.py", "edge of a picture under the pointer, focus ring", "accent", "panel", "sign"),
    Pair("participant/widgets/panels.py", "newest sentences", "text", "track"),
    Pair("participant/widgets/panels.py", "earlier sentences", "muted", "track"),
    Pair("participant/widgets/panels.py", "speaker", "robots accent", "panel track", "sign"),
    Pair("participant/widgets/panels.py", "edge of an objection", "bad", "track", "sign"),
    Pair("participant/widgets/painting.py", "robot's chip", "robots", GROUNDS, "sign"),
    Pair("participant/waiting.py", "waiting item", "text", "panel track"),
    Pair("participant/waiting.py", "key of a waiting item", "muted", "panel track"),
    Pair("participant/waiting.py", "edge of a waiting item", "accent", "window panel track", "sign"),
    Pair("participant/tiles.py", "room, cost, sign, focus ring", "text", FLOORS),
    Pair("participant/tiles.py", "name; a room that cannot be chosen", "muted", FLOORS),
    Pair("participant/tiles.py", "edge", "accent line", f"window panel {FLOORS}", "sign"),
    Pair("map/ground.py", "walls", "wall", f"floor unknown {FLOORS}", "sign"),
    Pair("map/scale_bar.py", "scale", "muted", "panel"),
    Pair("map/view.py", "numbers at the axes", "muted", "window"),
    Pair("map/view.py", "axes", "line", "window", "sign"),
    Pair("map/rooms.py", "number", "text", f"floor {FLOORS}"),
    Pair("map/rooms.py", "name", "muted", f"floor {FLOORS}"),
    Pair("map/rooms.py", "frame of a room that can be chosen or is considered", "accent", FLOORS, "sign"),
    Pair("map/rooms.py", "text about a treasure", "text", "panel"),
    Pair("map/rooms.py", "edge of this text, sign of the room's state", "line robots", f"panel {FLOORS}", "sign"),
    Pair("map/rooms.py", "dot, tick or cross of a visited room", "panel", "line robots", "sign"),
    Pair(
        "map/rooms.py",
        "stripes and dots of the floor",
        "text",
        "reserved visited won lost",
        "shown elsewhere",
        46 / 255,
        "the room's sign: circle, arrows, dot, tick, cross",
    ),
    Pair("map/badges.py", "robot's number, other commander, mast", "text", "panel"),
    Pair("map/badges.py", "the same for the selected robot's label", "panel", "robots"),
    Pair("map/badges.py", "edge of the label", "robots", f"panel floor {FLOORS}", "sign"),
    Pair("map/badges.py", "warning sign", "bad", "panel", "sign"),
    Pair("map/badges.py", "mark in the warning sign", "panel", "bad"),
    Pair("map/robots.py", "robot, path ahead, outline of its ellipse", "robots", f"floor {FLOORS}", "sign"),
    Pair("map/robots.py", "front of the robot", "panel", "robots", "sign"),
    Pair("map/robots.py", "true pose", "text", f"floor {FLOORS}", "sign"),
    Pair("map/robots.py", "ring of the selected robot", "accent", "panel", "sign"),
    Pair(
        "map/robots.py",
        "newest part of the trail",
        "robots",
        f"floor {FLOORS}",
        "shown elsewhere",
        0.5,
        "the robot's motion",
    ),
    Pair(
        "map/robots.py",
        "inside of the ellipse",
        "robots",
        "floor",
        "shown elsewhere",
        40 / 255,
        "the outline of the ellipse",
    ),
    Pair("researcher/map/overlays.py", "scans, plans, goals", "robots", f"floor {FLOORS}", "sign"),
    Pair("arena/window.py", "removed lines of a plan", "accent", "floor", "sign"),
    Pair("arena/marks.py", "outlines, goals and start poses", "text accent bad", f"panel floor {FLOORS}", "sign"),
    Pair("researcher/map/preview.py", "preview of a tool's effect", "accent", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "obstacles", "bad", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "names of obstacles", "text", f"floor {FLOORS}"),
    Pair("researcher/map/overlays.py", "paths", "robots", f"floor {FLOORS}", "sign"),
    Pair("researcher/map/overlays.py", "particles of the selected robot", "text", f"floor {FLOORS}", "sign", 0.6),
    Pair("researcher/docks/playback.py", "remaining and elapsed time", "line accent", "window panel", "sign"),
    Pair("researcher/docks/playback.py", "marks", "muted robots", "window panel", "sign"),
    Pair("researcher/docks/playback.py", "bookmarks", "text", "window panel", "sign"),
    Pair("researcher/docks/topics.py", "boxes", "text accent", "panel", "sign"),
    Pair("researcher/docks/log.py", "speaker or sender", "robots", "panel"),
    Pair("researcher/docks/log.py", "later rows, times", "muted", "panel"),
    Pair("tables.py", "times", "muted", "panel"),
    Pair("researcher/docks/attack_graph.py", "number and tick of an argument", "text", "panel"),
    Pair("researcher/docks/attack_graph.py", "edges of arguments, attacks", "text line good", "window panel", "sign"),
    Pair("researcher/docks/seats.py", "texts and votes", "text muted", "track"),
    Pair("researcher/docks/seats.py", "edge of a text or a vote", "accent muted", "track", "sign"),
    Pair("researcher/docks/team.py", "robot with a problem", "bad", "panel"),
    Pair("researcher/docks/team.py", "robot's chip in its edge", "robots", "panel", "sign"),
    Pair("researcher/docks/team.py", "edge of the chip in a selected row", "panel", "accent", "sign"),
    Pair("researcher/docks/plots.py", "titles", "text", "panel"),
    Pair("researcher/docks/plots.py", "numbers", "muted", "panel"),
    Pair("researcher/docks/plots.py", "axes, cursor of the time shown", "line accent", "panel", "sign"),
    Pair("researcher/docks/plots.py", "curve of the selected robot", "robots", "panel", "sign"),
    Pair(
        "researcher/docks/plots.py",
        "the other curves",
        "robots",
        "panel",
        "shown elsewhere",
        0.55,
        "select the robot of the curve",
    ),
    Pair(
        "researcher/docks/plots.py",
        "two standard deviations",
        "robots",
        "panel",
        "shown elsewhere",
        0.18,
        "the plot below",
    ),
    Pair("editing/changes.py", "lines that a change adds or removes", "good bad muted", "panel"),
    Pair("study/pictures.py", "paths driven and believed, walls", "text wall robots", "panel", "sign"),
    Pair("study/pictures.py", "ruler", "muted", "panel"),
    Pair("study/pictures.py", "beams", "line", "panel", "shown elsewhere", 70 / 255, "the crosses at their ends"),
    Pair("study/window.py", "edges of fields, focus ring", "line accent", "window panel", "sign"),
)
"""All pairs of colors. Faults in the text of a study also have a tinted ground, which is in `TINTED`."""

TINTED = (("study/pages.py", "text on the line of a fault", "text", "bad", 48 / 255, "panel"),)
"""Texts on tinted grounds: module, text, and its color; then the tint, its opacity, and the color below the tint."""

HEAD = """\
# Visibility and use of the windows

For everyone who checks whether people can see and use the windows.

`scripts/write_contrast.py` writes this page from the windows' palettes (`ui/model/shared/theme.py`). Ratios are those
of WCAG 2.2: level AA requires 4.5 for text (1.4.3), and 3 for edges, signs and curves (1.4.11). Each row shows the
worst ratio of its pairs; rows with robot colors include all ten colors. *Shown elsewhere*: the contrast is not needed,
because the same information is also shown in another form.

Every function can be used by keyboard, and every part has a name for screen readers. The focus follows the reading
order in each part of a window, from top to bottom and from left to right (`tests/ui/windows`). Color is never the only
sign: rooms have signs and patterns, robots have numbers, problems have a warning sign and words, and disabled buttons
have a dashed edge and give the reason. The size of text can be set from 80 to 200 % (1.4.4), and windows fit a screen
of 1024 x 600 at each of these sizes.
"""


def mixed(ink: str, opacity: float, ground: str) -> str:
    """Return the visible color of a partly transparent ink on a ground."""
    channels = (
        round(opacity * int(ink[at : at + 2], 16) + (1.0 - opacity) * int(ground[at : at + 2], 16)) for at in (1, 3, 5)
    )
    return "#" + "".join(f"{channel:02x}" for channel in channels)


def colours(palette: Palette, roles: str) -> list[str]:
    """Return the colors of these roles."""
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
    """Yield module, text and contrast of each text on a tinted ground."""
    for module, what, ink, tint, opacity, ground in TINTED:
        below = mixed(getattr(palette, tint), opacity, getattr(palette, ground))
        yield module, what, contrast(getattr(palette, ink), below)


ReportedPair = tuple[str, str, float]
"""Things that are distinguished by colors, other features that distinguish them, and the smallest distance of their
colors (CIE76).
"""

TOLD_APART: dict[ReportedPair, tuple[str, ...]] = {
    ("robots", "numbers", APART): ("robots",),
    ("points won and points lost", "+ and -, words", APART): ("good", "bad"),
    ("sufficient and insufficient energy", "hatching, words", APART): ("text", "bad"),
    ("the selected card and others", "width of the edge", APART): ("accent", "line"),
    ("states of rooms", "signs, patterns, words", 6.0): tuple(FLOORS.split()),
}


def apart(palette: Palette, roles: tuple[str, ...], vision: Vision) -> float:
    """Return the smallest difference among the colors of these roles."""
    return min(difference(a, b, vision) for a, b in combinations(colours(palette, " ".join(roles)), 2))


def page() -> str:
    """Return the whole page."""
    lines = [
        HEAD,
        "## Contrast",
        "",
        "| module | element | ground | required | light | dark |",
        "|---|---|---|---|---|---|",
    ]
    for pair in PAIRS:
        wants = f"shown elsewhere: {pair.besides}" if pair.kind == "shown elsewhere" else f"{LEAST[pair.kind]:g}"
        figures = " | ".join(f"{ratio(pair, palette):.1f}" for palette in (LIGHT, DARK))
        lines.append(f"| `{pair.module}` | {pair.what} | {pair.grounds.replace(' ', ', ')} | {wants} | {figures} |")
    for (module, what, light), (*_, dark) in zip(tinted(LIGHT), tinted(DARK), strict=True):
        lines.append(f"| `{module}` | {what} | tinted panel | 4.5 | {light:.1f} | {dark:.1f} |")
    lines += [
        "",
        "## Colors for all kinds of color vision",
        "",
        "Smallest distance (CIE76; 2.3 is just noticeable) of colors that distinguish",
    ]
    lines += ["things, for people with all cones, or without cones for red (protan), green (deutan) or blue (tritan)."]
    visions: list[Vision] = list(SIMULATED)
    lines += ["", f"| distinguished things | other means | palette | required | {' | '.join(visions)} |"]
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
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        metavar="FILE",
        default=usual,
        help="output file (default docs/reference/accessibility.md)",
    )
    options = parser.parse_args()
    options.file.write_text(page())


if __name__ == "__main__":
    main()

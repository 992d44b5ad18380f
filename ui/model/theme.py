"""The colours of all windows, light and dark, and the figures by which they are judged."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours as "#rrggbb".

    Attributes:
        window: behind everything.
        panel: behind cards and pop-ups.
        line: edges of panels and buttons that matter for use.
        text: on window and panel.
        muted: text of less weight, on window and panel.
        accent: what can be chosen, and what has the focus.
        on_accent: text on the accent.
        good: of points won.
        bad: of points lost, trouble, a broken connection.
        wall: walls on the map.
        floor: free floor on the map.
        unknown: what the map does not know.
        unvisited: floor of a room not visited yet.
        reserved: floor of a room that a robot is under way to.
        visited: floor of a room visited.
        robots: of robot 1, 2, ...; from the tenth on they repeat, and the number tells.
    """

    window: str
    panel: str
    line: str
    text: str
    muted: str
    accent: str
    on_accent: str
    good: str
    bad: str
    wall: str
    floor: str
    unknown: str
    unvisited: str
    reserved: str
    visited: str
    robots: tuple[str, ...]

    def robot(self, number: int) -> str:
        """The colour of the robot of this index."""
        return self.robots[number % len(self.robots)]


LIGHT = Palette(
    window="#f4f5f7",
    panel="#ffffff",
    line="#7b8494",
    text="#1b2430",
    muted="#525c6b",
    accent="#1f5fbf",
    on_accent="#ffffff",
    good="#1e7a3c",
    bad="#b3261e",
    wall="#3a4352",
    floor="#fbfbfc",
    unknown="#d9dde3",
    unvisited="#e6eef9",
    reserved="#fdf0cf",
    visited="#dcefe2",
    robots=(
        "#0b62a8",
        "#b04a00",
        "#1b7a53",
        "#8a2f8f",
        "#a3162e",
        "#5b5b00",
        "#00707a",
        "#6a4a2a",
        "#4b4fc4",
        "#555555",
    ),
)
"""By day."""

DARK = Palette(
    window="#14181e",
    panel="#1e242c",
    line="#7d8896",
    text="#e8ecf1",
    muted="#aab4c0",
    accent="#7db2ff",
    on_accent="#0b1a2e",
    good="#72d08f",
    bad="#ff8a80",
    wall="#a9b3c1",
    floor="#1a2027",
    unknown="#2b333d",
    unvisited="#22304a",
    reserved="#463a17",
    visited="#1f3a2a",
    robots=(
        "#6db6ff",
        "#ff9d5c",
        "#5fd3a0",
        "#d79bdc",
        "#ff8a9a",
        "#d6d36a",
        "#5fd0da",
        "#d4b08c",
        "#a9acff",
        "#c4c8cd",
    ),
)
"""By night."""


def luminance(colour: str) -> float:
    """Relative luminance of "#rrggbb", 0 black to 1 white (WCAG 2.2)."""
    channels = [int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours, 1 to 21 (WCAG 2.2); text wants 4.5, edges and signs 3."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)

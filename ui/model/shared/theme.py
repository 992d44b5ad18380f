"""Light and dark colors of all windows, and measures of contrast and difference between colors."""

from dataclasses import dataclass
from math import dist
from typing import Literal

from sim.common.robot_colors import ROBOT_COLORS
from ui.model.shared.scene import RoomState


@dataclass(frozen=True, slots=True)
class Palette:
    """Colors of a window, each as "#rrggbb".

    Attributes:
        window: background of windows.
        panel: background of cards and pop-ups.
        track: pressed panels, panels under the pointer, and the empty part of bars.
        line: edges of panels and buttons that must be visible.
        text: main text, on window and panel.
        muted: less important text, on window and panel.
        accent: things that can be selected, and the keyboard focus.
        on_accent: text on the color `accent`.
        good: points won.
        bad: points lost, problems, and a broken connection.
        wall: walls on the map.
        floor: free floor on the map.
        unknown: cells of the map that are neither wall nor floor.
        unvisited: floor of a room that no robot has visited yet.
        reserved: floor of a room that a robot drives to.
        visited: floor of a visited room.
        won: floor of a room whose treasure brought points.
        lost: floor of a room whose treasure cost points.
        robots: colors of robots 1 to 10. For further robots the colors repeat, and only the numbers differ.
    """

    window: str
    panel: str
    track: str
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
    won: str
    lost: str
    robots: tuple[str, ...]

    def robot(self, number: int) -> str:
        """Return the color of the robot with this index."""
        return self.robots[number % len(self.robots)]

    def room(self, state: RoomState) -> str:
        """Return the color of a room's floor."""
        return {
            "unvisited": self.unvisited,
            "reserved": self.reserved,
            "visited": self.visited,
            "won": self.won,
            "lost": self.lost,
        }[state]


LIGHT = Palette(
    window="#f4f5f7",
    panel="#ffffff",
    track="#e8ebf0",
    line="#747d8d",
    text="#1b2430",
    muted="#525c6b",
    accent="#1f5fbf",
    on_accent="#ffffff",
    good="#006b5b",
    bad="#b3261e",
    wall="#3a4352",
    floor="#fbfbfc",
    unknown="#e9ebf0",
    unvisited="#eaf1fc",
    reserved="#fdf3c4",
    visited="#dedfe1",
    won="#c6f4db",
    lost="#ffdac3",
    robots=ROBOT_COLORS,
)
"""Light colors."""

DARK = Palette(
    window="#14181e",
    panel="#1e242c",
    track="#2b333e",
    line="#84909e",
    text="#e8ecf1",
    muted="#aab4c0",
    accent="#7db2ff",
    on_accent="#0b1a2e",
    good="#4fd6c0",
    bad="#ff8a80",
    wall="#a9b3c1",
    floor="#1a2027",
    unknown="#14181e",
    unvisited="#242d52",
    reserved="#4b3c10",
    visited="#404346",
    won="#1b4a30",
    lost="#461828",
    robots=(
        "#7090c0",
        "#c08020",
        "#a080f0",
        "#40e0a0",
        "#f06060",
        "#e0d050",
        "#e0c0ff",
        "#c0f090",
        "#00b0a0",
        "#a0f0e0",
    ),
)
"""Dark colors."""


Rgb = tuple[float, float, float]
"""Linear intensities of red, green and blue, each 0 to 1."""


def luminance(colour: str) -> float:
    """Return the relative luminance of a color "#rrggbb", from 0 (black) to 1 (white), as in WCAG 2.2."""
    red, green, blue = _linear(colour)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colors, 1 to 21, as in WCAG 2.2: text needs 4.5, edges and signs need 3."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


Vision = Literal["normal", "protan", "deutan", "tritan"]
"""Color vision: with all three kinds of cones, or without the cones for red, green, or blue."""

SIMULATED: dict[Vision, tuple[Rgb, Rgb, Rgb]] = {
    "normal": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "protan": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deutan": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritan": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}
"""Rows of the matrices that convert linear colors into the colors that a dichromat sees.

Source: Machado, Oliveira, Fernandes, A Physiologically-based Model for Simulation of Color Vision Deficiency (2009),
severity 1.0.
"""


def difference(one: str, other: str, vision: Vision = "normal") -> float:
    """Return the perceived distance of two colors in CIE L*a*b* (CIE76, white D65).

    The smallest distance that people notice is about 2.3.
    """
    return dist(_lab(_seen(one, vision)), _lab(_seen(other, vision)))


def _linear(colour: str) -> Rgb:
    """Return the linear intensities of an sRGB color "#rrggbb"."""
    red, green, blue = (int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
    return _undone(red), _undone(green), _undone(blue)


def _undone(channel: float) -> float:
    """Return the linear intensity of one channel by removing the gamma correction of sRGB."""
    return channel / 12.92 if channel <= 0.04045 else float(((channel + 0.055) / 1.055) ** 2.4)


def _seen(colour: str, vision: Vision) -> Rgb:
    """Return a linear color as a person with this vision sees it, limited to the colors that a screen can show."""
    cones = _linear(colour)
    red, green, blue = (
        min(1.0, max(0.0, sum(weight * value for weight, value in zip(row, cones, strict=True))))
        for row in SIMULATED[vision]
    )
    return red, green, blue


def _lab(colour: Rgb) -> tuple[float, float, float]:
    """Return a linear color in CIE L*a*b*."""
    red, green, blue = colour
    x = _lightness((0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505)
    y = _lightness(0.2126 * red + 0.7152 * green + 0.0722 * blue)
    z = _lightness((0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089)
    return 116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)


def _lightness(share: float) -> float:
    """Return the lightness function of L*a*b*, which is a cube root, and linear near black."""
    return float(share ** (1.0 / 3.0)) if share > (6.0 / 29.0) ** 3 else share / (3.0 * (6.0 / 29.0) ** 2) + 4.0 / 29.0

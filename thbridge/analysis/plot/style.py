"""Style and file formats of figures. The same report gives the same bytes."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from enum import StrEnum
from io import BytesIO

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from sim.common.robot_colors import robot_color
from thbridge.analysis.report.report import Track

INK = "#1f2933"
FAINT = "#9aa5b1"


class FigureFormat(StrEnum):
    """File formats of figures."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


_METADATA: Mapping[FigureFormat, Mapping[str, None]] = {
    FigureFormat.PNG: {"Software": None},
    FigureFormat.SVG: {"Date": None, "Creator": None},
    FigureFormat.PDF: {"CreationDate": None, "Creator": None, "Producer": None},
}
"""Metadata that is omitted: with dates and versions, no two files would be equal."""


@dataclass(frozen=True, slots=True)
class FigureStyle:
    """Width of a figure, and sizes of fonts and lines.

    Attributes:
        width: width of the figure, inches.
        font: size of the font, points.
        line: width of a curve, points.
        live_text: True if SVG files contain text in the fonts of their page; False if letters are drawn as paths.
    """

    width: float
    font: float
    line: float
    live_text: bool = False

    @property
    def narrow(self) -> bool:
        """True if two panels do not fit side by side."""
        return self.width < 5.0

    def settings(self, salt: str = "") -> AbstractContextManager[None]:
        """Return matplotlib's settings. Ids in SVG files are hashes that include this salt."""
        return mpl.rc_context(
            {
                "svg.hashsalt": salt or "thbridge",
                "svg.fonttype": "none" if self.live_text else "path",
                "pdf.fonttype": 42,
                "font.family": "DejaVu Sans",  # included in matplotlib, so the same on all machines
                "font.size": self.font,
                "axes.labelsize": self.font,
                "axes.titlesize": self.font,
                "axes.titlelocation": "left",
                "legend.fontsize": self.font,
                "xtick.labelsize": self.font - 1,
                "ytick.labelsize": self.font - 1,
                "axes.linewidth": 0.6,
                "xtick.major.width": 0.6,
                "ytick.major.width": 0.6,
                "lines.linewidth": self.line,
                "axes.edgecolor": FAINT,
                "axes.labelcolor": INK,
                "axes.spines.top": False,
                "axes.spines.right": False,
                "axes.grid": True,
                "axes.axisbelow": True,
                "grid.color": "#e4e7eb",
                "grid.linewidth": 0.6,
                "text.color": INK,
                "xtick.color": INK,
                "ytick.color": INK,
            }
        )

    def figure(self, height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, list[list[Axes]]]:
        """Create an empty figure whose panels share one time axis; height in inches. Call it within `settings`."""
        figure = Figure(figsize=(self.width, height), layout="constrained")
        axes = figure.subplots(rows, columns, sharex=True, squeeze=False)
        return figure, [list(row) for row in axes]

    def rendered(self, figure: Figure, kind: FigureFormat, salt: str = "", transparent: bool = False) -> bytes:
        """Return the bytes of the figure's file; PNG has 300 dots per inch."""
        file = BytesIO()
        with self.settings(salt):
            figure.savefig(file, format=kind.value, metadata=dict(_METADATA[kind]), dpi=300, transparent=transparent)
        return file.getvalue()


PAGE = FigureStyle(width=9.2, font=9.0, line=1.1, live_text=True)
ONE_COLUMN = FigureStyle(width=3.46, font=7.0, line=0.8)
"""Style for a width of 88 mm, one column of most journals."""
TWO_COLUMNS = FigureStyle(width=7.2, font=8.0, line=0.9)
"""Style for a width of 183 mm, two columns of most journals."""


def clock(seconds: float) -> str:
    """Return a time in minutes and seconds: 75.3 gives 1:15."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def label_above(axes: Axes, handles: Sequence[object], columns: int = 10) -> None:
    """Add a legend above the panel, so that it covers nothing."""
    axes.legend(
        handles=list(handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        handlelength=1.4,
        columnspacing=1.2,
        frameon=False,
    )


def robot_handles(tracks: Sequence[Track], shown: Sequence[int] | None = None) -> list[object]:
    """Return the legend handles of the robots."""
    return [
        Line2D([], [], color=robot_color(index), lw=2.0, label=track.label)
        for index, track in enumerate(tracks)
        if shown is None or index in shown
    ]

"""Style of all windows: one typeface, one scale of sizes and distances, and light or dark colors.

`apply_palette` sets the palette of the whole application, as `QApplication.setPalette` does. `colours()` returns this
palette for widgets that paint themselves. All other widgets use Qt's own color roles, and need no styling.

`apply_text_size` makes all text larger or smaller. `px` scales a length with the text, and `follow_text` updates a
widget when the size of text changes.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import ClassVar, Literal, TypeVar, cast
from weakref import WeakKeyDictionary

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontDatabase,
    QIcon,
    QPaintDevice,
    QPainter,
    QPalette,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QApplication,
    QBoxLayout,
    QLabel,
    QLayout,
    QStyle,
    QStyleOption,
    QWidget,
)
from shiboken6 import Shiboken

from ui.model.shared.theme import DARK, LIGHT, Palette, contrast
from ui.windows.untrusted_text import PlainLabel, PlainTextStyle

L = TypeVar("L", bound=QLayout)
W = TypeVar("W", bound=QWidget)

Choice = Literal["light", "dark", "system"]
Size = Literal["small", "body", "title", "hero"]

GAP = 8
"""Unit of spacing, logical pixels. All margins and distances are multiples of half this unit."""

RADIUS = 8
"""Radius of the corners of cards, panels and buttons, logical pixels."""

RING = 2
"""Width of the focus ring, logical pixels."""

_SCALE: dict[Size, float] = {"small": 0.88, "body": 1.0, "title": 1.24, "hero": 1.9}
_SMALLEST_BODY = 10.5
_USUAL_WINDOW = QSize(1200, 800)
_TICKS = {
    palette.on_accent: Path(__file__).with_name(f"tick_{name}.svg").as_posix()
    for name, palette in (("light", LIGHT), ("dark", DARK))
}
"""Image files of a tick mark, by the color of the mark."""
_SIGN = 48
"""Width and height of the signs in message boxes, logical pixels."""
FRAME = QSize(16, 48)
"""Upper limit of the width and height of a window's frame and title bar, logical pixels; the real size
is unknown before the window opens."""


class _Current:
    """Current style of the application; a process has only one application."""

    palette: Palette = LIGHT
    usual: float = _SMALLEST_BODY
    body: float = _SMALLEST_BODY
    following: ClassVar[WeakKeyDictionary[QWidget, list[Callable[[QWidget], object]]]] = WeakKeyDictionary()


class WindowStyle(PlainTextStyle):
    """Style of all widgets, with flat symbols in message boxes.

    Values that Qt requests thousands of times are not here, but in the style sheet.
    """

    def standardIcon(
        self, icon: QStyle.StandardPixmap, option: QStyleOption | None = None, widget: QWidget | None = None
    ) -> QIcon:
        """Return the icon for a standard sign."""
        palette, kinds = colours(), QStyle.StandardPixmap
        signs = {
            kinds.SP_MessageBoxQuestion: ("?", palette.accent, palette.on_accent),
            kinds.SP_MessageBoxInformation: ("i", palette.accent, palette.on_accent),
            kinds.SP_MessageBoxWarning: ("!", palette.bad, palette.panel),
            kinds.SP_MessageBoxCritical: ("!", palette.bad, palette.panel),
        }
        return _sign_icon(*signs[icon]) if icon in signs else super().standardIcon(icon, option, widget)


def _sign_icon(letter: str, ground: str, ink: str) -> QIcon:
    """Return an icon that shows a letter on a disc."""
    pixmap = QPixmap(2 * _SIGN, 2 * _SIGN)
    pixmap.setDevicePixelRatio(2.0)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = smooth_painter(pixmap)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(ground))
    painter.drawEllipse(2, 2, _SIGN - 4, _SIGN - 4)
    heavy = font(bold=True)
    heavy.setPixelSize(_SIGN // 2)
    painter.setFont(heavy)
    painter.setPen(QColor(ink))
    painter.drawText(0, 0, _SIGN, _SIGN, int(Qt.AlignmentFlag.AlignCenter), letter)
    painter.end()
    return QIcon(pixmap)


def colours() -> Palette:
    """Return the current palette."""
    return _Current.palette


def font(size: Size = "body", *, bold: bool = False) -> QFont:
    """Return the typeface in one of its sizes.

    Its digits have equal widths, so that numbers do not move when they change.
    """
    # Return a copy, because callers may change the font. Qt copies the data only when a font is changed.
    return QFont(_made_font(_Current.body * _SCALE[size], bold))


@cache
def _made_font(points: float, bold: bool) -> QFont:
    """Return a cached typeface, because painting and layout request it hundreds of times in a frame."""
    made = QFont()
    made.setFamilies(["Inter", QFont().defaultFamily()])
    made.setPointSizeF(points)
    made.setWeight(QFont.Weight.DemiBold if bold else QFont.Weight.Normal)
    made.setFeature(QFont.Tag("tnum"), 1)
    return made


def fixed_font() -> QFont:
    """Return a typeface of the normal size in which all characters have the same width, so that columns align."""
    fixed = QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont)
    fixed.setPointSizeF(_Current.body)
    return fixed


def apply_palette(app: QApplication, palette: Palette) -> None:
    """Set the palette of the whole application, including open windows.

    The usual size of text is the system's size, but at least a readable size.
    """
    if not app.property("dressed"):
        _Current.usual = _Current.body = max(_SMALLEST_BODY, app.font().pointSizeF())
        app.setProperty("dressed", True)
        app.setStyle(WindowStyle())
    elif palette is _Current.palette:
        return
    _Current.palette = palette
    _set_fonts(app)
    app.setPalette(qt_palette(palette))
    app.setStyleSheet(_sheet(palette))


def apply_text_size(app: QApplication, factor: float) -> None:
    """Set the size of all text, including text in open windows, as a multiple of the usual size."""
    _Current.body = _Current.usual * factor
    _set_fonts(app)
    app.setStyleSheet(_sheet(_Current.palette))
    for widget, fits in list(_Current.following.items()):
        if Shiboken.isValid(widget):
            for fit in fits:
                fit(widget)
    for widget in app.allWidgets():
        widget.updateGeometry()
        widget.update()


def _set_fonts(app: QApplication) -> None:
    app.setFont(font())
    # Without this, titles of docks keep the desktop's font. PySide accepts a string here, although its stubs do not.
    app.setFont(font("small"), "QDockWidgetTitle")  # type: ignore[arg-type]


def px(length: float) -> int:
    """Return a length scaled to the current size of text.

    Args:
        length: logical pixels at a text size of 10.5 points.
    """
    return round(length * _Current.body / _SMALLEST_BODY)


def follow_text(widget: W, fit: Callable[[W], object]) -> W:
    """Set a widget's font or lengths that depend on the size of text: now, and at each change of that size.

    Args:
        widget: the widget, which is also returned.
        fit: function that sets the font or the lengths. It must refer to the widget only by its argument; otherwise
            the widget would never be freed.
    """
    fit(widget)
    _Current.following.setdefault(widget, []).append(cast("Callable[[QWidget], object]", fit))
    return widget


def usual_growth(screen: QSize) -> float:
    """Return the factor by which text is larger than 10.5 points on a screen by default, 1 to 1.5.

    The excess of a screen is the share by which its width exceeds 1200 logical pixels, or by which its height exceeds
    800 logical pixels; the smaller share counts. Text grows by half of the excess: by 0 % on a small screen, about 17 %
    on 1920 x 1080, and 40 % on 2560 x 1440.
    """
    beyond = min(screen.width() / _USUAL_WINDOW.width(), screen.height() / _USUAL_WINDOW.height()) - 1.0
    return min(max(1.0 + beyond / 2.0, 1.0), 1.5)


def open_within_screen(window: QWidget, wanted: QSize = _USUAL_WINDOW) -> None:
    """Set the initial size of a window, so that it fits with its frame into the available part of the screen."""
    window.resize((wanted * _Current.body / _SMALLEST_BODY).boundedTo(window.screen().availableSize() - FRAME))


def qt_palette(palette: Palette) -> QPalette:
    """Convert the palette to a palette of Qt."""
    role = QPalette.ColorRole
    made = QPalette()
    for roles, colour in (
        ((role.Window, role.AlternateBase), palette.window),
        ((role.Base, role.Button, role.ToolTipBase), palette.panel),
        ((role.WindowText, role.Text, role.ButtonText, role.ToolTipText, role.BrightText), palette.text),
        ((role.PlaceholderText,), palette.muted),
        ((role.Highlight, role.Accent, role.Link, role.LinkVisited), palette.accent),
        ((role.HighlightedText,), palette.on_accent),
        ((role.Light, role.Midlight), palette.track),
        ((role.Mid, role.Dark), palette.line),
        ((role.Shadow,), palette.wall),
    ):
        for one in roles:
            made.setColor(one, QColor(colour))
    for one in (role.WindowText, role.Text, role.ButtonText):
        made.setColor(QPalette.ColorGroup.Disabled, one, QColor(palette.muted))
    return made


def label(text: str = "", size: Size = "body", *, bold: bool = False, muted: bool = False) -> QLabel:
    """Return a label that shows a text literally and wraps long lines."""
    made = follow_text(PlainLabel(text), lambda it: it.setFont(font(size, bold=bold)))
    made.setWordWrap(True)
    if muted:
        made.setProperty("muted", True)
    return made


def spaced(layout: L, spacing: int, *margins: int) -> L:
    """Set the distances between the parts of a layout, and its margins: one value, or left, top, right and bottom."""
    layout.setSpacing(spacing)
    if margins:
        left, top, right, bottom = margins if len(margins) == 4 else 4 * margins
        layout.setContentsMargins(left, top, right, bottom)
    return layout


class FoldingRow(QWidget):
    """Two parts side by side, or the second part below the first if the row is too narrow.

    Args:
        first: left part; it gets the remaining width.
        second: right part.
        least: smallest width of the first part, `px`. If 0, the smallest width of its widgets is used.
        spacing: distance between the parts when they are side by side, logical pixels.
        spare: width that is kept free for texts that get longer, `px`. If it is not 0, a change of texts alone can fold
            the row, but cannot unfold the row.

    Attributes:
        parts: layout of the parts.
    """

    def __init__(
        self, first: QLayout, second: QLayout, least: float = 0.0, spacing: int = GAP, spare: float = 0.0
    ) -> None:
        super().__init__()
        self._spare = spare
        # Width, size of text and number of widgets at the last decision to fold or unfold.
        self._decided: tuple[int, ...] = ()
        self._first, self._second, self._least, self._spacing = first, second, least, spacing
        self.parts = spaced(QBoxLayout(QBoxLayout.Direction.LeftToRight, self), spacing, 0)
        self.parts.addLayout(first, 1)
        self.parts.addLayout(second)

    @property
    def folded(self) -> bool:
        """True if the second part is below the first."""
        return self.parts.direction() == QBoxLayout.Direction.TopToBottom

    def minimumSizeHint(self) -> QSize:
        """Return the width of the wider part, because the row can always fold to this width."""
        parts = self._first.minimumSize(), self._second.minimumSize()
        margins = self.parts.contentsMargins()
        wide = max(part.width() for part in parts) + margins.left() + margins.right()
        return QSize(wide, self.parts.minimumSize().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fold or unfold the row to fit the new width."""
        super().resizeEvent(event)
        self._fold()

    def event(self, event: QEvent) -> bool:
        """Fold or unfold the row after a change of the texts or their size."""
        if event.type() == QEvent.Type.LayoutRequest:
            self._fold()
        return super().event(event)

    def _fold(self) -> None:
        first = max(self._first.minimumSize().width(), px(self._least))
        width = self.parts.contentsRect().width()
        needed = first + self._spacing + self._second.minimumSize().width()
        decided = width, px(1000), self._first.count() + self._second.count()
        if decided != self._decided or not self._spare:
            self._decided = decided
            fits = needed + px(self._spare) <= width
        else:
            fits = not self.folded and needed <= width
        if fits == self.folded:
            self.parts.setDirection(QBoxLayout.Direction.LeftToRight if fits else QBoxLayout.Direction.TopToBottom)
            self.parts.setSpacing(self._spacing if fits else min(self._spacing, GAP // 2))


def smooth_painter(device: QPaintDevice) -> QPainter:
    """Return a painter with smooth edges."""
    painter = QPainter(device)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    return painter


def style_as_panel(widget: QWidget) -> None:
    """Draw a widget as a panel: with its own background, an edge and round corners."""
    widget.setProperty("panel", True)
    widget.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)


def text_colour_on(colour: str) -> str:
    """Return the text color of the palette that has the best contrast on this color."""
    palette = colours()
    return max((palette.panel, palette.text, palette.on_accent), key=lambda text: contrast(text, colour))


def _sheet(palette: Palette) -> str:
    """Return the style sheet, with all settings that Qt's palette cannot express."""
    return f"""
    QToolTip {{
        color: {palette.text}; background: {palette.panel}; border: 1px solid {palette.line}; padding: {GAP // 2}px;
    }}
    QLabel[muted="true"] {{ color: {palette.muted}; }}
    QLabel[bad="true"] {{ color: {palette.bad}; }}
    QWidget[panel="true"] {{
        background: {palette.panel}; border: 1px solid {palette.line}; border-radius: {RADIUS}px;
    }}
    QDialogButtonBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
    QPushButton {{
        background: {palette.panel}; border: 1px solid {palette.line}; border-radius: {RADIUS - 2}px;
        padding: {GAP // 2 + 1}px {2 * GAP}px;
    }}
    QPushButton:hover, QPushButton:pressed, QPushButton:checked {{ background: {palette.track}; }}
    QPushButton:disabled {{ color: {palette.muted}; border-style: dashed; }}
    QPushButton:focus {{ border: {RING}px solid {palette.accent}; }}
    QPushButton:default {{ background: {palette.accent}; color: {palette.on_accent}; border-color: {palette.accent}; }}
    QPushButton:default:focus {{ border: {RING}px solid {palette.text}; }}
    QLineEdit, QComboBox, QPlainTextEdit, QTreeWidget, QListWidget {{
        background: {palette.panel}; border: 1px solid {palette.line}; border-radius: {RADIUS // 2}px;
        padding: {GAP // 2}px;
    }}
    QLineEdit:focus, QComboBox:focus, QPlainTextEdit:focus, QTreeWidget:focus, QListWidget:focus {{
        border: {RING}px solid {palette.accent}; padding: {GAP // 2 - 1}px;
    }}
    QComboBox::drop-down {{ border: none; width: {3 * GAP}px; }}
    QSlider[fine="true"]::groove {{ height: 4px; border-radius: 2px; background: {palette.line}; }}
    QSlider[fine="true"]::sub-page {{ border-radius: 2px; background: {palette.accent}; }}
    QSlider[fine="true"]::handle {{
        width: 12px; margin: -5px 0; border: 1px solid {palette.line}; border-radius: 6px; background: {palette.panel};
    }}
    QSlider[fine="true"]::handle:focus {{ border: {RING}px solid {palette.accent}; width: 10px; }}
    QCheckBox {{ spacing: {GAP}px; }}
    QCheckBox::indicator, QTreeView::indicator {{
        width: {px(14)}px; height: {px(14)}px;
        border: 1px solid {palette.line}; border-radius: 3px; background: {palette.panel};
    }}
    QCheckBox::indicator:checked, QTreeView::indicator:checked {{
        background: {palette.accent}; border-color: {palette.accent}; image: url("{_TICKS[palette.on_accent]}");
    }}
    QCheckBox::indicator:focus {{
        border: {RING}px solid {palette.text}; width: {px(14) - 2}px; height: {px(14) - 2}px;
    }}
    QCheckBox::indicator:checked:disabled {{ background: {palette.muted}; border-color: {palette.muted}; }}
    QListView[roomy="true"] {{
        border: 1px solid {palette.line}; border-radius: {RADIUS - 2}px; padding: {GAP // 2}px;
    }}
    QListView[roomy="true"]:focus {{ border: {RING}px solid {palette.accent}; padding: {GAP // 2 - 1}px; }}
    QListView[roomy="true"]::item {{ padding: {GAP // 2 + 1}px {GAP - 2}px; border-radius: {RADIUS // 2}px; }}
    QListView[roomy="true"]::item:selected {{ background: {palette.accent}; color: {palette.on_accent}; }}
    QScrollArea {{ border: none; background: transparent; }}
    QScrollBar {{ background: transparent; border: none; }}
    QScrollBar:vertical {{ width: {GAP + 4}px; }}
    QScrollBar:horizontal {{ height: {GAP + 4}px; }}
    QScrollBar::handle {{ background: {palette.line}; border-radius: 3px; margin: 3px; }}
    QScrollBar::handle:vertical {{ min-height: {4 * GAP}px; }}
    QScrollBar::handle:horizontal {{ min-width: {4 * GAP}px; }}
    QScrollBar::handle:hover {{ background: {palette.muted}; }}
    QScrollBar::add-line, QScrollBar::sub-line {{ width: 0; height: 0; }}
    QScrollBar::add-page, QScrollBar::sub-page {{ background: transparent; }}
    """

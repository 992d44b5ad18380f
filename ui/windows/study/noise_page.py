"""Drawings that show the effect of a study's noise."""

from collections.abc import Mapping
from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Slot
from PySide6.QtGui import QImage, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QScrollArea, QSplitter, QVBoxLayout, QWidget

from thbridge.study.study_file import Study
from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.noise import NoisePreview, extent_of, noise_from_form, preview_of
from ui.windows.editing.background import BackgroundWorker
from ui.windows.look import GAP, colours, follow_text, label, px, spaced, style_as_panel
from ui.windows.study.pictures import Canvas, NoisePicture, PaintFunction, fan_painter, room

_DRAWINGS = 310
"""Smallest width of the drawings, logical pixels."""

_WHEELS, _FILTER = "what the wheels report", "where the filter believes the robot may be"


class NoiseView(QScrollArea):
    """Drawings of the effect of the noise, updated after each change."""

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setAccessibleName("Effect of the noise")
        self._work = BackgroundWorker(self, "noise")
        self._work.done.connect(self._show)
        self._requested: tuple[StudyDraft, dict[str, str]] | None = None
        self.drawn = 0
        waits = "Drawing ..."
        self._straight, self._square, self._scan = (label(waits, "small") for _ in range(3))
        self._pictures = {
            name: NoisePicture(paint, what, height, self.redraw)
            for name, paint, what, height in (
                ("straight", fan_painter("straight", believed=False), f"Ten meters straight: {_WHEELS}", 130),
                ("straight believed", fan_painter("straight", believed=True), f"Ten meters straight: {_FILTER}", 130),
                ("square", fan_painter("square", believed=False), f"A square: {_WHEELS}", 190),
                ("square believed", fan_painter("square", believed=True), f"A square: {_FILTER}", 190),
                ("scan", room, "A laser sweep in a room", 230),
            )
        }
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), 2 * GAP, GAP, 0, GAP, GAP)
        column.addWidget(self._drives())
        column.addWidget(self._sweep())
        column.addStretch(1)
        self.setWidget(inside)

    @property
    def busy(self) -> bool:
        """True while drawings are being made."""
        return self._work.busy

    def draw(self, draft: StudyDraft, values: Mapping[str, str]) -> None:
        """Draw the noise of a draft; `values` are the texts typed since the draft was made, by key."""
        self._requested = draft, dict(values)
        group = draft.groups().get("noise")
        if group is None or not self.isVisible():
            return
        study = draft.study or Study()
        # Copy the values and measure the widgets in this thread; the worker's thread must not use widgets.
        fields, typed = tuple(group.all_fields()), dict(values)
        palette = colours()
        jobs = [(name, picture.paint, picture.canvas(palette)) for name, picture in self._pictures.items()]
        self._work.ask(lambda: _drawn(preview_of(study, noise_from_form(fields, typed)), jobs))

    def redraw(self) -> None:
        """Draw the same noise in another size or in other colors."""
        if self._requested is not None:
            self.draw(*self._requested)

    def close_work(self) -> None:
        """Wait until the current drawings are finished."""
        self._work.close()

    @Slot(object)
    def _show(self, outcome: object) -> None:
        if not isinstance(outcome, _Drawn):
            return
        preview = outcome.preview
        words = {
            "straight": extent_of(preview.straight.wheels),
            "straight believed": extent_of(preview.straight.believed),
            "square": extent_of(preview.square.wheels),
            "square believed": extent_of(preview.square.believed),
            "scan": preview.scan_words,
        }
        for name, image in outcome.images.items():
            self._pictures[name].show_image(image, words[name])
        straight, square = preview.straight, preview.square
        self._straight.setText(
            f"Wheels: {words['straight']}.\nFilter: {words['straight believed']}.\n{straight.verdict}"
        )
        self._square.setText(f"Wheels: {words['square']}.\nFilter: {words['square believed']}.\n{square.verdict}")
        self._scan.setText(preview.scan_words)
        self.drawn += 1

    def _drives(self) -> QWidget:
        drawn = "Thick line: commanded path. Thin lines: 200 drives. Ellipse: area of 95 % of the end points."
        card, column = _card("200 drives of ten meters", drawn)
        column.addWidget(label("Paths that the wheels report (true noise)", "small", bold=True))
        column.addWidget(self._pictures["straight"])
        column.addWidget(label("Belief of the particle filter (dashed)", "small", bold=True))
        column.addWidget(self._pictures["straight believed"])
        column.addWidget(self._straight)
        grid = spaced(QGridLayout(), GAP)
        grid.addWidget(label("Around a square: wheels", "small", bold=True), 0, 0)
        grid.addWidget(label("Around a square: belief", "small", bold=True), 0, 1)
        grid.addWidget(self._pictures["square"], 1, 0)
        grid.addWidget(self._pictures["square believed"], 1, 1)
        column.addSpacing(GAP)
        column.addLayout(grid)
        column.addWidget(self._square)
        return card

    def _sweep(self) -> QWidget:
        drawn = "Dots: true end points of the beams. Crosses: end points measured by the laser."
        card, column = _card("A laser sweep in a room", drawn)
        column.addWidget(self._pictures["scan"])
        column.addWidget(self._scan)
        return card

    def sizeHint(self) -> QSize:
        """Return a size that is wide enough for two squares."""
        return QSize(520, 640)


class NoisePage(QSplitter):
    """Page with the fields and the drawings side by side or, if it is narrow, one below the other."""

    def __init__(self, fields: QWidget, drawings: NoiseView) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.addWidget(fields)
        self.addWidget(drawings)
        self.setChildrenCollapsible(False)
        self.setSizes([500, 500])
        follow_text(fields, lambda it: it.setMinimumWidth(220 + px(180)))
        follow_text(self, NoisePage._turn)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the parts to fit the new width."""
        super().resizeEvent(event)
        self._turn()

    def _turn(self) -> None:
        side_by_side = self.width() >= 220 + px(180) + _DRAWINGS
        wanted = Qt.Orientation.Horizontal if side_by_side else Qt.Orientation.Vertical
        if wanted != self.orientation():
            self.setOrientation(wanted)
            self.setSizes([500, 500])


@dataclass(frozen=True, slots=True, eq=False)
class _Drawn:
    """Preview of the noise, and its finished images."""

    preview: NoisePreview
    images: Mapping[str, QImage]


def _card(title: str, drawn: str) -> tuple[QWidget, QVBoxLayout]:
    """Return a panel with a title and a legend, and its column."""
    card = QWidget()
    style_as_panel(card)
    column = spaced(QVBoxLayout(card), GAP, 2 * GAP)
    column.addWidget(label(title, bold=True))
    column.addWidget(label(drawn, "small", muted=True))
    return card, column


def _drawn(preview: NoisePreview, jobs: list[tuple[str, PaintFunction, Canvas]]) -> _Drawn:
    return _Drawn(preview, {name: paint(preview, canvas) for name, paint, canvas in jobs})

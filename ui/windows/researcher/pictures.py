"""Pictures of the map and the plots, copied or saved as PNG or SVG; videos of recordings, saved as MP4 or GIF."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pyqtgraph as pg
import pyqtgraph.exporters
from PySide6.QtCore import QObject, QPoint, QProcess, QTimer, Signal
from PySide6.QtGui import QGuiApplication, QImage, QPainter
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QWidget

FRAMES_PER_SECOND = 25
"""Frames per second of a video. One second of the video shows one second of recorded time."""
MOST_WAITING = 32 * 2**20
"""Maximum number of bytes in the queue to ffmpeg. While there are more bytes, no new frame is drawn."""
NO_FFMPEG = "Videos need the program ffmpeg. Install ffmpeg (Debian: apt install ffmpeg), then save the video again."


def image_of(part: QWidget) -> QImage:
    """Return a picture of a part of the window in its current state.

    A picture of plots also includes the parts that are scrolled out of view.
    """
    if isinstance(part, pg.GraphicsView):
        picture: QImage = pyqtgraph.exporters.ImageExporter(part.scene()).export(toBytes=True)
        return picture
    return part.grab().toImage()


def copy_picture(part: QWidget) -> None:
    """Copy a picture of a part of the window to the clipboard."""
    QGuiApplication.clipboard().setImage(image_of(part))


def save_picture(part: QWidget, path: Path) -> str:
    """Save a picture of a part of the window. Return the reason if that is not possible, otherwise an empty text.

    Args:
        part: the map, or a widget with plots.
        path: target file. With the suffix `.svg`, the picture is a vector graphic; otherwise it consists of pixels.
    """
    if path.suffix.lower() != ".svg":
        saved = image_of(part).save(str(path))
        return "" if saved else f"Cannot write {path}. Choose another folder, or a name that ends in .png or .svg."
    try:
        path.touch()
    except OSError as error:
        return f"Cannot write {path} ({error.strerror}). Choose another folder."
    # Qt renders the picture, because pyqtgraph's own exporter fails on curves with gaps.
    generator = QSvgGenerator()
    generator.setFileName(str(path))
    generator.setSize(part.size())
    generator.setResolution(part.logicalDpiX())
    generator.setViewBox(part.rect())
    painter = QPainter(generator)
    QWidget.render(part, painter, QPoint())
    painter.end()
    return ""


class VideoWriter(QObject):
    """Writer of a video of a recording's section. It works frame by frame, so that the window remains usable.

    Args:
        path: path of the video; the suffix decides the format.
        span: first and last moment, seconds since the beginning.
        frame: function that shows the recording at a time and returns a picture. All pictures have the same size.
        program: path of ffmpeg.
        parent: owner of the writer; Qt deletes both together.

    Signals:
        progressed: more frames were written; with the completed share, 0 to 1.
        ended: the video was saved or saving failed; with the reason for a failure, or an empty text.
    """

    progressed = Signal(float)
    ended = Signal(str)

    def __init__(
        self, path: Path, span: tuple[float, float], frame: Callable[[float], QImage], program: str, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._path, self._frame = path, frame
        # ffmpeg writes to another file name, so that a failed video never replaces an earlier video.
        self._part = path.with_name(f".{path.stem}.part{path.suffix}")
        count = max(2, round((span[1] - span[0]) * FRAMES_PER_SECOND))
        self._times = [span[0] + number / FRAMES_PER_SECOND for number in range(count)]
        self._done = 0
        self._process = QProcess(self)
        self._process.finished.connect(self._finish)
        self._process.errorOccurred.connect(lambda _: self._fail("ffmpeg did not start, or stopped too early"))
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._next)
        first = self._picture(0)
        size = f"{first.width()}x{first.height()}"
        raw = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", size, "-r", str(FRAMES_PER_SECOND), "-i", "-"]
        self._process.start(program, ["-y", "-loglevel", "error", *raw, *_format(path), str(self._part)])
        self._timer.start(0)

    def cancel(self) -> None:
        """Stop saving, and remove the unfinished file."""
        self._timer.stop()
        self._process.blockSignals(True)
        self._process.kill()
        self._process.waitForFinished(1000)
        self._part.unlink(missing_ok=True)

    def _picture(self, number: int) -> QImage:
        return self._frame(self._times[number]).convertToFormat(QImage.Format.Format_RGBA8888)

    def _next(self) -> None:
        if self._process.bytesToWrite() > MOST_WAITING:
            return  # ffmpeg is slower than the drawing, so more frames would only fill the memory.
        if self._done == len(self._times):
            self._timer.stop()
            self._process.closeWriteChannel()
            return
        picture = self._picture(self._done)
        self._process.write(bytes(picture.constBits()))
        self._done += 1
        self.progressed.emit(self._done / len(self._times))

    def _finish(self, code: int) -> None:
        if code != 0:
            printed = bytes(self._process.readAllStandardError().data()).decode(errors="replace").strip()
            self._fail(printed or f"ffmpeg ended with exit code {code}")
            return
        try:
            self._part.replace(self._path)
        except OSError as error:
            self._fail(error.strerror or str(error))
            return
        self.ended.emit("")

    def _fail(self, reason: str) -> None:
        self._timer.stop()
        self._process.blockSignals(True)
        self._part.unlink(missing_ok=True)
        self.ended.emit(f"Cannot save {self._path}: {reason}.")


def ffmpeg() -> str | None:
    """Return the path of ffmpeg; None if it is not installed."""
    return shutil.which("ffmpeg")


def _format(path: Path) -> list[str]:
    """Return ffmpeg's options for a file. Many players require an even width and height of frames."""
    if path.suffix.lower() == ".gif":
        return ["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-r", "12.5"]
    return ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]

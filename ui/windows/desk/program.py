"""Program of the desk. It is hosted by the program that runs the study, or it only watches the study's folder."""

from PySide6.QtCore import QObject, QTimer

from thbridge.experiment.folder import ExperimentFolder
from ui.model.desk.messages import DESK, DeskState, FromDesk, ShowRun
from ui.sources.experiment import ExperimentSource
from ui.windows.application import application
from ui.windows.desk.window import DeskWindow
from ui.windows.editing.background import BackgroundWorker
from ui.windows.host_pipe import HostPipe
from ui.windows.look import Choice
from ui.windows.preferences import preferences_of

POLL = 1000
"""Milliseconds between two reads of a study's log."""
RENEWED = 20
"""The durations of runs are computed again after this number of reads of the log without new entries."""
READ_ONLY = (
    "This window only watches the log and cannot change runs or notes. Use the window that "
    "`thbridge study run --desk` opens."
)
CLOSING = (
    "Close the desk? The study continues at the kiosk, but you can no longer start, end or exclude runs from here. "
    "`thbridge study watch` shows the study again, but cannot change it."
)


class LogWatch(QObject):
    """Watcher of a study's log. A separate thread reads the growing log, and the desk shows it.

    Args:
        desk: the window.
        source: the study.
        period: milliseconds between two reads of the log.
    """

    def __init__(self, desk: DeskWindow, source: ExperimentSource, period: int = POLL) -> None:
        super().__init__(desk)
        self._source = source
        self._shown = ""
        self._idle = RENEWED
        self._work = BackgroundWorker(self, "log")
        self._work.done.connect(lambda state: None if state is None else desk.receive(state))
        desk.asked.connect(self._ask)
        self._timer = QTimer(self, interval=period)
        self._timer.timeout.connect(self._look_if_idle)
        self._timer.start()
        self._look()

    def close(self) -> None:
        """Wait until the current work is finished."""
        self._timer.stop()
        self._work.close()

    def _look_if_idle(self) -> None:
        if not self._work.busy:
            self._look()

    def _ask(self, message: FromDesk) -> None:
        if isinstance(message, ShowRun):
            self._shown = message.participant
            self._idle = RENEWED
            self._look()

    def _look(self) -> None:
        shown = self._shown
        self._work.ask(lambda: self._read(shown))

    def _read(self, shown: str) -> DeskState | None:
        self._idle = RENEWED if self._source.poll() else self._idle + 1
        if self._idle < RENEWED:
            return None
        self._idle = 0
        return self._source.state(shown, read_only=READ_ONLY)


def show_hosted(folder: ExperimentFolder, choice: Choice) -> int:
    """Open the desk for its host, which uses standard input and output. Return the exit code after it is closed."""
    app = application()
    preferences = preferences_of(app, "desk", choice)
    desk = DeskWindow(CLOSING, folder)
    preferences.add_keys(desk)
    preferences.keep_place(desk)
    pipe = HostPipe(DESK)
    desk.asked.connect(pipe.send)
    pipe.listen(desk)
    desk.show()
    return app.exec()


def show_folder(source: ExperimentSource, choice: Choice) -> int:
    """Open the desk to watch a study's folder, without control of the study. Return the exit code when it is closed."""
    app = application()
    preferences = preferences_of(app, "desk", choice)
    desk = DeskWindow(folder=source.folder)
    preferences.add_keys(desk)
    preferences.keep_place(desk)
    watch = LogWatch(desk, source)
    desk.show()
    code = app.exec()
    watch.close()
    return code

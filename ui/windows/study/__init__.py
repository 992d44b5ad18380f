"""Window that shows a study file as a form."""

from pathlib import Path

from thbridge.study.noise import NoiseSection
from thbridge.study.study_file import Study
from ui.first_start.bar import START_BAR
from ui.model.study_form.noise import preview_of
from ui.windows.application import application
from ui.windows.look import Choice
from ui.windows.preferences import preferences_of
from ui.windows.study.window import StudyWindow


def study_window(path: Path) -> StudyWindow:
    """Return the window of a file without showing the window. A QApplication must exist.

    Raises:
        BadFile: the file cannot be read.
    """
    # Load compiled code now, because loading would block the visible window later.
    preview_of(Study(), NoiseSection())
    return StudyWindow(path)


def edit(path: Path, choice: Choice = "system") -> int:
    """Open the window, wait until it is closed, and return the program's exit code.

    Raises:
        BadFile: the file cannot be read.
    """
    app = application()
    preferences = preferences_of(app, "study", choice)
    window = study_window(path)
    preferences.changed.connect(window.repaint_all)
    preferences.add_keys(window)
    preferences.keep_place(window)
    START_BAR.close()
    window.show()
    return app.exec()

"""The study file as a form."""

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
    """Return the window of a file, not shown yet; it needs a QApplication and nothing else.

    Raises:
        BadFile: the file cannot be read.
    """
    # Load compiled code now: once the window is there, it must not stand still for that.
    preview_of(Study(), NoiseSection())
    return StudyWindow(path)


def edit(path: Path, choice: Choice = "system") -> int:
    """Open the window, light, dark or as the system is, and wait until it is closed; return the program's exit code.

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

"""Window that edits a template set, with sheets, texts and a preview."""

from pathlib import Path

from ui.windows.application import application
from ui.windows.look import Choice
from ui.windows.preferences import preferences_of
from ui.windows.templates.window import TemplateWindow


def edit_templates(folder: Path, choice: Choice = "system") -> int:
    """Open the window of a template set, wait until it is closed, and return the program's exit code.

    Raises:
        BadFile: one of its files cannot be read.
    """
    app = application()
    preferences = preferences_of(app, "templates", choice)
    window = TemplateWindow(folder)
    preferences.changed.connect(window.update)
    preferences.add_keys(window)
    preferences.keep_place(window)
    window.show()
    return app.exec()

"""The template set as sheets and texts, with a preview."""

from pathlib import Path

from ui.windows.application import application
from ui.windows.look import Appearance, Choice, TextSize, user_settings
from ui.windows.templates.window import TemplateWindow


def edit_templates(folder: Path, choice: Choice = "system") -> int:
    """Open the window of a template set, and wait until it is closed; return the program's exit code.

    Raises:
        BadFile: one of its files cannot be read.
    """
    app = application()
    look, text_size = Appearance(app, choice), TextSize(app, user_settings())
    window = TemplateWindow(folder)
    look.changed.connect(window.update)
    text_size.add_keys(window)
    window.show()
    return app.exec()

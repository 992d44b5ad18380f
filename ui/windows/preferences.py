"""Preferences of a window's user: light or dark colors, size of text, sound, and the window's place on the screen.

Each kind of window has its own preferences, in a file of the user's settings folder. A change in one program does not
affect windows of other running programs. For example, a participant's choice does not change the researcher's desk.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Literal
from weakref import WeakSet

from PySide6.QtCore import QByteArray, QEvent, QObject, QSettings, Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QApplication,
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from ui.model.playing.keys import SETTINGS_KEYS
from ui.model.shared.theme import DARK, LIGHT
from ui.windows import look
from ui.windows.controls import ChoiceBox
from ui.windows.look import GAP, Choice, spaced

TEXT_SIZES = (80, 90, 100, 110, 125, 150, 175, 200)
"""Sizes of text to choose from, percent of the usual size."""

WindowKind = Literal["participant", "kiosk", "watch", "desk", "study", "templates", "arena"]
"""Kind of a window. The kind is also the name of the file with the settings of these windows."""

_LOOK, _TEXT, _SOUND, _GEOMETRY, _LANGUAGE = "look", "text/percent", "sound", "geometry", "language"
_KEYS_OF = "keysOf"
"""Name of the property that stores the id of the preferences whose shortcuts a window has."""


def user_settings(name: str) -> QSettings:
    """Return the settings from the file of this name in the user's settings folder."""
    return QSettings(QSettings.Format.IniFormat, QSettings.Scope.UserScope, "thbridge", name)


def preferences_of(
    app: QApplication, kind: WindowKind, choice: Choice = "system", *, has_sound: bool = False
) -> "Preferences":
    """Return the user's preferences for a kind of window.

    Args:
        app: the application.
        kind: kind of the window.
        choice: light or dark for this run. If "system", the stored choice applies or, if there is none, the desktop's
            setting.
        has_sound: True if windows of this kind play sounds.
    """
    return Preferences(app, user_settings(kind), choice, has_sound=has_sound)


class Preferences(QObject):
    """Preferences for one kind of window. They apply to all windows of this process, and are stored for later windows.

    Args:
        app: the application.
        settings: storage of the preferences.
        choice: light or dark for this run. If "system", the stored choice applies or, if there is none, the desktop's
            setting.
        has_sound: True if windows of this kind play sounds.

    Attributes:
        changed: signal with the new palette, for widgets that paint themselves.
        sound_chosen: signal: True if the user wants sounds, False if not.
        language_chosen: signal with the language that the user wants.
        percent: size of text, percent of the usual size, which depends on the screen; see `look.usual_growth`.
        texts: texts of the settings dialog. If None, the texts are English.
        languages: languages to choose from at the moment, with their names for people.
        why_silent: function that returns a sentence with the reason why sound is not possible at the moment; empty if
            it is possible.
    """

    changed = Signal(object)
    sound_chosen = Signal(bool)
    language_chosen = Signal(str)

    def __init__(
        self,
        app: QApplication,
        settings: QSettings,
        choice: Choice = "system",
        *,
        has_sound: bool = False,
    ) -> None:
        super().__init__(app)
        self._app, self._settings = app, settings
        self._given: Choice | None = None if choice == "system" else choice
        self._growth = look.usual_growth(app.primaryScreen().availableSize())
        self.has_sound = has_sound
        self._placed: WeakSet[QWidget] = WeakSet()
        self.percent = 0
        self.texts: Texts | None = None
        self.languages: Mapping[str, str] = {}
        self.why_silent: Callable[[], str] = str
        app.styleHints().colorSchemeChanged.connect(self._apply_look)
        app.focusWindowChanged.connect(self._add_keys_to_box)
        self._apply_look()
        self._apply_text_size()

    # Choices

    @property
    def look(self) -> Choice:
        """Colors of windows: light, dark, or the desktop's setting."""
        kept = self._value(_LOOK, "system")
        chosen: Choice = "light" if kept == "light" else "dark" if kept == "dark" else "system"
        return self._given or chosen

    def choose_look(self, choice: Choice) -> None:
        """Switch to light colors, to dark colors, or to the desktop's setting."""
        self._given = None
        self._keep(_LOOK, choice)
        self._apply_look()

    def choose_text_size(self, percent: int) -> None:
        """Set the size of all text, one of `TEXT_SIZES`."""
        self._keep(_TEXT, percent)
        self._apply_text_size()

    def step_text_size(self, by: int) -> None:
        """Choose the next larger (1), the next smaller (-1) or the normal (0) size of text."""
        at = TEXT_SIZES.index(self.percent if by else 100) + by
        self.choose_text_size(TEXT_SIZES[min(max(at, 0), len(TEXT_SIZES) - 1)])

    @property
    def sound_on(self) -> bool:
        """True if the user wants sounds."""
        return self._value(_SOUND, "true") != "false"

    def choose_sound(self, on: bool) -> None:
        """Switch sounds on or off."""
        self._keep(_SOUND, "true" if on else "false")
        self.sound_chosen.emit(on)

    @property
    def language(self) -> str:
        """Name of the language that the user wants; empty if the user has no preference."""
        return self._value(_LANGUAGE, "")

    def choose_language(self, language: str) -> None:
        """Store the language, and emit `language_chosen`."""
        self._keep(_LANGUAGE, language)
        self.language_chosen.emit(language)

    def forget(self) -> None:
        """Reset the preferences to the defaults, for the next person."""
        self._settings.clear()
        self._settings.sync()
        self._apply_look()
        self._apply_text_size()

    # Windows

    def keep_place(self, window: QWidget) -> None:
        """Give a window the size and place of the last closed window of this kind.

        When the window closes, its own size and place are stored.
        """
        kept = self._settings.value(_GEOMETRY)
        if isinstance(kept, QByteArray) and not any(each.isVisible() for each in self._placed):
            window.restoreGeometry(kept)
        self._placed.add(window)
        window.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Store the size and place of a window that closes."""
        if event.type() == QEvent.Type.Close and isinstance(watched, QWidget):
            self._keep(_GEOMETRY, watched.saveGeometry())
        return False

    def add_keys(self, window: QWidget) -> None:
        """Add the shortcuts for the size of text and for the settings to a window and to its dialogs."""
        window.setProperty(_KEYS_OF, id(self))
        for keys, step in ((("Ctrl++", "Ctrl+="), 1), (("Ctrl+-",), -1), (("Ctrl+0",), 0)):
            shortcut = QShortcut(window)
            shortcut.setKeys([QKeySequence(key) for key in keys])
            shortcut.activated.connect(partial(self.step_text_size, step))
        if not isinstance(window, SettingsDialog):
            QShortcut(QKeySequence(SETTINGS_KEYS), window).activated.connect(partial(self.open, window))

    def open(self, window: QWidget) -> "SettingsDialog":
        """Open the settings dialog over a window."""
        dialog = SettingsDialog(self, window)
        dialog.open()
        return dialog

    def _add_keys_to_box(self) -> None:
        """Add the shortcuts to the dialog that became active, because a dialog may block its window's shortcuts."""
        box = self._app.activeWindow()
        opener = None if box is None else box.parentWidget()
        if box is None or opener is None or box.property(_KEYS_OF) == id(self):
            return
        if opener.window().property(_KEYS_OF) == id(self):
            self.add_keys(box)

    # Storage and application

    def _value(self, key: str, default: str) -> str:
        return str(self._settings.value(key, default))

    def _keep(self, key: str, value: object) -> None:
        self._settings.setValue(key, value)
        self._settings.sync()

    def _apply_look(self) -> None:
        system_is_dark = self._app.styleHints().colorScheme() == Qt.ColorScheme.Dark
        palette = DARK if self.look == "dark" or (self.look == "system" and system_is_dark) else LIGHT
        look.apply_palette(self._app, palette)
        self.changed.emit(palette)

    def _apply_text_size(self) -> None:
        kept = self._value(_TEXT, "100")
        percent = min(TEXT_SIZES, key=lambda size: abs(size - int(kept))) if kept.isdecimal() else 100
        if percent != self.percent:
            self.percent = percent
            look.apply_text_size(self._app, self._growth * percent / 100.0)


class SettingsDialog(QDialog):
    """Settings dialog. Each choice takes effect at once.

    Args:
        preferences: preferences to change.
        parent: the window.
    """

    def __init__(self, preferences: Preferences, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        look.style_as_panel(self)  # Without a window manager, for example at a kiosk, the dialog would have no edge.
        say = (preferences.texts or shipped_texts()).text
        self.setWindowTitle(say("settings.title"))
        self.look, self.text_size, self.sound = ChoiceBox(), ChoiceBox(), QCheckBox(say("settings.sound_on"))
        for name, choice in (("system", "system"), ("light", "light"), ("dark", "dark")):
            self.look.addItem(say(f"settings.look_{name}"), choice)
        self.look.setCurrentIndex(self.look.findData(preferences.look))
        self.look.activated.connect(lambda _: preferences.choose_look(self.look.currentData()))
        for percent in TEXT_SIZES:
            self.text_size.addItem(say("words.percent", number=percent), percent)
        self.text_size.setCurrentIndex(self.text_size.findData(preferences.percent))
        self.text_size.activated.connect(lambda _: preferences.choose_text_size(self.text_size.currentData()))
        self.sound.setChecked(preferences.sound_on)
        self.sound.toggled.connect(preferences.choose_sound)
        form = QFormLayout()
        form.setSpacing(2 * GAP)
        form.addRow(say("settings.look"), self.look)
        form.addRow(say("settings.text_size"), self.text_size)
        if preferences.has_sound:
            why_not = preferences.why_silent()
            self.sound.setEnabled(not why_not)
            form.addRow(say("settings.sound"), self.sound)
            form.addRow("", look.label(why_not or say("settings.sound_hint"), "small", muted=True))
        self.language = ChoiceBox()
        if preferences.languages and preferences.texts is not None:
            for name, title in preferences.languages.items():
                self.language.addItem(title, name)
            self.language.setCurrentIndex(self.language.findData(preferences.texts.language))
            self.language.activated.connect(lambda _: self._speak(preferences))
            form.addRow(say("settings.language"), self.language)
        done = QDialogButtonBox()
        done.addButton(say("settings.close"), QDialogButtonBox.ButtonRole.RejectRole)
        done.rejected.connect(self.reject)
        rows = spaced(QVBoxLayout(self), 3 * GAP, 3 * GAP)
        rows.addLayout(form)
        rows.addWidget(look.label(say("settings.kept"), "small", muted=True))
        rows.addWidget(done)

    def _speak(self, preferences: Preferences) -> None:
        """Choose the language. The dialog closes, because its own texts are in the previous language."""
        self.accept()
        preferences.choose_language(self.language.currentData())

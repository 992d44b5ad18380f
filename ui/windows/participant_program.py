"""Participant's window as a program. It connects to a server itself, or the program that runs the games hosts it.

The program joins the window (`ParticipantWindow`), its model (`Participant`) and the thread that communicates with the
server (`ParticipantLink`).
"""

import time
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QApplication,
    QHBoxLayout,
    QMainWindow,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.keys.key_file import ClientKey
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.shared.view import GiveConsent
from thbridge.sockets.reconnecting import ConnectionLost, LossReason
from ui.command_line.terminal import DECLINED, FAILED, note
from ui.model.lobby import (
    LOBBY,
    Agreed,
    Back,
    Begin,
    ChooseLanguage,
    Declined,
    FromHost,
    FromWindow,
    Join,
    Offer,
    Practise,
    Preparing,
    Thanks,
    WindowClosed,
)
from ui.model.playing.participant import Participant
from ui.model.playing.practice import advice
from ui.model.playing.screen import CloseWindow, Phase, SwitchSound
from ui.model.shared.theme import Palette
from ui.sources.game import ServerReached, why_lost
from ui.windows import look, pointer
from ui.windows.application import application
from ui.windows.host_pipe import HostPipe
from ui.windows.link import ParticipantLink
from ui.windows.look import GAP, spaced
from ui.windows.participant.pages.pages import ConnectingPage, ThanksPage, consent_page
from ui.windows.participant.pages.start import StartPage
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.panels import set_text
from ui.windows.participant.window import ParticipantWindow
from ui.windows.preferences import Preferences, preferences_of
from ui.windows.sounds import SoundPlayer, system_player

FRAME = 15
"""Milliseconds between two polls of the link."""


class GamePage(QWidget):
    """Page with a game at a server: the participant's window, model and link, and in practice a strip with advice.

    As soon as the server has sent the language of the game, the page uses this language.

    Args:
        link: link to the server, not started yet.
        texts: texts to use until the server has sent the language.
        preferences: preferences of the participant.
        practice: True for the practice game, which has a strip with the next task.
        back: function that returns to the start page from practice or from the end of the game. If None, the
            participant cannot return.
        clock: monotonic clock, seconds.
        way_back: label of the button that returns; its language does not change.
        once: True if there is only one game, after which another part of a study follows. The end page of the game
            then stays unchanged.
        cancel: function that cancels before the game is reached. If None, there is no button *Cancel*.

    Attributes:
        seen_over: signal: the page shows the end of the game.
        declined: signal: the participant declines to take part in the study.
        went_on: signal: the participant continues after the game.
        help_shown: signal: the sheet of rules and keys was opened or closed.
        refused: signal: the server refuses this program, with the reason.
    """

    refused = Signal(str)
    seen_over = Signal()
    declined = Signal()
    went_on = Signal()
    help_shown = Signal(bool)

    def __init__(
        self,
        link: ParticipantLink,
        texts: Texts,
        preferences: Preferences,
        practice: bool,
        back: Callable[[], None] | None,
        clock: Callable[[], float],
        way_back: str = "",
        once: bool = False,
        cancel: Callable[[], None] | None = None,
    ) -> None:
        super().__init__()
        self._cancel = cancel
        self._link = link
        self._clock = clock
        self._practice = practice
        self._once = once
        self._is_over = False
        self._preferences, command = preferences, system_player()
        self._model = Participant(texts=texts, sound_on=preferences.sound_on, can_sound=command is not None, once=once)
        preferences.why_silent = lambda: self._model.why_silent
        self._sound_on = self._model.sound_on
        self._sounds = SoundPlayer(self, command)
        self._texts = texts
        preferences.changed.connect(self._set_palette)
        preferences.sound_chosen.connect(self._choose_sound)
        self._rows = spaced(QVBoxLayout(self), 0, 0)
        self._strip, self._advice, self._to_do = QWidget(), look.label(), look.label(size="small", muted=True)
        self._way_back: tuple[ActionButton, str] | None = None
        self._must_do: tuple[str, ...] = ()
        self._back, self._back_label = back if practice or not once else None, way_back
        self._shows_end = False
        if self._back is not None:
            key = QShortcut(QKeySequence("F10"), self)
            key.setAutoRepeat(False)
            key.activated.connect(self._go_back)
        if practice:
            self._build_strip()
            self._rows.addWidget(self._strip)
        self._open_window()
        link.start()

    def _open_window(self) -> None:
        """Open the game's window in the language of the model."""
        texts = self._preferences.texts = self._texts
        self.setWindowTitle(texts.text("window.title"))
        self._strip.setAccessibleName(texts.text("pages.practice_game"))
        self.window_of_game = window = ParticipantWindow(
            self._model, self._clock, look.colours(), can_cancel=self._cancel is not None
        )
        if self._cancel is not None:
            window.connecting.cancelled.connect(self._cancel)
        window.sounded.connect(self._sounds.play)
        window.declined.connect(self.declined)
        window.went_on.connect(self.went_on)
        window.help_shown.connect(self.help_shown)
        window.settings_wanted.connect(lambda: self._preferences.open(self))
        if self._back is not None and not self._practice:
            window.ending.add_way_back(self._make_way_back())
        self._rows.addWidget(window, 1)
        self.setFocusProxy(window)

    def _follow_language(self) -> None:
        """Open the game's window again if the server has sent another language."""
        if self._model.texts is self._texts:
            return
        before, self._texts = self._texts, self._model.texts
        if self._texts == before:
            return
        gone = self.window_of_game
        # If no widget has the focus, set the focus now, so that it takes effect when the window becomes active.
        focus = QApplication.focusWidget()
        had_focus = focus is None or focus is gone or gone.isAncestorOf(focus)
        self._open_window()
        self.window_of_game.help.instructions = gone.help.instructions
        # Show the window now. The layout would show it later, and the window could not accept the focus before.
        self.window_of_game.show()
        gone.close()
        self._rows.removeWidget(gone)
        gone.deleteLater()
        if had_focus:
            self.setFocus()

    def _set_palette(self, palette: Palette) -> None:
        self.window_of_game.set_palette(palette)

    def _build_strip(self) -> None:
        row = QHBoxLayout(self._strip)
        row.setContentsMargins(2 * GAP, GAP, 2 * GAP, GAP)
        title = look.label(self._texts.text("pages.practice"), bold=True)
        title.setWordWrap(False)
        row.addWidget(title)
        row.addSpacing(2 * GAP)
        # Give advice of one line the height of two lines, so that the map below does not move.
        look.follow_text(self._advice, lambda it: it.setMinimumHeight(2 * it.fontMetrics().lineSpacing()))
        said = spaced(QVBoxLayout(), 0, 0)
        said.addWidget(self._advice)
        said.addWidget(self._to_do)
        self._to_do.hide()
        row.addLayout(said, 1)
        if self._back is not None:
            button = self._make_way_back()
            self._way_back = button, self._back_label
            row.addWidget(button)

    def _make_way_back(self) -> ActionButton:
        button = ActionButton(self._texts)
        button.show_face(ButtonFace(self._back_label, "F10"), self._back_label)
        button.clicked.connect(self._go_back)
        return button

    def _go_back(self) -> None:
        if self._back is not None and not self._must_do and (self._practice or self._shows_end):
            self._back()

    def require(self, to_do: tuple[str, ...]) -> None:
        """Enable the button that returns only after all tasks in `to_do` are done."""
        if self._way_back is None or to_do == self._must_do:
            return
        self._must_do = to_do
        button, label = self._way_back
        texts = self._texts
        said = texts.text("pages.before_you_go_on", to_do=", ".join(to_do)) if to_do else texts.text("pages.done")
        button.show_face(ButtonFace(label, "F10", not to_do, said if to_do else ""), label)
        set_text(self._to_do, said)
        self._to_do.show()
        if not to_do:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, said))

    @property
    def texts(self) -> Texts:
        """Texts of the game, in its language."""
        return self._texts

    @property
    def in_progress(self) -> bool:
        """True if the participant would lose a game by leaving at this moment."""
        return not self._practice and self._model.screen(self._clock()).phase is Phase.PLAYING

    @property
    def leaving(self) -> bool:
        """True once the participant has confirmed leaving."""
        return self._model.leaving

    def ask_to_leave(self, ends: bool) -> None:
        """Ask the participant whether to leave the game; `ends` is True if leaving ends the game."""
        self.window_of_game.do(CloseWindow(ends))

    def pump(self) -> None:
        """Handle the events that the link has received, and pass on the open requests."""
        if self._once and self._is_over:
            return  # The server of this game may have stopped.
        now = self._clock()
        for received in self._link.take_events():
            match received.event:
                case ServerReached():
                    self._model.connected(received.time)
                case ConnectionLost() as lost:
                    self._model.lost(why_lost(self._model.texts, lost), received.time)
                    if lost.reason is LossReason.REFUSED:
                        self.refused.emit(lost.detail)
                case notice:
                    self._model.receive(notice, received.time)
        self._follow_language()
        self._link.request(self._model.requests())
        if self._model.sound_on != self._sound_on:
            self._keep_sound(self._model.sound_on)
        screen = self._model.screen(now)
        if self._practice:
            set_text(self._advice, advice(self._texts, screen))
        self._shows_end = screen.phase is Phase.OVER
        if self._shows_end and not self._is_over:
            self._is_over = True
            self.seen_over.emit()

    @property
    def is_over(self) -> bool:
        """True once the page shows the end of the game."""
        return self._is_over

    def disconnect_from_game(self) -> None:
        """Disconnect from the server, but continue to show the end of the game."""
        self._link.stop()

    def _choose_sound(self, on: bool) -> None:
        """Apply a change of the sound setting to this game."""
        if on != self._model.sound_on:
            self.window_of_game.do(SwitchSound())
            self._keep_sound(on)

    def _keep_sound(self, on: bool) -> None:
        """Store the participant's choice of sound for other games. If sound is off, stop all sounds at once."""
        self._sound_on = on
        self._preferences.choose_sound(on)
        if not on:
            self._sounds.stop()

    def decline(self) -> None:
        """Report to the server that the participant declines to take part."""
        self._link.decline()

    def leave(self) -> None:
        """Disconnect from the server."""
        self._link.stop()
        self._sounds.stop()
        self._preferences.why_silent = str
        self.window_of_game.close()


class ParticipantMainWindow(QMainWindow):
    """Participant's main window, which shows one page at a time.

    Args:
        preferences: preferences of the participant.
        send: function that sends a message to the host. If None, there is no host.
        clock: monotonic clock, seconds.
        texts: texts in the window's language. If None, the first message of the host brings the texts.
    """

    _texts: Texts

    def __init__(
        self,
        preferences: Preferences,
        send: Callable[[FromWindow], None] | None,
        clock: Callable[[], float] = time.monotonic,
        texts: Texts | None = None,
    ) -> None:
        super().__init__()
        self._clock = clock
        self._preferences = preferences
        self._send_to_host = send
        self._leaving = self._going_back = False
        self.declined = False
        """True once the participant has declined to take part."""
        self.game: GamePage | None = None
        if texts is not None:
            self._use_texts(texts)
        self.setMinimumSize(800, 480)
        look.open_within_screen(self)
        self._pages = QStackedWidget()
        self.setCentralWidget(self._pages)
        QShortcut(QKeySequence.StandardKey.Quit, self, self.close)
        self._pumping = QTimer(self)
        self._pumping.setTimerType(Qt.TimerType.PreciseTimer)
        self._pumping.timeout.connect(self._pump)
        self._pumping.start(FRAME)
        preferences.language_chosen.connect(self._choose_language)

    def receive(self, message: FromHost) -> None:
        """Act on a message from the host."""
        match message:
            case Offer():
                self._going_back = False
                self._use_texts(message.texts)
                self._preferences.languages = message.languages
                wanted = self._preferences.language
                if wanted in message.languages and wanted != message.texts.language:
                    self._send(ChooseLanguage(wanted))
                    return
                if message.consent:
                    self._ask_for_consent(message.consent)
                else:
                    self._show_start(message)
            case Preparing(sentence):
                page = ConnectingPage(self._texts, can_cancel=True)
                page.show_waiting(sentence)
                page.cancelled.connect(partial(self._cancel, page))
                self._show(page)
            case Join(host, port, token, practice, agreed_at, seat) if not self._going_back:
                consent = GiveConsent(agreed_at) if agreed_at else None
                self.join(ParticipantLink(host, port, token, consent, seat=seat), practice)
            case Thanks(texts) if not isinstance(self._pages.currentWidget(), ThanksPage):
                self._use_texts(texts)
                self._show_thanks()

    def _use_texts(self, texts: Texts) -> None:
        """Use these texts from now on."""
        self._texts = self._preferences.texts = texts
        self.setWindowTitle(texts.text("window.title"))

    def join(self, link: ParticipantLink, practice: bool = False, once: bool = False) -> None:
        """Show the page of a game; `once` is True if no other game follows."""
        back = None if self._send_to_host is None else lambda: self._send(Back())
        way_back = self._texts.text("pages.back_to_start")
        cancel = back or self.leave
        self._preferences.languages = {}  # The language of a game does not change.
        game = GamePage(link, self._texts, self._preferences, practice, back, self._clock, way_back, once, cancel)
        game.declined.connect(self._decline)
        game.windowTitleChanged.connect(self.setWindowTitle)
        self._show(game)
        self.game = game

    def _choose_language(self, language: str) -> None:
        self._send(ChooseLanguage(language))

    def _cancel(self, page: ConnectingPage) -> None:
        """Ask the host to return to the start page. The host does this after the game's program has stopped."""
        self._going_back = True
        page.cancel.setEnabled(False)
        page.show_waiting(self._texts.text("pages.going_back"))
        self._send(Back())

    def leave(self) -> None:
        """Close the window without a question."""
        self._leaving = True
        self.close()

    def closeEvent(self, event: QCloseEvent) -> None:
        """In the middle of a game, ask for confirmation before the window closes."""
        if not self._leaving and self.game is not None and self.game.in_progress:
            event.ignore()
            self.game.ask_to_leave(ends=self._send_to_host is not None)
            return
        self._pumping.stop()
        if self.game is not None:
            self.game.leave()
            self.game = None
        self._send(WindowClosed())
        event.accept()
        QApplication.quit()

    def _ask_for_consent(self, text: str) -> None:
        sent = False

        def answer(agrees: bool) -> None:
            nonlocal sent
            if not sent and agrees:
                self._send(Agreed())
            elif not sent:
                self._decline()
            sent = True

        self._show(consent_page(self._texts, text, answer, self._texts.text("game.decline_hint")))

    def _decline(self) -> None:
        """Report to the host that the participant declined, and thank the participant."""
        self.declined = True
        if self.game is not None:
            self.game.decline()
        self._send(Declined())
        self._show_thanks()

    def _show_thanks(self) -> None:
        texts = self._texts if self.game is None else self.game.texts
        hosted = self._send_to_host is not None
        page = ThanksPage(texts, texts.text("pages.not_recorded" if hosted else "pages.not_taking_part"))
        page.close_button.clicked.connect(self.leave)
        self._show(page)

    def _show_start(self, offer: Offer) -> None:
        page = StartPage(offer.texts, offer.least, offer.most, offer.usual, offer.rules)
        page.start.connect(lambda robots: self._send(Begin(robots)))
        page.tutorial.connect(lambda: self._send(Practise()))
        page.settings_wanted.connect(lambda: self._preferences.open(self))
        self._show(page)

    def _send(self, message: FromWindow) -> None:
        if self._send_to_host is not None:
            self._send_to_host(message)

    def _show(self, page: QWidget) -> None:
        if self.game is not None:
            self.game.leave()
            self.game = None
        pointer.note_rest(self)
        before = self._pages.currentWidget()
        self._pages.addWidget(page)
        self._pages.setCurrentWidget(page)
        if before is not None:
            self._pages.removeWidget(before)
            before.deleteLater()
        page.setFocus()

    def _pump(self) -> None:
        if self.game is not None:
            self.game.pump()
            if self.game.leaving:
                self.leave()


def play_at(
    host: str,
    port: int,
    token: str,
    choice: look.Choice,
    key: ClientKey | None = None,
    seat: str = "",
    by: PlayedBy = PlayedBy.PERSON,
) -> int:
    """Open the window for a game at a server. Return the exit code when it is closed.

    Args:
        host: host of the server.
        port: port of the server.
        token: id of this run of the program.
        choice: colors of the window.
        key: key to present; None for none.
        seat: name of the participant's seat; empty in a game with one participant.
        by: who plays the seat: its participant, or a researcher in their place.
    """
    app = application()
    table = _table(app, choice, None, shipped_texts())
    # A participant's key is valid for one game, so the window does not offer another game.
    table.join(ParticipantLink(host, port, token, key=key, seat=seat, by=by), once=key is not None)
    reasons: list[str] = []
    if by is PlayedBy.RESEARCHER and table.game is not None:
        # A researcher leaves when the participant plays again, and does not wait for the seat.
        table.game.refused.connect(reasons.append)
        table.game.refused.connect(lambda _: table.leave())
    table.show()
    code = app.exec()
    if reasons:
        note(f"The server ended the connection: {reasons[0] or 'another researcher plays this seat'}.")
        return FAILED
    return DECLINED if table.declined else code


def play_hosted(choice: look.Choice) -> int:
    """Open the window for its host, which uses standard input and output. Return the exit code after it is closed."""
    app = application()
    pipe = HostPipe(LOBBY)
    table = _table(app, choice, pipe.send)
    pipe.listen(table)
    table.show()
    return app.exec()


def _table(
    app: QApplication, choice: look.Choice, send: Callable[[FromWindow], None] | None, texts: Texts | None = None
) -> ParticipantMainWindow:
    """Return the main window, with the colors and the size of text that the user has chosen."""
    preferences = preferences_of(app, "participant", choice, has_sound=True)
    table = ParticipantMainWindow(preferences, send, texts=texts)
    preferences.add_keys(table)
    preferences.keep_place(table)
    return table

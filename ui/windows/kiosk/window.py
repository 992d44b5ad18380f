"""Window of the kiosk, which shows the page that its host sends, and reports the person's actions."""

import math
import time
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QEvent, Qt, QTimer
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QCloseEvent, QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QApplication, QHBoxLayout, QMainWindow, QProgressBar, QStackedWidget, QVBoxLayout, QWidget

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.view import GiveConsent
from ui.model.kiosk import (
    KIOSK,
    AnswerKept,
    BeginNext,
    CloseKiosk,
    ConsentReply,
    ConsentToAsk,
    FocusNews,
    FormToFill,
    FromKiosk,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameSeenOver,
    GameToJoin,
    HostStops,
    InstructionsNews,
    InstructionsSoFar,
    KioskClosed,
    MessageClosed,
    ResearcherMessage,
    StoppedTakingPart,
    StudyProgress,
    StudyTexts,
    TextToRead,
    ToKiosk,
    TurnToAwait,
    WentBack,
    WentOn,
)
from ui.model.playing.keys import HELP
from ui.windows import look, pointer
from ui.windows.application import application
from ui.windows.host_pipe import HostPipe
from ui.windows.kiosk.pages.form import FormPage
from ui.windows.kiosk.pages.text import READING, ReadingPage
from ui.windows.kiosk.pages.turn import TurnPage
from ui.windows.kiosk.successor import Successor
from ui.windows.link import ParticipantLink
from ui.windows.look import GAP, spaced
from ui.windows.participant.pages.pages import ConnectingPage, ConsentPage, HelpSheet, consent_page
from ui.windows.participant.widgets.buttons import ActionButton, ButtonFace
from ui.windows.participant.widgets.panels import ModalOverlay, TitledPanel, set_text
from ui.windows.participant_program import GamePage
from ui.windows.preferences import Preferences, preferences_of

END_KEYS = "Ctrl+Alt+Shift+Q"
"""Keys with which the researcher closes the window at once."""
BEGIN_KEYS = "Ctrl+Alt+Shift+N"
"""Keys with which the researcher starts the run of the next person."""
STOP_KEYS = "Alt+F4"
"""Keys with which any person can ask to leave, unless the window manager uses these keys."""
HELP_KEY = HELP.keys[0]
FRAME = 15
"""Milliseconds between two polls of the connection to a game."""
WARNINGS = (60, 10)
"""Seconds before the end of a game at which people are warned.

After the first warning, the remaining seconds are shown.
"""


def time_words(texts: Texts, seconds: int) -> str:
    """Return the remaining time in words.

    The time is in whole minutes, and in seconds only near the end, so that people do not watch a running clock.
    """
    if seconds > WARNINGS[0]:
        return texts.text("kiosk.minutes_left", count=math.ceil(seconds / 60))
    return texts.text("kiosk.seconds_left", count=seconds)


class ProgressStrip(QWidget):
    """Strip with a person's progress through the study and a button to leave.

    A window on the full screen has no close button of its own.

    Args:
        texts: texts of the study.

    Attributes:
        again: button that opens the instructions that the person has read.
        stop: button for a person who wants to stop taking part; it opens a question.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._texts = texts
        row = spaced(QHBoxLayout(self), GAP, 2 * GAP, GAP, 2 * GAP, 0)
        self._words, self._bar = look.label(size="small", muted=True), QProgressBar()
        self._words.setWordWrap(False)
        self._bar.setTextVisible(False)
        self._bar.setFixedHeight(GAP)
        self._bar.setMinimumWidth(4 * GAP)  # words and buttons need the width of a small window
        row.addWidget(self._words)
        row.addWidget(self._bar, 1)
        self._time = look.label(size="small", muted=True)
        self._time.setWordWrap(False)
        self._seconds: int | None = None
        row.addWidget(self._time)
        self.again = ActionButton(texts, "small")
        self.again.show_face(ButtonFace(texts.text("kiosk.read_again"), HELP_KEY), texts.text("kiosk.read_again_name"))
        self.again.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.again.hide()
        row.addWidget(self.again)
        self.settings = ActionButton(texts, "small")
        # The strip is narrow, so the button shows only "Aa", the usual sign for the size of text, and no key.
        self.settings.show_face(ButtonFace("Aa", hint=texts.text("settings.hint")), texts.text("settings.title"))
        self.settings.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        row.addWidget(self.settings)
        self.stop = ActionButton(texts, "small")
        stop = texts.text("kiosk.stop")
        self.stop.show_face(ButtonFace(stop, STOP_KEYS), stop)
        # The Tab key moves only within pages, so these buttons do not accept the focus.
        self.stop.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        row.addWidget(self.stop)

    def show_time(self, seconds: int | None) -> str:
        """Show the remaining seconds of a game; None if there is no game.

        Return a warning if one is due, otherwise an empty text.
        """
        self._time.setVisible(seconds is not None)
        before, self._seconds = self._seconds, seconds
        if seconds is None:
            return ""
        near = seconds <= WARNINGS[0]
        left = time_words(self._texts, seconds)
        set_text(self._time, left)
        self._time.setFont(look.font("small", bold=near))
        if self._time.property("muted") == near:
            self._time.setProperty("muted", not near)
            self._time.style().polish(self._time)
        passed = before is not None and any(seconds <= limit < before for limit in WARNINGS)
        return left if passed else ""

    def show_progress(self, way: StudyProgress) -> None:
        """Show the progress; hide the strip if there are no steps."""
        self.show_time(None)
        self.setVisible(way.steps > 0)
        words = self._texts.text("kiosk.step", step=way.step, steps=way.steps)
        set_text(self._words, words)
        self._bar.setAccessibleName(words)
        self._bar.setRange(0, max(way.steps, 1))
        self._bar.setValue(max(way.step - 1, 0))


class LeavingPanel(TitledPanel):
    """Question to a person who closes the window.

    Args:
        texts: texts of the study.

    Attributes:
        stay: button that returns to the study.
        stop: button that ends the person's participation.
        close_button: button that closes the window.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts, texts.text("kiosk.leave"))
        self.text = look.label()
        self.rows.addWidget(self.text, 1)
        self.stay = ActionButton(texts, "main", hints=True)
        self.stop, self.close_button = ActionButton(texts, hints=True), ActionButton(texts, hints=True)
        stop = ButtonFace(texts.text("kiosk.stop"), hint=texts.text("kiosk.stop_hint"))
        self.stop.show_face(stop, texts.text("kiosk.stop_name"))
        close = ButtonFace(texts.text("kiosk.close_window"), hint=texts.text("kiosk.close_window_hint"))
        self.close_button.show_face(close, texts.text("kiosk.close_window_name"))
        for button in (self.stay, self.stop, self.close_button):
            self.rows.addWidget(button)

    def ask(self, *, takes_part: bool, can_stop: bool) -> None:
        """Show the question.

        Args:
            takes_part: True if a person is in the middle of the study.
            can_stop: True if there is a host to which the window can report that the person stops.
        """
        self.entitle(self._texts.text("kiosk.leave" if takes_part else "kiosk.close"))
        set_text(self.text, self._texts.text("kiosk.leave_text" if takes_part else "kiosk.close_text"))
        stay = self._texts.text("kiosk.go_on" if takes_part else "kiosk.leave_open")
        self.stay.show_face(ButtonFace(stay, "Esc"), stay)
        self.stop.setVisible(takes_part and can_stop)


class MessagePanel(TitledPanel):
    """Message of the researcher.

    Args:
        texts: texts of the study.

    Attributes:
        text: label with the message.
        close_button: button that closes the message.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts, texts.text("web.message"))
        self.entitle(texts.text("web.message"))
        self.text = look.label()
        self.rows.addWidget(self.text, 1)
        self.close_button = ActionButton(texts, "main")
        label = texts.text("web.message_close")
        self.close_button.show_face(ButtonFace(label, "Esc"), label)
        self.rows.addWidget(self.close_button)

    def show_message(self, text: str) -> None:
        """Show the text of a message."""
        set_text(self.text, text)
        self.close_button.setAccessibleDescription(text)


class KioskWindow(QMainWindow):
    """Kiosk window on one computer of the laboratory.

    Args:
        texts: texts of the study.
        preferences: preferences of the participant, which are reset when the next participant starts.
        send: function that sends a message to the host.
        clock: monotonic clock, seconds.

    Attributes:
        game: page of the current game; None while another page is shown.
    """

    def __init__(
        self,
        texts: Texts,
        preferences: Preferences,
        send: Callable[[FromKiosk], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__()
        self._texts = preferences.texts = texts
        self._preferences = preferences
        self._send = send
        self._clock = clock
        self._page = 0
        self._leaving = self._host_gone = self._has_run = False
        self._focused: bool | None = None
        self._instructions: tuple[tuple[str, bool], ...] = ()
        self.game: GamePage | None = None
        self.setWindowTitle(texts.text("kiosk.window"))
        self.setMinimumSize(800, 480)
        self._inside = inside = QWidget()
        rows = spaced(QVBoxLayout(inside), 0, 0)
        self.progress, self.pages = ProgressStrip(texts), QStackedWidget()
        self.progress.hide()
        rows.addWidget(self.progress)
        rows.addWidget(self.pages, 1)
        self.setCentralWidget(inside)
        self.overlay, self.leaving_panel = ModalOverlay(inside), LeavingPanel(texts)
        self.instructions, self.message_panel = HelpSheet(texts), MessagePanel(texts)
        self._build_leaving()
        # Before these panels are shown, they have no parent, so Qt would not delete them together with the window.
        self.destroyed.connect(self.leaving_panel.deleteLater)
        self.destroyed.connect(self.instructions.deleteLater)
        self.destroyed.connect(self.message_panel.deleteLater)
        self.message_panel.close_button.clicked.connect(self._close_message)
        QShortcut(QKeySequence("Esc"), self.message_panel).activated.connect(self._close_message)
        self.instructions.requested.connect(self._stay)
        QShortcut(QKeySequence("Esc"), self.instructions).activated.connect(self._stay)
        self.progress.again.clicked.connect(self._read_again)
        self._reading_again = QShortcut(QKeySequence(HELP_KEY), self)
        self._reading_again.activated.connect(self._read_again)
        self.progress.stop.clicked.connect(self._ask_to_leave)
        self.progress.settings.clicked.connect(lambda: self._preferences.open(self))
        for keys, deed in ((END_KEYS, self._end), (BEGIN_KEYS, self._begin_next), (STOP_KEYS, self._ask_to_leave)):
            QShortcut(QKeySequence(keys), self).activated.connect(deed)
        self._pumping = QTimer(self)
        self._pumping.setTimerType(Qt.TimerType.PreciseTimer)
        self._pumping.timeout.connect(self._pump)
        self._pumping.start(FRAME)

    def _build_leaving(self) -> None:
        panel = self.leaving_panel
        panel.stay.clicked.connect(self._stay)
        panel.stop.clicked.connect(self._stop_taking_part)
        panel.close_button.clicked.connect(self._end)
        self._staying = QShortcut(QKeySequence("Esc"), panel)
        self._staying.activated.connect(self._stay)

    # The host's messages

    def receive(self, message: ToKiosk) -> None:
        """Act on a message from the host."""
        match message:
            case TextToRead(page=page, anew=anew):
                if anew:
                    self._preferences.forget()
                    if self.message_panel.isVisible():
                        self._stay()
                self._show_text(page, message)
            case ConsentToAsk(page=page):
                self._show(page, self._consent(message), message.progress)
            case FormToFill(page=page):
                form = FormPage(message, self._texts, self._clock)
                form.news.connect(self._send)
                form.went_on.connect(partial(self._leave_page, WentOn(page)))
                form.went_back.connect(partial(self._leave_page, WentBack(page)))
                self._show(page, form, message.progress)
                form.start()
            case TurnToAwait(page=page):
                self._show_turn(page, message)
            case GamePrepared(page=page, sentence=sentence):
                waiting = ConnectingPage(self._texts)
                waiting.show_waiting(sentence)
                self._show(page, waiting, message.progress)
            case GameToJoin():
                self._join(message)
            case GameNews(page=page) if self.game is not None and page == self._page:
                self._show_news(self.game, message)
            case GameRecorded(page=page) if self.game is not None and self.game.is_over and page == self._page:
                self.game.disconnect_from_game()
            case GameRecorded(page=page, heading=heading, text=text):
                self._show_text(page, TextToRead(page, heading, text, progress=message.progress))
            case CloseKiosk():
                self._leaving = True
                self.close()
            case HostStops(heading=heading, text=text):
                self._host_gone = True
                self._show_text(0, TextToRead(0, heading, text, button=""))
            case InstructionsSoFar(texts=texts):
                self._instructions = tuple((text.text, text.markdown) for text in texts)
                self._offer_instructions()
                if not texts and self.instructions.isVisible():
                    self._stay()
            case ResearcherMessage(text=text):
                self.message_panel.show_message(text)
                self._cover(self.message_panel)
                self.message_panel.close_button.setFocus(Qt.FocusReason.OtherFocusReason)
            case AnswerKept() | GameNews() | StudyTexts():
                pass

    def leave(self) -> None:
        """Show the person that the program of the study has stopped.

        The window stays open until another window opens or the researcher closes it.
        """
        if self._leaving or self._host_gone:
            return
        self._host_gone = True
        text = "kiosk.program_stopped_text" if self._has_run else "kiosk.program_stopped_between"
        stopped = self._texts.text("kiosk.program_stopped")
        self._show_text(0, TextToRead(0, stopped, self._texts.text(text), button=""))

    def give_way(self) -> None:
        """Close this window if its host has ended, because another window has opened."""
        if self._host_gone:
            self._end()

    # Pages

    def _show_text(self, page: int, text: TextToRead) -> None:
        shown = ReadingPage(text, self._texts, self._clock)
        shown.went_on.connect(partial(self._go_on, page))
        self._show(page, shown, text.progress)
        shown.start()

    def _show_turn(self, page: int, turn: TurnToAwait) -> None:
        shown = self.pages.currentWidget()
        if isinstance(shown, TurnPage) and page == self._page:
            shown.show_turn(turn)
            return
        waiting = TurnPage(turn, self._texts, self._clock)
        waiting.stopped.connect(partial(self._go_on, page))
        self._show(page, waiting, turn.progress)

    def _consent(self, asked: ConsentToAsk) -> ConsentPage:
        page, came = asked.page, self._clock()

        def answer(agrees: bool) -> None:
            if self._page == page and self._clock() - came >= READING:
                self._page = -1
                self._send(ConsentReply(page, agrees, time.monotonic_ns()))

        hint = self._texts.text("kiosk.stop_hint")
        return consent_page(self._texts, asked.text, answer, hint, markdown=asked.markdown)

    def _join(self, game: GameToJoin) -> None:
        consent = GiveConsent(game.agreed_at) if game.agreed_at else None
        self.show_game(game, ParticipantLink(game.host, game.port, game.token, consent, seat=game.seat))

    def show_game(self, game: GameToJoin, link: ParticipantLink) -> None:
        """Show the page of a game, which is connected to the game's server."""
        on = partial(self._go_on, game.page)
        back = on if game.practice else None
        shown = GamePage(
            link,
            self._texts,
            self._preferences,
            game.practice,
            back,
            self._clock,
            self._texts.text("kiosk.go_on"),
            True,
        )
        shown.went_on.connect(on)
        shown.declined.connect(shown.decline)
        shown.window_of_game.help.instructions = self._instructions
        shown.help_shown.connect(self._report_reading)
        shown.seen_over.connect(lambda: self._send(GameSeenOver(game.page)))
        shown.require(game.to_do)
        self._show(game.page, shown, game.progress)
        self.game = shown
        self._offer_instructions()

    def _show_news(self, game: GamePage, news: GameNews) -> None:
        """Show the remaining tasks and the remaining time; announce the time to screen readers if a warning is due."""
        game.require(news.to_do)
        warning = self.progress.show_time(news.seconds_left)
        if warning:
            QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, warning))

    def _go_on(self, page: int) -> None:
        """Report only once that the person continues."""
        self._leave_page(WentOn(page))

    def _leave_page(self, message: WentOn | WentBack) -> None:
        """Report only once that the person leaves a page."""
        if message.page == self._page:
            self._page = -1
            self._send(message)

    def _show(self, number: int, page: QWidget, way: StudyProgress) -> None:
        self._leave_game()
        self._page = number
        self._has_run = way.steps > 0 or isinstance(page, GamePage)
        pointer.note_rest(self)
        self.progress.show_progress(way)
        self._offer_instructions()
        before = self.pages.currentWidget()
        self.pages.addWidget(page)
        self.pages.setCurrentWidget(page)
        if before is not None:
            self.pages.removeWidget(before)
            before.deleteLater()
        if not self.overlay.isVisible():
            page.setFocus()

    def _offer_instructions(self) -> None:
        """Show the button for the settings and, if the person has read instructions, the button for the instructions.

        During a game these buttons are hidden, because the game has its own buttons.
        """
        offered = bool(self._instructions) and self._has_run and self.game is None
        self.progress.again.setVisible(offered)
        self.progress.settings.setVisible(self.game is None)
        self._reading_again.setEnabled(offered)

    def _read_again(self) -> None:
        """Open or close the instructions."""
        if self.instructions.isVisible():
            self._stay()
        elif not self.overlay.isVisible():
            self.instructions.instructions = self._instructions
            self.instructions.show_help((), (), HELP_KEY)
            self._cover(self.instructions, 760)
            self._report_reading(is_open=True)
            self.instructions.close_button.setFocus(Qt.FocusReason.OtherFocusReason)

    def _report_reading(self, is_open: bool) -> None:
        self._send(InstructionsNews(is_open, time.monotonic_ns()))

    def _close_message(self) -> None:
        self._stay()
        self._send(MessageClosed())

    def _cover(self, panel: TitledPanel | None, widest: int = 520) -> None:
        """Show a panel above the page and disable the page's keys. If `panel` is None, show only the page."""
        if self.instructions.isVisible():
            self._report_reading(is_open=False)
        self.pages.setEnabled(panel is None)
        self.overlay.show_panel(panel, widest)

    def _leave_game(self) -> None:
        if self.game is not None:
            if self.game.window_of_game.help.isVisible():
                self._report_reading(is_open=False)
            self.game.leave()
            self.game = None
            self._preferences.texts = self._texts

    def _pump(self) -> None:
        if self.game is not None:
            self.game.pump()

    # Leaving

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for confirmation. Only the researcher can close the window at once."""
        if not self._leaving:
            event.ignore()
            self._ask_to_leave()
            return
        self._pumping.stop()
        self._leave_game()
        self._send(KioskClosed())
        event.accept()
        QApplication.quit()

    def _ask_to_leave(self) -> None:
        panel = self.leaving_panel
        panel.ask(takes_part=self._has_run, can_stop=not self._host_gone)
        self._cover(panel)
        panel.stay.setFocus(Qt.FocusReason.OtherFocusReason)

    def _stay(self) -> None:
        self._cover(None)
        page = self.pages.currentWidget()
        if isinstance(page, ReadingPage | FormPage):
            page.start()
        elif page is not None:
            page.setFocus()

    def _stop_taking_part(self) -> None:
        self._cover(None)
        self._send(StoppedTakingPart())

    def _end(self) -> None:
        """Close the window without a question."""
        self._leaving = True
        self.close()

    def _begin_next(self) -> None:
        self._send(BeginNext())

    # The window itself

    def changeEvent(self, event: QEvent) -> None:
        """Report when the keyboard focus leaves this window, and when it returns."""
        super().changeEvent(event)
        if event.type() != QEvent.Type.ActivationChange or self._leaving:
            return
        has_focus = self.isActiveWindow()
        if self._focused is not None and has_focus != self._focused:
            self._send(FocusNews(has_focus, time.monotonic_ns()))
        if has_focus or self._focused is not None:
            self._focused = has_focus

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Let Tab move only within the overlay while it is shown."""
        return self.overlay.keeps_tab(forward=forward) or super().focusNextPrevChild(forward)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Give the overlay the size of the window."""
        super().resizeEvent(event)
        self.overlay.setGeometry(self._inside.rect())


class KioskProgram:
    """Program of the kiosk's window. It opens the window after the host has sent the texts.

    Args:
        app: the application.
        choice: light, dark, or the system's colors.
        send: function that sends a message to the host.
        windowed: True for a window of normal size, False for the full screen.
        title: title of the window. If empty, the window has the usual title.

    Attributes:
        window: the window; None before it opens.
    """

    def __init__(
        self, app: QApplication, choice: look.Choice, send: Callable[[FromKiosk], None], *, windowed: bool, title: str
    ) -> None:
        self._app = app
        self._preferences = preferences_of(app, "kiosk", choice, has_sound=True)
        self._send = send
        self._windowed = windowed
        self._title = title
        self.window: KioskWindow | None = None

    def receive(self, message: ToKiosk) -> None:
        """Act on a message from the host."""
        if self.window is not None:
            self.window.receive(message)
        elif isinstance(message, StudyTexts) and (texts := message.texts.texts()) is not None:
            self.window = self._open(texts)

    def leave(self) -> None:
        """Handle the end of the host."""
        if self.window is None:
            self._app.quit()
        else:
            self.window.leave()

    def _open(self, texts: Texts) -> KioskWindow:
        window = KioskWindow(texts, self._preferences, self._send)
        self._preferences.add_keys(window)
        Successor(window.give_way).setParent(window)
        if self._title:
            window.setWindowTitle(self._title)
        if self._windowed:
            look.open_within_screen(window)
            window.show()
        else:
            # Set the size as well, because full screen has no effect without a window manager.
            window.setGeometry(window.screen().geometry())
            window.showFullScreen()
        return window


def open_kiosk(choice: look.Choice, *, windowed: bool, title: str = "") -> int:
    """Open the window for its host, which uses standard input and output. Return the exit code after it is closed."""
    app = application()
    pipe = HostPipe(KIOSK)
    pipe.listen(KioskProgram(app, choice, pipe.send, windowed=windowed, title=title))
    return app.exec()

"""Participant's window. It shows a `Screen` and returns `Act`s, but makes no decisions."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QRect, Qt, QTimer, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QHideEvent,
    QKeyEvent,
    QKeySequence,
    QResizeEvent,
    QShortcut,
    QShowEvent,
)
from PySide6.QtWidgets import (
    QApplication,
    QHBoxLayout,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.notices import FloorPlan
from ui.model.playing.answer_guard import AnswerGuard
from ui.model.playing.keys import HELP
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    Act,
    ChooseRobot,
    ConsiderRoom,
    DeclineConsentAct,
    DialoguePopup,
    FitMap,
    FollowRobot,
    GoOnFromGame,
    GoToPeople,
    Phase,
    RaiseObjectionAct,
    Screen,
    SelectRoomAct,
    ShowSettings,
    TreasurePopup,
    TypeLetter,
)
from ui.model.playing.spoken import remark_of
from ui.model.shared.theme import Palette
from ui.windows import pointer
from ui.windows.look import GAP, follow_text, px, spaced
from ui.windows.map import MapView
from ui.windows.participant.column import SideColumn
from ui.windows.participant.keyboard import KeyboardShortcuts
from ui.windows.participant.map_area import MapArea
from ui.windows.participant.pages.pages import (
    ConnectingPage,
    ConsentPage,
    EndingPanel,
    HelpSheet,
    QuestionPanel,
    window_keys,
)
from ui.windows.participant.people import PeopleView
from ui.windows.participant.popups.dialogue import DialoguePanel
from ui.windows.participant.popups.finding import PicturePanel
from ui.windows.participant.popups.treasure import TreasurePanel
from ui.windows.participant.top import TopStrip
from ui.windows.participant.waiting import WaitingStrip
from ui.windows.participant.widgets import focus
from ui.windows.participant.widgets.buttons import ParticipantButton
from ui.windows.participant.widgets.panels import ModalOverlay, TitledPanel, set_text

FRAME = 16
"""Milliseconds between two updates of the window with data of its model."""

ROBOT_SIZE = 40
"""Width and height of the square around a robot that a pop-up should leave visible on the map, logical pixels."""


class ParticipantWindow(QWidget):
    """Window with the map, the robots and rooms next to the map, and pop-ups in a corner of the map.

    The window can also be a page of another window. While visible, it shows the current state of the model. It uses the
    language that the model had when the window was created.

    Args:
        model: source of all data that the window shows.
        clock: monotonic clock, seconds.
        palette: the colors.
        can_cancel: True to show the button *Cancel* until the game is reached.

    Attributes:
        declined: signal: the participant declines to take part in the study.
        sounded: signal with a `GameSound` to play.
        went_on: signal: the participant continues after the game.
        help_shown: signal: the sheet of rules and keys was opened or closed.
        settings_wanted: signal: the participant wants to open the settings.
    """

    declined = Signal()
    went_on = Signal()
    sounded = Signal(object)
    help_shown = Signal(bool)
    settings_wanted = Signal()

    def __init__(
        self, model: Participant, clock: Callable[[], float], palette: Palette, *, can_cancel: bool = False
    ) -> None:
        super().__init__()
        self._can_cancel = can_cancel
        self._model = model
        self._texts = model.texts
        self._clock = clock
        self._screen: Screen | None = None
        self._floor_plan: FloorPlan | None = None
        self._showing = False
        self._considered: int | None = None
        self._announced: int | None = None
        self._guard = AnswerGuard()
        self._acting = False
        # When the currently held key was pressed, a pop-up was visible; this is the time at which it appeared.
        self._pressed_since = self._guard.opened_at
        self.setWindowTitle(self._texts.text("window.title"))
        self.setMinimumSize(760, 420)
        self.resize(1200, 800)
        self.map = MapView(palette, texts=self._texts)
        self._build(self._texts)
        self._keyboard = KeyboardShortcuts(self, self.do)
        for keys, step in ((("F6", "Ctrl+Tab"), 1), (("Shift+F6", "Ctrl+Shift+Tab"), -1)):
            for key in keys:
                QShortcut(QKeySequence(key), self, self._stepper(step))
        self._ticking = QTimer(self)
        self._ticking.setTimerType(Qt.TimerType.PreciseTimer)
        self._ticking.timeout.connect(self.refresh)
        # No widget shows the focus until a person uses the keyboard to move through the window.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setFocus()
        self.refresh()
        follow_text(self, ParticipantWindow._divide)

    # Layout -----------------------------------------------------------------------------------------------------------

    def _build(self, texts: Texts) -> None:
        self.connecting, self.consent = ConnectingPage(texts, can_cancel=self._can_cancel), ConsentPage(texts)
        self.top, self.column = TopStrip(texts), SideColumn(texts)
        self.map_area, self.waiting = MapArea(texts, self.map), WaitingStrip(texts)
        self.history = self.map_area.history
        self.dialogue, self.treasure, self.ending = DialoguePanel(texts), TreasurePanel(texts), EndingPanel(texts)
        self.question, self.help, self.large = QuestionPanel(texts), HelpSheet(texts), PicturePanel(texts)
        focus.make_region(self.top, texts.text("window.score_and_tools"))
        focus.make_region(self.waiting, texts.text("window.what_waits"))
        self.waiting.history.toggled.connect(self.map_area.show_history)
        left = spaced(QVBoxLayout(), GAP)
        left.addWidget(self.map_area, 1)
        left.addWidget(self.waiting)
        playing = QWidget()
        rows = spaced(QVBoxLayout(playing), 0, 0)
        rows.addWidget(self.top)
        middle = spaced(QHBoxLayout(), 2 * GAP, 2 * GAP, 0, 2 * GAP, 2 * GAP)
        middle.addLayout(left, 1)
        middle.addWidget(self.column)
        self.people = PeopleView(texts)
        self.people.hide()
        self.people.field.left.connect(self.setFocus)
        self.waiting.people.toggled.connect(lambda _shown: self._divide())
        middle.addWidget(self.people)
        rows.addLayout(middle, 1)
        self.pages = QStackedWidget()
        self._page_of: dict[Phase, QWidget] = {Phase.CONNECTING: self.connecting, Phase.CONSENT: self.consent}
        self._playing = playing
        for page in (self.connecting, self.consent, playing):
            self.pages.addWidget(page)
        around = QVBoxLayout(self)
        around.setContentsMargins(0, 0, 0, 0)
        around.addWidget(self.pages)
        # The overlay is not a child of the stack of pages, because screen readers find only the current page there.
        self.overlay = ModalOverlay(self)
        self._connect()

    def _connect(self) -> None:
        for part in (self.consent, self.top, self.column, self.waiting, self.people, self.map_area.votes):
            part.requested.connect(self.do)
        self._panels: tuple[TitledPanel, ...] = (
            self.dialogue,
            self.treasure,
            self.ending,
            self.question,
            self.help,
            self.large,
        )
        for panel in self._panels:
            panel.requested.connect(self.do)
        self.map.room_clicked.connect(lambda room: self.do(SelectRoomAct(room), on_map=True))
        self.map.robot_clicked.connect(lambda robot: self.do(ChooseRobot(robot), on_map=True))
        self.map.follow_ended.connect(self._end_follow)
        self.map.room_hovered.connect(lambda _room: self._consider())
        self.column.tiles.looked_at.connect(self._consider)

    @property
    def regions(self) -> list[QWidget]:
        """Regions that F6 visits, in reading order. If an overlay or a page is shown, it is the only region."""
        if self.overlay.isVisible():
            return [panel for panel in (self.question, self.help, self.large) if panel.isVisible()]
        if self._screen is not None and self._screen.phase in self._page_of:
            return [self._page_of[self._screen.phase]]
        pops: list[QWidget] = [panel for panel in (self.dialogue, self.treasure, self.ending) if panel.isVisible()]
        column = (self.column.cards, self.column.rooms, self.people)
        return [*pops, self.top, self.map_area.votes, *column, self.waiting, self.history]

    # Each frame -------------------------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Read the current state of the model, and update the parts that changed."""
        now = self._clock()
        screen = self._model.screen(now)
        if screen is not self._screen:
            before, self._screen = self._screen, screen
            if screen != before:
                pointer.note_rest(self)
                self._showing = True
                self._show(screen, before, now)
                self._showing = False
                self._consider()
        if self.window().isMinimized():
            return
        self._show_map(now)

    def do(self, act: Act, *, on_map: bool = False) -> None:
        """Let the model do this act, unless the act was meant for the previous content; see `AnswerGuard`."""
        if isinstance(act, DeclineConsentAct):
            self.declined.emit()
            return
        now = self._clock()
        if not self._guard.admits(act, now, on_map=on_map):
            return
        if isinstance(act, ShowSettings):
            self.settings_wanted.emit()
            return
        if isinstance(act, GoOnFromGame):
            self.went_on.emit()
            return
        if isinstance(act, GoToPeople):
            self.waiting.people.setChecked(True)
            self.people.go_to()
            return
        if isinstance(act, RaiseObjectionAct):
            act = RaiseObjectionAct(self.dialogue.own_words.text())
        self._model.do(act, now)
        if isinstance(act, FitMap):
            self.map.fit()
        if isinstance(act, TypeLetter) and isinstance(QApplication.focusWidget(), ParticipantButton):
            # With the focus in the list, Enter submits the name, and does not press the button.
            self.treasure.names.setFocus()
        self._acting = True
        self.refresh()
        self._acting = False

    def _end_follow(self) -> None:
        if self._model.followed is not None:
            self.do(FollowRobot())

    def _consider(self) -> None:
        """Report to the model if the person now considers another room, on the map or among the tiles."""
        room = self.map.hovered or self.column.tiles.considered
        if room != self._considered and not self._showing:
            self._considered = room
            self.do(ConsiderRoom(room))

    def set_palette(self, palette: Palette) -> None:
        """Use these colors for the map and the history. All other parts use the application's palette."""
        self.map.set_palette(palette)
        self.history.repaint_words()

    def _show_map(self, now: float) -> None:
        floor_plan = self._model.floor_plan
        if floor_plan is None or self.pages.currentWidget() is not self._playing:
            return
        if floor_plan is not self._floor_plan:
            before, self._floor_plan = self._floor_plan, floor_plan
            if floor_plan != before:
                self.map.show_floor_plan(floor_plan)
                self.map_area.place_anew()
                return  # Update rooms and robots in the next frame, so that the window is not blocked.
        self.map.show_rooms(self._model.rooms(now))
        first = self.map.robot_place(0) is None
        self.map.show_robots(self._model.robots(now))
        if first:
            self.map_area.place_anew()
        if self._model.followed != self.map.followed:
            self.map.follow(self._model.followed)
            self.map_area.place_anew()
        self.map_area.keep_in_sight()

    def _show(self, screen: Screen, before: Screen | None, now: float) -> None:
        focused = self._focused_region()
        self.pages.setCurrentWidget(self._page_of.get(screen.phase, self._playing))
        self.connecting.show_waiting(screen.waiting_for)
        if screen.phase is Phase.CONSENT:
            self.consent.show_consent(screen.consent, screen.agree, screen.decline)
        moving = before is not None and before.game == screen.game
        self.top.show_strip(
            screen.game, screen.score, screen.progress, moving=moving, tools=(*screen.tools, screen.end)
        )
        self.column.cards.show_cards(screen.cards)
        self.column.tiles.show_tiles(screen.tiles)
        self.column.dont_know.show_action(screen.ask_advice)
        set_text(self.column.hint, remark_of(self._texts, screen))
        self.waiting.show_waiting(screen.waiting, screen.nothing_waits)
        self.history.show_history(screen.history)
        self.map_area.show_no_map(screen.no_map)
        self.map_area.show_votes(screen.votes)
        self.people.show_people(screen.people)
        self.waiting.show_people(screen.people)
        if before is None or (before.people is None) != (screen.people is None):
            self._divide()
        self._show_pops(screen, before, now)
        self._keyboard.show_screen(screen)
        self._announce(screen)
        if before is not None and screen.sound_number != before.sound_number:
            self.sounded.emit(screen.sound)
        self._keep_focus(focused)

    def _show_pops(self, screen: Screen, before: Screen | None, now: float) -> None:
        moved = self.map_area.banner.show_banner(screen.banner)
        panel: TitledPanel | None = None
        match screen.popup:
            case DialoguePopup() as pop:
                self.dialogue.show_pop(pop)
                panel = self.dialogue
            case TreasurePopup() as pop:
                self.treasure.show_pop(pop)
                panel = self.treasure
            case None:
                if screen.ending is not None:
                    self.ending.show_ending(screen.ending)
                    panel = self.ending
        if moved or before is None or (screen.popup, screen.ending) != (before.popup, before.ending):
            about = screen.popup
            robot, room = (None, None) if about is None else (about.robot, about.room)
            self.map_area.show_panel(panel, robot, room, self._subject_on_map)
        if screen.confirmation is not None:
            self.question.show_question(screen.confirmation)
            self.overlay.show_panel(self.question)
        elif screen.help:
            self.help.show_help(screen.rules, (*screen.help, *window_keys(self._texts)), HELP.keys[0])
            self.overlay.show_panel(self.help, 720)
        elif screen.enlarged is not None and screen.popup is not None:
            self.large.show_large(screen.enlarged, screen.popup.title, screen.popup.robot)
            self.overlay.show_panel(self.large, 2000)
        else:
            self.overlay.show_panel(None)
        if bool(screen.help) != (before is not None and bool(before.help)):
            self.help_shown.emit(bool(screen.help))
        if self._guard.show(screen, before, now, acting=self._acting):
            self.map.hover(None)
            for shown in (*self._panels, self.column.tiles):
                for button in shown.findChildren(ParticipantButton):
                    button.let_go()

    def _subject_on_map(self) -> list[QRect]:
        """Return the places of the pop-up's subject on the map, pixels: the robot, and the middle of the room."""
        pop = None if self._screen is None else self._screen.popup
        if pop is None:
            return []
        places = []
        robot = self.map.robot_place(pop.robot)
        if robot is not None:
            around = QRect(0, 0, ROBOT_SIZE, ROBOT_SIZE)
            around.moveCenter(robot.toPoint())
            places.append(around)
        room = None if pop.room is None else self.map.room_place(pop.room)
        if room is not None:
            wide, high = room.width() / 4.0, room.height() / 4.0
            places.append(room.adjusted(wide, high, -wide, -high).toRect())
        return places

    # Keys and focus ---------------------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Ignore arrow keys that a person already held when a pop-up appeared.

        They were meant for other parts, so the pop-up's list must not receive them.
        """
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            if not event.isAutoRepeat():
                self._pressed_since = self._guard.opened_at
            elif event.key() in focus.ARROWS and self._pressed_since != self._guard.opened_at:
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Handle a key without a shortcut.

        In a dialogue, arrow keys move the focus to the answers, and Page Up or Page Down scrolls. Letters
        can be part of a name.
        """
        if self.dialogue.isVisible():
            self.dialogue.go_to(event.key())
        self._keyboard.type(event)

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Let Tab move only within the overlay while it is shown."""
        return self.overlay.keeps_tab(forward=forward) or super().focusNextPrevChild(forward)

    def _stepper(self, step: int) -> Callable[[], None]:
        return lambda: focus.next_region(self.regions, step)

    def _focused_region(self) -> QWidget | None:
        """Return the region that has the focus."""
        focused = QApplication.focusWidget()
        if focused is None:
            return None
        return next((home for home in self.regions if home is focused or home.isAncestorOf(focused)), None)

    def _keep_focus(self, before: QWidget | None) -> None:
        """If the region with the focus has disappeared, move the focus to the region that replaced it."""
        regions = self.regions
        if before is not None and before not in regions and regions:
            if regions[0] is self.top:
                self.column.cards.focus_selected()  # If the tools had the focus, the next Enter would press a tool.
            elif regions[0] is self.dialogue:
                # Do not focus the first button, which closes the pop-up for now: Enter is meant for the first answer.
                self.dialogue.setFocus(Qt.FocusReason.OtherFocusReason)
            elif regions[0] is self.treasure and self.treasure.names.isVisible():
                self.treasure.names.setFocus(Qt.FocusReason.OtherFocusReason)  # In this list, Enter submits the name.
            else:
                focus.focus_region(regions[0])

    def _announce(self, screen: Screen) -> None:
        if screen.announcement_number != self._announced:
            self._announced = screen.announcement_number
            if screen.announcement:
                QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, screen.announcement))

    # Size -------------------------------------------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:
        """Start the updates when the window becomes visible."""
        super().showEvent(event)
        self._ticking.start(FRAME)

    def hideEvent(self, event: QHideEvent) -> None:
        """Stop the updates while the window is not visible."""
        super().hideEvent(event)
        self._ticking.stop()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Divide the new width, and give the overlay the size of the window."""
        super().resizeEvent(event)
        self._divide()
        self.overlay.setGeometry(self.rect())

    def _divide(self) -> None:
        """Give the column next to the map three tenths of the width.

        If the words need more width, the column gets more, but less than half of the width.
        """
        wide = min(max(px(336), int(self.width() * 0.3)), px(480))
        self.column.setFixedWidth(min(wide, int(self.width() * 0.45)))
        self._place_people()

    def _place_people(self) -> None:
        """Show the people in a third column. In a narrow window, a button shows them in place of robots and rooms."""
        has_people = self._screen is not None and self._screen.people is not None
        wide = self.width() >= px(1080)
        self.waiting.people.setVisible(has_people and not wide)
        shown = has_people and (wide or self.waiting.people.isChecked())
        self.people.setFixedWidth(px(300) if wide else self.column.width())
        self.people.setVisible(shown)
        self.column.setVisible(wide or not shown)

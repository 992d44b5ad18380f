"""Editor of a study. Each change is a step, and a separate thread applies the steps to the text."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QFileSystemWatcher, QObject, QTimer, Signal, Slot

from thbridge.files.disk.edited_file import TextOnDisk, read_edited, write_edited
from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused
from ui.model.study_form.draft import StudyDraft, UndoHistory
from ui.model.study_form.files import draft_of_file, header_of
from ui.windows.editing.background import BackgroundWorker

_TYPING = 120
"""The text is checked after this number of milliseconds without typing."""
_SETTLING = 150
"""Time in milliseconds. A file of another program counts as complete if it has not changed for this time."""

TextChange = Callable[[StudyDraft], str | RequestRefused]
_Taken = Callable[[StudyDraft, UndoHistory], UndoHistory | RequestRefused]


@dataclass(frozen=True, slots=True)
class _Step:
    key: str
    take: _Taken


@dataclass(frozen=True, slots=True)
class _Outcome:
    draft: StudyDraft
    history: UndoHistory
    refused: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class _Conflict:
    now: TextOnDisk


class StudyEditor(QObject):
    """Editor with the file as it was read, the draft, and the history of the draft for undo.

    Attributes:
        path: the file.
        drafted: signal: the draft has changed.
        refused: signal: a change of a field was not possible; with the field's key and the reason.
        found_faulty: signal: the draft was not saved because of its faults.
        conflicted: signal: the draft was not saved, because the file has changed since it was read.
        changed_outside: signal: the file has changed since it was read.
        failed: signal: writing or reading the file has failed; with the reason.
        saved: signal: the draft was saved.
    """

    drafted = Signal()
    refused = Signal(str, str)
    found_faulty = Signal()
    conflicted = Signal()
    changed_outside = Signal()
    failed = Signal(str)
    saved = Signal()

    def __init__(self, path: Path) -> None:
        """Open a file. If the file does not exist, start a new file.

        Raises:
            BadFile: the file cannot be read.
        """
        super().__init__()
        self.path = path
        self.on_disk = read_edited(path)
        text = self.on_disk.text if self.on_disk.exists else header_of(path)
        self.history = UndoHistory(text)
        self.draft = draft_of_file(path, text)
        self._steps: list[_Step] = []
        self._work = BackgroundWorker(self, "study")
        self._work.done.connect(self._done)
        self._typing = QTimer(self, singleShot=True, interval=_TYPING)
        self._typing.timeout.connect(self._flush)
        self._settling = QTimer(self, singleShot=True, interval=_SETTLING)
        self._settling.timeout.connect(self._look_at_disk)
        self._watcher = QFileSystemWatcher(self)
        self._watcher.fileChanged.connect(self._settling.start)
        self._watcher.directoryChanged.connect(self._settling.start)
        self._watch()
        self._save_wanted: tuple[bool, bool] | None = None
        self._saving = False

    @property
    def dirty(self) -> bool:
        """True if there are changes to save."""
        return bool(self._steps) or self._work.busy or not self.on_disk.exists or self.history.text != self.on_disk.text

    @property
    def settled(self) -> bool:
        """True if all changes have been applied to the draft."""
        return not self._steps and not self._work.busy

    def change(self, key: str, change: TextChange, *, at_once: bool = False) -> None:
        """Change the text. If the last waiting change has the same key, this change replaces it."""

        def take(draft: StudyDraft, history: UndoHistory) -> UndoHistory | RequestRefused:
            text = change(draft)
            return text if isinstance(text, RequestRefused) else history.changed(text, key)

        if self._steps and self._steps[-1].key == key:
            self._steps.pop()
        self._queue_step(_Step(key, take), at_once)

    def set(self, key: str, text: str, *, at_once: bool = False) -> None:
        """Write the text that a person typed or chose into the field with this key."""
        self.change(key, lambda draft: draft.set(draft.fields()[key], text), at_once=at_once)

    def reset(self, key: str) -> None:
        """Reset a field to its default."""
        self.change(key, lambda draft: draft.reset(draft.fields()[key]), at_once=True)
        self._queue_step(_Step("", lambda _, history: history.settled()), at_once=True)

    def say(self, text: str) -> None:
        """Replace the whole text."""
        self.change("text", lambda _: text)

    def check_again(self) -> None:
        """Check the text again, because a file that the text names has changed."""
        if self.settled:
            draft, history = self.draft, self.history
            self._work.ask(lambda: _Outcome(draft_of_file(draft.path, history.text), history, ()))

    def undo(self) -> None:
        """Undo the last step."""
        self._queue_step(_Step("", lambda _, history: history.undone()), at_once=True)

    def redo(self) -> None:
        """Redo the step that was undone last."""
        self._queue_step(_Step("", lambda _, history: history.redone()), at_once=True)

    def settle(self) -> None:
        """Make the next change a separate step, even if it changes the same field."""
        self._queue_step(_Step("", lambda _, history: history.settled()), at_once=False)

    def load_again(self) -> None:
        """Load the file again. A later undo restores the draft."""
        try:
            self.on_disk = read_edited(self.path)
        except BadFile as fault:
            self.failed.emit(str(fault))
            return
        text = self.on_disk.text
        self._watch()
        self.change("disk", lambda _: text, at_once=True)

    def save(self, *, with_faults: bool = False, overwrite: bool = False) -> None:
        """Write the file.

        Args:
            with_faults: True to save in spite of faults.
            overwrite: True to save even if the file has changed since it was read.
        """
        self._save_wanted = with_faults, overwrite
        self._flush()

    def close(self) -> None:
        """Wait until the current work is finished."""
        self._typing.stop()
        self._work.close()

    def _queue_step(self, step: _Step, at_once: bool) -> None:
        self._steps.append(step)
        if at_once:
            self._flush()
        else:
            self._typing.start()

    @Slot()
    def _flush(self) -> None:
        if self._work.busy:
            return  # `_done` will call this method again.
        if not self._steps:
            self._save_if_wanted()
            return
        self._typing.stop()
        steps, self._steps = tuple(self._steps), []
        draft, history = self.draft, self.history
        self._work.ask(lambda: _taken(draft, history, steps))

    def _save_if_wanted(self) -> None:
        if self._save_wanted is None:
            return
        (anyway, over), self._save_wanted = self._save_wanted, None
        if self.draft.faults and not anyway:
            self.found_faulty.emit()
            return
        path, text, read = self.path, self.history.text, self.on_disk
        self._saving = True
        self._work.ask(lambda: _written(path, text, read, over))

    @Slot(object)
    def _done(self, outcome: object) -> None:
        match outcome:
            case _Outcome(draft, history, refused):
                self.draft, self.history = draft, history
                for key, sentence in refused:
                    self.refused.emit(key, sentence)
                self.drafted.emit()
            case TextOnDisk():
                self._saving = False
                self.on_disk = outcome
                self.history = self.history.settled()
                self._watch()
                self.saved.emit()
            case _Conflict():
                self._saving = False
                self.conflicted.emit()
            case BadFile():
                self._saving = False
                self.failed.emit(str(outcome))
        self._flush()

    def _watch(self) -> None:
        """Watch the file again, because Qt's watcher treats a replaced file as another file."""
        wanted = [str(self.path.parent), *([str(self.path)] if self.path.exists() else [])]
        missing = [path for path in wanted if path not in {*self._watcher.files(), *self._watcher.directories()}]
        if missing:
            self._watcher.addPaths(missing)

    @Slot()
    def _look_at_disk(self) -> None:
        if self._saving:
            return  # This program itself is changing the file.
        self._watch()
        try:
            now = read_edited(self.path)
        except BadFile:
            return
        if (now.text, now.exists) != (self.on_disk.text, self.on_disk.exists):
            self.changed_outside.emit()


def _taken(draft: StudyDraft, history: UndoHistory, steps: tuple[_Step, ...]) -> _Outcome:
    refused = []
    for step in steps:
        after = step.take(draft, history)
        if isinstance(after, RequestRefused):
            refused.append((step.key, after.sentence))
            continue
        history = after
        if history.text != draft.text:
            draft = draft_of_file(draft.path, history.text)
    return _Outcome(draft, history, tuple(refused))


def _written(path: Path, text: str, read: TextOnDisk, over: bool) -> TextOnDisk | _Conflict | BadFile:
    try:
        now = read_edited(path)
        if not over and (now.text, now.exists) != (read.text, read.exists):
            return _Conflict(now)
        return write_edited(path, text, read.marked)
    except BadFile as fault:
        return fault

"""Tree of a study's sections. Each section shows the number of fields set in the file, and the number of faults."""

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QTreeWidget, QTreeWidgetItem

from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.form import FormGroup
from ui.windows.look import GAP, follow_text, px
from ui.windows.untrusted_text import shown

NOISE = "noise"
"""Key of the noise section, which is shown on one page together with all its subsections."""
_KEY = Qt.ItemDataRole.UserRole


class SectionTree(QTreeWidget):
    """Tree of sections.

    Attributes:
        chosen: signal: a person wants to see the section with this key.
    """

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setHeaderHidden(True)
        self.setAccessibleName("Sections")
        follow_text(self, lambda it: it.setMinimumWidth(min(px(180), 260)))
        self.setStyleSheet(f"QTreeView::item {{ padding: {GAP // 2}px 0; }}")
        self.currentItemChanged.connect(self._choose)

    def show_draft(self, draft: StudyDraft, key: str) -> None:
        """Show the sections of a draft, and select the section with this key."""
        groups = {group.key: group for group in draft.form.all_groups() if not group.key.startswith(f"{NOISE}.")}
        if set(groups) != set(self._items()):
            self._fill(draft.form, key)
        faulty = [field.key for fault in draft.faults if (field := draft.field_of(fault)) is not None]
        for own, item in self._items().items():
            group = groups[own]
            written = group.written() if own else sum(field.written is not None for field in group.fields)
            wrong = sum(_is_in(place, own) for place in faulty)
            marks = ([f"● {written}"] if written else []) + ([f"⚠ {wrong}"] if wrong else [])
            spoken = ([f"{written} set"] if written else []) + ([f"{wrong} with faults"] if wrong else [])
            item.setText(0, shown("   ".join([group.label, *marks])))
            item.setData(0, Qt.ItemDataRole.AccessibleTextRole, ", ".join([group.label, *spoken]))

    def select(self, key: str) -> bool:
        """Select a section without emitting a signal. Return False if no section has this key."""
        item = self._items().get(key)
        if item is None:
            return False
        with QSignalBlocker(self):
            self.setCurrentItem(item)
        return True

    def _fill(self, form: FormGroup, key: str) -> None:
        """Rebuild the tree; open sections stay open."""
        opened = {own for own, item in self._items().items() if item.isExpanded()}
        self.blockSignals(True)
        self.clear()
        top = QTreeWidgetItem([form.label])
        top.setData(0, _KEY, form.key)
        self.addTopLevelItems([top, *(_made_item(group) for group in form.groups)])
        for own, item in self._items().items():
            item.setExpanded(own in opened)
        self.blockSignals(False)
        self.select(key)

    def _items(self) -> dict[str, QTreeWidgetItem]:
        found: dict[str, QTreeWidgetItem] = {}
        waiting = [self.topLevelItem(index) for index in range(self.topLevelItemCount())]
        while waiting:
            item = waiting.pop(0)
            if item is not None:
                found[str(item.data(0, _KEY))] = item
                waiting += [item.child(index) for index in range(item.childCount())]
        return found

    def _choose(self, item: QTreeWidgetItem | None) -> None:
        if item is not None:
            self.chosen.emit(str(item.data(0, _KEY)))


def _made_item(group: FormGroup) -> QTreeWidgetItem:
    item = QTreeWidgetItem([group.label])
    item.setData(0, _KEY, group.key)
    if group.key != NOISE:
        item.addChildren([_made_item(inner) for inner in group.groups])
    return item


def _is_in(place: str, section: str) -> bool:
    """Return True if a field is in a section. Fields without a section belong to the section of the whole study."""
    return place.startswith((f"{section}.", f"{section}[")) if section else "." not in place

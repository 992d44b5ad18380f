"""Tree of a recording's topics, with their types, their message counts, and the numbers that can be plotted."""

from collections.abc import Iterable, Iterator, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHeaderView, QLineEdit, QTreeWidget, QTreeWidgetItem, QVBoxLayout, QWidget

from ui.sources.numbers import PlottedField, TopicContents
from ui.windows.look import spaced
from ui.windows.untrusted_text import PlainLabel, shown

_FIELD = Qt.ItemDataRole.UserRole
_MARGIN = 8


class TopicTree(QWidget):
    """Tree of all topics. A person opens a topic to see its numbers, and ticks numbers to plot them.

    Signals:
        opened: a person opened a topic whose numbers are not listed yet.
        chosen: a person changed the ticks; with the tuple of ticked numbers, in the order of the tree.
    """

    opened = Signal(str)
    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.filter = QLineEdit(placeholderText="Filter: words that a topic or its type must contain")
        self.filter.setAccessibleName("Filter of the topics")
        self.filter.setClearButtonEnabled(True)
        self.filter.textChanged.connect(self._filter)
        self.total = PlainLabel()
        self.total.setWordWrap(True)
        self.tree = QTreeWidget()
        self.tree.setAccessibleName("Topics and their numbers")
        self.tree.setHeaderLabels(["Topic", "Type", "Messages"])
        self.tree.setUniformRowHeights(True)
        self.tree.header().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.tree.header().setStretchLastSection(False)
        self.tree.itemExpanded.connect(self._open)
        self.tree.itemActivated.connect(self._toggle)
        self.tree.itemChanged.connect(lambda _: self.chosen.emit(tuple(self._ticked())))
        layout = spaced(QVBoxLayout(self), _MARGIN, _MARGIN)
        layout.addWidget(self.filter)
        layout.addWidget(self.tree, 1)
        layout.addWidget(self.total)

    def show_topics(self, topics: Sequence[TopicContents]) -> None:
        """Show these topics, all closed."""
        self.tree.clear()
        for topic in topics:
            item = QTreeWidgetItem([shown(topic.name), shown(topic.msgtype), str(topic.messages)])
            item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            item.setToolTip(0, "Expand the topic to list its numeric fields. Tick fields to plot them.")
            item.setChildIndicatorPolicy(QTreeWidgetItem.ChildIndicatorPolicy.ShowIndicator)
            item.setData(0, _FIELD, topic.name)
            self.tree.addTopLevelItem(item)
        messages = sum(topic.messages for topic in topics)
        topic_count = "1 topic" if len(topics) == 1 else f"{len(topics)} topics"
        self.total.setText(f"{topic_count}, {messages} messages. Open a topic, and tick its numbers to plot them.")

    def show_numbers(self, topic: str, numbers: Sequence[PlottedField]) -> None:
        """List these numbers below their topic."""
        item = next(item for item in _children(self.tree.invisibleRootItem(), 1) if item.data(0, _FIELD) == topic)
        self.tree.blockSignals(True)
        for field in numbers:
            child = QTreeWidgetItem([shown(field.name), field.unit, ""])
            child.setFlags(child.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            child.setCheckState(0, Qt.CheckState.Unchecked)
            child.setData(0, _FIELD, field)
            item.addChild(child)
        if not numbers:
            none = QTreeWidgetItem(["The messages contain no numbers that can be plotted."])
            none.setFlags(Qt.ItemFlag.ItemIsEnabled)
            item.addChild(none)
        self.tree.blockSignals(False)

    def _open(self, item: QTreeWidgetItem) -> None:
        if not item.childCount():
            self.opened.emit(item.data(0, _FIELD))

    def _toggle(self, item: QTreeWidgetItem) -> None:
        """Tick a number, or clear its tick, if a person presses Enter or double-clicks."""
        if item.flags() & Qt.ItemFlag.ItemIsUserCheckable:
            on = item.checkState(0) is Qt.CheckState.Checked
            item.setCheckState(0, Qt.CheckState.Unchecked if on else Qt.CheckState.Checked)

    def _ticked(self) -> Iterable[PlottedField]:
        for child in _children(self.tree.invisibleRootItem(), 2):
            if child.checkState(0) is Qt.CheckState.Checked and isinstance(child.data(0, _FIELD), PlottedField):
                yield child.data(0, _FIELD)

    def _filter(self, text: str) -> None:
        words = text.casefold().split()
        for item in _children(self.tree.invisibleRootItem(), 1):
            named = f"{item.text(0)} {item.text(1)}".casefold()
            item.setHidden(not all(word in named for word in words))


def _children(item: QTreeWidgetItem, depth: int) -> Iterator[QTreeWidgetItem]:
    """Yield the items at this depth below an item."""
    for row in range(item.childCount()):
        child = item.child(row)
        if child is not None and depth == 1:
            yield child
        elif child is not None:
            yield from _children(child, depth - 1)

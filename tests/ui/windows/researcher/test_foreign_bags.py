"""The researcher's window on recordings of others: what is in them is listed, and any number is plotted."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QTreeWidgetItem
from pytestqt.qtbot import QtBot
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.support.bags.foreign_bags import Robot, write, write_map
from tests.support.windows.screen_reader import nameless, stops
from thbridge.files.grid_files import read_grid
from ui.model.shared.theme import LIGHT
from ui.sources.numbers import PlottedField
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.window import ResearcherWindow

START_NS, PERIOD_NS, MESSAGES = 1_600_000_000_000_000_000, 20_000_000, 9000
PANEL = "widgets/msg/Panel"
TEXT = "float64 voltage\nfloat32[] cells\nwidgets/Gauge[] gauges\nstring note\n"
GAUGE = f"{'=' * 80}\nMSG: widgets/Gauge\nstring name\nfloat64 reading\n"


@pytest.fixture(scope="module")
def panel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a type that nobody knows, packed, with nothing that a map could show."""
    bag = tmp_path_factory.mktemp("panel") / "panel.bag"
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(TEXT + GAUGE, PANEL))
    store.register(get_types_from_msg("string data", "std_msgs/msg/String"))
    packing = Writer(bag)
    packing.set_compression(Writer.CompressionFormat.BZ2)
    with packing as writer:
        panel, words = (writer.add_connection(topic, kind, typestore=store) for topic, kind in TOPICS.items())
        for n in range(MESSAGES):
            gauges = [store.types["widgets/msg/Gauge"]("a", n), store.types["widgets/msg/Gauge"]("b", -n)][: 1 + n % 2]
            cells = np.array([0.5, n], dtype=np.float32)
            message = store.types[PANEL](math.sin(n), cells, gauges, "fine")
            writer.write(panel, START_NS + n * PERIOD_NS, store.serialize_ros1(message, PANEL))
        said = store.types["std_msgs/msg/String"]("hello")
        writer.write(words, START_NS, store.serialize_ros1(said, "std_msgs/msg/String"))
    return bag


TOPICS = {"/panel": PANEL, "/words": "std_msgs/msg/String"}


def shown(bag: Path, qtbot: QtBot) -> Iterator[ResearcherWindow]:
    window = ResearcherWindow(RecordingFeed(BagOpener(bag)), bag.name, LIGHT, time.monotonic)
    qtbot.addWidget(window)
    window.show()
    qtbot.waitUntil(lambda: window.topics.tree.topLevelItemCount() > 0)
    yield window
    window.close()


@pytest.fixture
def window(panel: Path, qtbot: QtBot) -> Iterator[ResearcherWindow]:
    yield from shown(panel, qtbot)


def opened(window: ResearcherWindow, row: int) -> QTreeWidgetItem:
    """A topic whose numbers are listed."""
    item = window.topics.tree.topLevelItem(row)
    assert item is not None
    item.setExpanded(True)
    return item


def numbers(item: QTreeWidgetItem) -> list[str]:
    return [item.child(row).text(0) for row in range(item.childCount())]


def test_a_recording_without_a_map_shows_its_topics_in_place_of_the_map_and_of_empty_plots(
    window: ResearcherWindow,
) -> None:
    rows = [window.topics.tree.topLevelItem(row) for row in range(2)]
    assert [[row.text(column) for column in range(3)] for row in rows] == [
        ["/panel", "widgets/Panel", str(MESSAGES)],
        ["/words", "std_msgs/String", "1"],
    ]
    assert window.topics.isVisible() and not window.canvas.isVisible()
    assert not window.tool_help.isVisible()  # there is no map to drag
    assert window.plots.titles == [] and window.plots.nothing.isVisible()
    places = [QRect(stop.mapTo(window, QPoint(0, 0)), stop.size()) for stop in stops(window)]
    assert all(window.rect().intersects(place) for place in places), "Tab goes nowhere that nobody sees"
    assert nameless(window) == []
    assert numbers(opened(window, 0)) == ["voltage", "cells[0]", "cells[1]", "gauges[0].reading", "gauges[1].reading"]
    assert numbers(opened(window, 1)) == ["The messages contain no numbers that can be plotted."]


def test_ticked_numbers_are_plotted_whole_and_go_when_they_are_not_ticked(
    window: ResearcherWindow, qtbot: QtBot
) -> None:
    topic, feed = opened(window, 0), window._feed
    assert feed.data.numbers is not None
    for row in (0, 1, 2, 4):
        topic.child(row).setCheckState(0, Qt.CheckState.Checked)
    qtbot.waitUntil(lambda: not feed.data.numbers.work())
    window._show_numbers()
    assert window.plots.titles == ["/panel voltage", "/panel cells", "/panel reading"]
    times, values = feed.data.numbers.curve(PlottedField("/panel", "", "voltage", ""))
    assert times == pytest.approx(np.arange(MESSAGES) * PERIOD_NS / 1e9)
    assert values == pytest.approx(np.sin(np.arange(MESSAGES)))
    odd = np.arange(1, MESSAGES, 2)
    times, values = feed.data.numbers.curve(PlottedField("/panel", "gauges", "reading", "", item=1))
    assert times == pytest.approx(odd * PERIOD_NS / 1e9) and values == pytest.approx(-odd)
    for row in (0, 4):
        topic.child(row).setCheckState(0, Qt.CheckState.Unchecked)
    assert window.plots.titles == ["/panel cells"]
    assert len(feed.data.numbers.curve(PlottedField("/panel", "", "cells", "", element=1))[0]) == MESSAGES


def test_plots_fill_their_pane_however_they_came(window: ResearcherWindow, qtbot: QtBot) -> None:
    topic = opened(window, 0)
    for row in range(3):
        topic.child(row).setCheckState(0, Qt.CheckState.Checked)
        qtbot.waitUntil(lambda: window._feed.data.numbers is not None and not window._feed.data.numbers.work())
        window.refresh()
        plots = window.plots.canvas
        assert plots.ci.geometry().height() == pytest.approx(plots.height(), abs=4.0)


def test_a_map_is_loaded_in_addition_to_the_recording(tmp_path: Path, qtbot: QtBot) -> None:
    write(tmp_path / "drive.bag", Robot(), 5.0)
    path = write_map(tmp_path / "map")
    for window in shown(tmp_path / "drive.bag", qtbot):
        assert window.scene is not None and window.scene.grid is None
        (robot,) = window.scene.robots
        assert robot.estimate is not None
        assert window.canvas.box.viewRect().contains(robot.estimate.x, robot.estimate.y), "it is in sight"
        window.map_chosen.emit(path)
        window.refresh()
        assert window.scene is not None and window.scene.grid == read_grid(path)
        assert window.canvas.isVisible()
        window.map_chosen.emit(tmp_path / "none.yaml")
        assert "none.yaml" in window.statusBar().currentMessage()

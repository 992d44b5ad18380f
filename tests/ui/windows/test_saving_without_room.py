"""Windows that save on a full and on a read-only disk: the files stay as they were, and what was typed is kept."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QMessageBox
from pytestqt.qtbot import QtBot

from tests.support.disks.small_disk import SmallDisk, why_not
from tests.support.windows.questions import answering
from tests.support.windows.study_windows import leave_study, open_study, retype
from tests.support.windows.template_windows import SHIPPED, append, open_templates


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[SmallDisk]:
    if (reason := why_not()) is not None:
        pytest.skip(reason)
    with SmallDisk(tmp_path / "disk", 16 << 20) as disk:
        yield disk


@contextmanager
def told(qtbot: QtBot) -> Iterator[list[str]]:
    """What message boxes say, until one says something; each is closed."""
    words: list[str] = []

    def look() -> None:
        for box in QApplication.topLevelWidgets():
            if isinstance(box, QMessageBox) and box.isVisible():
                words.append(box.text())
                box.close()

    timer = QTimer(interval=20)
    timer.timeout.connect(look)
    timer.start()
    yield words
    qtbot.waitUntil(lambda: bool(words))
    timer.stop()


def test_a_study(qtbot: QtBot, disk: SmallDisk) -> None:
    file = disk.folder / "pilot.yaml"
    file.write_text("robots: 4\n")
    window = open_study(qtbot, file)
    retype(qtbot, window, "robots", "3")
    with told(qtbot) as full, disk.full():
        window.save()
        qtbot.waitUntil(lambda: bool(full))
    with told(qtbot) as locked, disk.read_only():
        window.save()
        qtbot.waitUntil(lambda: bool(locked))
    assert f"{file}: it cannot be written (No space left on device)." in full[0]
    assert f"{file}: it cannot be written (Read-only file system)." in locked[0]
    assert [path.read_text() for path in disk.folder.iterdir()] == ["robots: 4\n"]
    with qtbot.waitSignal(window.editor.saved):
        window.save()
    assert file.read_text() == "robots: 3\n"
    leave_study(window)


def test_a_set_of_templates(qtbot: QtBot, disk: SmallDisk) -> None:
    folder = Path(shutil.copytree(SHIPPED / "four-properties", disk.folder / "mine"))
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    window = open_templates(qtbot, folder)
    append(window, "DialogueText", "\n")
    with told(qtbot) as full, disk.full():
        assert not window.save()
    with told(qtbot) as locked, disk.read_only():
        assert not window.save()
    assert "DialogueText: it cannot be written (No space left on device)." in full[0]
    assert "DialogueText: it cannot be written (Read-only file system)." in locked[0]
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert window.save()
    assert (folder / "DialogueText").read_bytes() == before[folder / "DialogueText"] + b"\n"
    with answering("Discard"):
        window.close()
    window.deleteLater()

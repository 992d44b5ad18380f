"""A study in its form."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows.study_windows import leave_study, open_study
from ui.model.shared.theme import LIGHT
from ui.windows.look import apply_palette
from ui.windows.study import StudyWindow

TEXT = """\
# our pilot
robots: 4   # two pairs
game:
  energy: 90  # enough
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "pilot.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture
def window(qtbot: QtBot, qapp: QApplication, file: Path) -> Iterator[StudyWindow]:
    apply_palette(qapp, LIGHT)
    window = open_study(qtbot, file)
    yield window
    leave_study(window)

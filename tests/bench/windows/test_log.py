"""What it costs the researcher's window that its lists are full."""

from collections.abc import Callable
from functools import partial

import pytest
from PySide6.QtWidgets import QLineEdit, QTableView
from pytestqt.qtbot import QtBot

from tests.bench.budget import Budgets, cpu_seconds
from tests.support.windows.log_rows import rows
from ui.windows.researcher.docks.log import MAX_ROWS, LogView

pytestmark = pytest.mark.bench

TIMES = 5


def full(qtbot: QtBot) -> LogView:
    """A list that has room for one row more."""
    log = LogView("Dialogue", ("Who", "What"))
    qtbot.addWidget(log)
    log.resize(500, 300)
    log.show()
    log.extend(rows(0, MAX_ROWS - 1))
    return log


def test_a_full_list(qtbot: QtBot, budgets: Budgets) -> None:
    changes: dict[str, Callable[[LogView], object]] = {
        "one more row": lambda log: log.extend(rows(MAX_ROWS, 1)),
        "filter": lambda log: log.findChild(QLineEdit).setText("sentence 3"),
        "ten rows too many": lambda log: log.extend(rows(MAX_ROWS + 1, 10)),
    }

    def shown(change: Callable[[LogView], object], log: LogView) -> None:
        change(log)
        log.findChild(QTableView).grab()

    for what, change in changes.items():
        logs = [full(qtbot) for _ in range(TIMES)]
        spent = min(cpu_seconds(partial(shown, change, log)) for log in logs)
        print(f"{what}: {1000.0 * spent:.1f} ms")
        budgets.time(f"log: {what}", spent)

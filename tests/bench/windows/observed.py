"""`thbridge`, which writes down meanwhile where robots believe they are and where they are drawn, and when that was.

    python -m tests.bench.windows.observed FOLDER ARGUMENTS OF thbridge...

Each tick of a team goes into FOLDER/believed, each painting of a map into FOLDER/drawn: lines of monotonic seconds and
x, y of each robot. A participant's window plays by itself, by the keys that its screen offers.
"""

import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import TextIO

from sim.common.geometry import Pose2
from sim.team import Team


def main() -> None:
    folder, arguments = Path(sys.argv[1]), sys.argv[2:]
    sys.argv[1:] = arguments
    if arguments[0] == "tabui":
        observe_window(folder / "drawn")
    else:
        observe_team(folder / "believed")
    from ui import cli  # noqa: PLC0415 - only now: it reads the arguments
    from ui.hosting import games  # noqa: PLC0415

    games.WINDOW = (sys.executable, "-m", "tests.bench.windows.observed", str(folder), "tabui", "--hosted")
    cli.main()


def write(file: TextIO, poses: Iterable[Pose2]) -> None:
    file.write(" ".join([f"{time.monotonic():.6f}", *(f"{pose.x:.4f} {pose.y:.4f}" for pose in poses)]) + "\n")


def observe_team(path: Path) -> None:
    """Each tick of the team that is paced, when it is worked out."""
    file = path.open("a", buffering=1)
    step = Team.step

    def stepped(self, inputs=()):
        snapshot = step(self, inputs)
        write(file, (robot.estimate.base_in_map for robot in snapshot.robots))
        return snapshot

    Team.step = stepped


def observe_window(path: Path) -> None:
    """Each painting of the map, when it is done."""
    from PySide6.QtCore import QTimer  # noqa: PLC0415 - Qt, only in the window

    from tests.bench.windows.filmed_hunt import key_for  # noqa: PLC0415
    from ui.model.playing.keys import act_for  # noqa: PLC0415
    from ui.windows.map import MapView  # noqa: PLC0415
    from ui.windows.participant.pages.start import StartPage  # noqa: PLC0415
    from ui.windows.participant_program import ParticipantMainWindow  # noqa: PLC0415

    file = path.open("a", buffering=1)
    beats = path.with_name("beats").open("a", buffering=1)
    paint, show = MapView.paintEvent, ParticipantMainWindow.show

    def painted(self, event):
        paint(self, event)
        write(file, (mark.pose for mark in self._robots.marks))

    def shown(self):
        show(self)
        self.resize(1200, 800)
        play = QTimer(self)
        play.timeout.connect(lambda: turn(self))
        play.start(400)
        beat = QTimer(self)
        beat.timeout.connect(lambda: beats.write(f"{time.monotonic():.6f} {time.thread_time():.6f}\n"))
        beat.start(5)

    def turn(table):
        if table.game is None:
            for page in table.findChildren(StartPage):
                page.begin.click()
            return
        screen = table.game._model.screen(time.monotonic())
        act = act_for(key_for(screen), screen)
        if act is not None:
            table.game.window_of_game.do(act)

    MapView.paintEvent, ParticipantMainWindow.show = painted, shown


if __name__ == "__main__":
    main()

"""How long a frame of the map takes on the software rasteriser, trails, ways and ellipses on, in the office."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from tests.bench.budget import Budgets
from tests.support.maps.sample_maps import busy_robots, house_of, rooms_of
from thbridge.files.map_files import Map
from thbridge.roles.shared.notices import PlannedPaths, PoseTelemetry
from ui.model.playing.motion import MotionPlayback
from ui.model.shared.scene import RobotMark
from ui.model.shared.theme import LIGHT
from ui.windows.map import MapView
from ui.windows.map.item import Z_FLAT
from ui.windows.researcher.map.overlays import Dots

pytestmark = pytest.mark.bench

SIZES = ((1200, 800), (1920, 1080))
FRAMES = 150
PARTICLES = 500
RNG = np.random.default_rng(1)


def opened(qtbot: QtBot, office: Map, width: int, height: int) -> MapView:
    view = MapView(LIGHT)
    qtbot.addWidget(view)
    view.setWindowFlag(Qt.WindowType.FramelessWindowHint)
    view.resize(width, height)
    view.show_floor_plan(house_of(office))
    view.show_rooms(rooms_of(office))
    with qtbot.waitExposed(view):
        view.show()
    return view


def moved(robots: list[RobotMark], frame: int) -> list[RobotMark]:
    return [
        replace(mark, pose=replace(mark.pose, x=mark.pose.x + 0.01 * frame, theta=mark.pose.theta + 0.02 * frame))
        for mark in robots
    ]


def judge(budgets: Budgets, what: str, frame: Callable[[int], None]) -> None:
    """Measure how long a frame takes, and the processor's share in that."""
    frame(0)
    walls, cpus = [], []
    for number in range(FRAMES):
        began, begun = time.perf_counter(), time.process_time()
        frame(number)
        walls.append(time.perf_counter() - began)
        cpus.append(time.process_time() - begun)
    used = float(np.median(cpus))
    early, median, late = np.percentile(walls, [5, 50, 95])
    print(
        f"\n{what}: {1e3 * early:.1f} ms undisturbed, median {1e3 * median:.1f}, 95 % below {1e3 * late:.1f},"
        f" processor {1e3 * used:.1f} ms: {100.0 * used * 60:.0f} % of a core at 60 frames/s",
        end="",
    )
    assert early < 1.0 / 60.0
    budgets.time(f"map: a frame, {what}", used)


@pytest.mark.parametrize("size", SIZES)
def test_frames_of_robots(qtbot: QtBot, office: Map, budgets: Budgets, size: tuple[int, int]) -> None:
    for count in (1, 4, 10, 20):
        view, robots = opened(qtbot, office, *size), busy_robots(office, count)

        def frame(number: int, view: MapView = view, robots: list[RobotMark] = robots) -> None:
            view.show_robots(moved(robots, number))
            view.viewport().repaint()

        judge(budgets, f"{count} robots, {size[0]} x {size[1]}", frame)


@pytest.mark.parametrize("size", SIZES)
def test_frames_with_clouds(qtbot: QtBot, office: Map, budgets: Budgets, size: tuple[int, int]) -> None:
    view, robots = opened(qtbot, office, *size), busy_robots(office, 10)
    clouds = Dots(view.box, Z_FLAT, 2.0)
    scattered = RNG.normal(scale=0.3, size=(PARTICLES, 2))

    def frame(number: int) -> None:
        clouds.show_rows(
            {mark.robot: scattered + np.array([mark.pose.x + 0.01 * number, mark.pose.y]) for mark in robots}
        )
        view.show_robots(moved(robots, number))
        view.viewport().repaint()

    judge(budgets, f"10 robots with {PARTICLES} particles each, {size[0]} x {size[1]}", frame)


@pytest.mark.parametrize("size", SIZES)
def test_frames_while_following_and_zooming(qtbot: QtBot, office: Map, budgets: Budgets, size: tuple[int, int]) -> None:
    view, robots = opened(qtbot, office, *size), busy_robots(office, 10)

    def follow(number: int) -> None:
        view.follow(0)
        view.show_robots(moved(robots, number))
        view.viewport().repaint()

    def choose(number: int) -> None:
        view.show_rooms([replace(mark, considered=mark.room == 1 + number % 8) for mark in rooms_of(office)])
        view.viewport().repaint()

    judge(budgets, f"following one of 10 robots, {size[0]} x {size[1]}", follow)
    judge(budgets, f"another room looked at with every frame, {size[0]} x {size[1]}", choose)


def test_motions(office: Map, budgets: Budgets) -> None:
    motions = MotionPlayback()
    robots = busy_robots(office, 10)
    motions.receive(PlannedPaths(0, tuple(tuple((x, y) for x, y in mark.path.tolist()) for mark in robots)), 0.0)
    for tick in range(0, 100, 2):
        poses = tuple((mark.pose.x + 0.01 * tick, mark.pose.y, mark.pose.theta) for mark in robots)
        motions.receive(PoseTelemetry(tick, poses), 0.02 * tick)
    judge(
        budgets,
        "10 robots' poses, trails and paths at a moment",
        lambda number: motions.at(2.0 + number / 60.0) and None,
    )

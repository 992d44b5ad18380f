"""Outcome of a hunt, and the default path of its recording."""

from collections.abc import Iterator
from pathlib import Path

from rich.table import Table

from sim.common.robot_numbers import index_of, robot_name
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import HuntOutcome
from thbridge.app.run_statistics import RobotStatistics
from thbridge.files.disk.inside import path_inside
from thbridge.recording.recordings import parts_of
from ui.command_line.terminal import bad_input, out


def usual_bag(setting: StudySetting) -> Path:
    """Return the default path of a hunt's recording; end the program if the map's name cannot be part of a path."""
    study = setting.study
    with bad_input():
        name = f"{setting.map.name}-{study.robots}robots-seed{study.seed}{study.recording.ending}"
        return path_inside(Path("bags"), name)


def _robot_rows(robot: RobotStatistics) -> Iterator[tuple[str, str]]:
    """Yield the figures of a robot, each with its label."""
    if robot.position_rmse is not None and robot.position_max is not None:
        usual = f"{100 * robot.position_rmse:.1f} cm, {robot.heading_rmse:.1f}°"
        yield "position error", f"{usual} rms; at most {100 * robot.position_max:.1f} cm, {robot.heading_max:.1f}°"
    waited = f", waited {robot.seconds_waiting:.1f} s for other robots" if robot.seconds_waiting else ""
    yield "distance driven", f"{robot.distance:.1f} m{waited}"
    if robot.times_lost:
        yield "times lost", f"{robot.times_lost}, for {robot.seconds_lost:.1f} s in total"


def show_outcome(outcome: HuntOutcome) -> None:
    """Print the result of a hunt, with one column per game if there were several games."""
    several = len(outcome.games) > 1
    table = Table(title="The hunt", show_header=several)
    for heading in ("", *(f"game {game.game}" for game in outcome.games)) if several else ("", ""):
        table.add_column(heading)
    games = outcome.games or (outcome,)
    table.add_row("score", *(str(game.score) for game in games))
    table.add_row("rooms visited", *(str(game.rooms_visited) for game in games))
    table.add_row("treasures identified", *(str(game.identified) for game in games))
    for robot in range(len(outcome.energy)):
        table.add_row(f"{robot_name(robot)}: energy left", *(f"{game.energy[robot]:g}" for game in games))
    for each in outcome.robots:
        for what, words in _robot_rows(each):
            table.add_row(f"{robot_name(index_of(each.robot))}: {what}", words)
    table.add_row("simulated time", f"{outcome.sim_seconds:.1f} s in {outcome.wall_seconds:.1f} s of real time")
    table.add_row("collisions", str(outcome.collisions))
    if outcome.bag is not None:
        first, *others = parts_of(outcome.bag)
        table.add_row("bag", f"{first} to {others[-1].name}" if others else str(first))
    out.print(table)

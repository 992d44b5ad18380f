"""Outcome of a hunt, and the place of its recording."""

from pathlib import Path

from rich.table import Table

from sim.common.robot_numbers import robot_name
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import HuntOutcome
from thbridge.recording.recordings import parts_of
from ui.terminal import out


def usual_bag(setting: StudySetting) -> Path:
    """Return the default path of a hunt's recording."""
    study = setting.study
    return Path("bags") / f"{setting.map.name}-{study.robots}robots-seed{study.seed}.bag"


def show_outcome(outcome: HuntOutcome) -> None:
    """Print how a hunt ended."""
    table = Table(title="The hunt", show_header=False)
    table.add_row("score", str(outcome.score))
    table.add_row("rooms visited", str(outcome.rooms_visited))
    table.add_row("treasures named", str(outcome.identified))
    for robot, energy in enumerate(outcome.energy):
        table.add_row(f"energy of {robot_name(robot)}", f"{energy:g}")
    table.add_row("simulated time", f"{outcome.sim_seconds:.1f} s in {outcome.wall_seconds:.1f} s")
    table.add_row("collisions", str(outcome.collisions))
    if outcome.bag is not None:
        first, *others = parts_of(outcome.bag)
        table.add_row("bag", f"{first} to {others[-1].name}" if others else str(first))
    out.print(table)

"""Output of `thbridge maps check`."""

from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

from thbridge.files.map_files import MapFinding
from thbridge.files.map_times import MAP_TIMES
from thbridge.hunt.rooms import Room
from thbridge.offline.map_survey import Doorway, MapSurvey
from ui.command_line.pictures import write_picture
from ui.command_line.terminal import command, out, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def show_survey(seen: MapSurvey, folder: Path) -> None:
    """Print what a map contains."""
    place, grid = seen.place, seen.place.grid
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    say(f"{place.name}: {width:.1f} m x {height:.1f} m, {grid.cols} x {grid.rows} cells of {grid.resolution:g} m")
    say(f"floor: {seen.free:.0%} free, {seen.occupied:.0%} occupied, {seen.unknown:.0%} unknown")
    table = Table("room", "name", "area", "doors")
    for entry in seen.rooms:
        doors = ", ".join(f"{door.width:.1f} m to {_beyond(door, entry.room.room)}" for door in entry.doors)
        table.add_row(str(entry.room.room.people), entry.room.name, f"{entry.area:.1f} m²", doors or "none")
    out.print(table)
    first = place.starts[0] if place.starts else None
    where = "" if first is None else f"; robot 1 starts at ({first.x:g}, {first.y:g})"
    say(f"start poses: {len(place.starts)}{where}")
    say(f"reachable: {seen.reachable} of {seen.pairs} paths from the start and each room to each other room")
    measure = command("maps", "measure", folder, "--out", folder / MAP_TIMES)
    known = f"known, in {MAP_TIMES}" if place.costs else f"none yet; measure them with `{measure}`"
    say(f"travel times: {known}")


def _beyond(door: Doorway, room: Room) -> Room:
    """Return the room on the other side of a door."""
    return door.beyond if door.room == room else door.room


def survey_as_json(seen: MapSurvey) -> dict[str, object]:
    """Return the figures as a JSON object, in meters, square meters, and shares of 0 to 1."""
    place, grid = seen.place, seen.place.grid
    return {
        "name": place.name,
        "size": [round(grid.cols * grid.resolution, 3), round(grid.rows * grid.resolution, 3)],
        "cells": [grid.cols, grid.rows],
        "resolution": grid.resolution,
        "free": round(seen.free, 4),
        "occupied": round(seen.occupied, 4),
        "unknown": round(seen.unknown, 4),
        "rooms": [
            {
                "number": entry.room.room.people,
                "name": entry.room.name,
                "area": round(entry.area, 3),
                "goal": [entry.room.goal.x, entry.room.goal.y, entry.room.goal.theta],
                "doors": [
                    {
                        "to": _beyond(door, entry.room.room).people,
                        "x": round(door.x, 3),
                        "y": round(door.y, 3),
                        "width": round(door.width, 3),
                    }
                    for door in entry.doors
                ],
            }
            for entry in seen.rooms
        ],
        "starts": [[start.x, start.y, start.theta] for start in place.starts],
        "ways": {"all": seen.pairs, "reachable": seen.reachable},
        "times": place.costs is not None,
    }


def finding_as_json(finding: MapFinding) -> dict[str, object]:
    """Return a finding as a JSON object."""
    fault = finding.fault
    return {
        "severity": finding.severity,
        "message": str(fault),
        "file": str(fault.path),
        "line": fault.line,
        "key": fault.key,
        "problem": fault.problem,
        "remedy": fault.remedy,
    }


def write_survey_picture(seen: MapSurvey, to: Path) -> None:
    """Draw a map into a file, in the format of its suffix.

    Raises:
        BadFile: the file cannot be written.
    """

    def draw() -> "Figure":
        from thbridge.offline.map_picture import map_picture  # imports matplotlib

        return map_picture(seen)

    write_picture(draw, to, "--to")

"""Choice of the file with the costs of a study's moves, and warnings about this file."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from sim.parameters import RobotParameters
from thbridge.files.errors import BadFile
from thbridge.files.map_files import Map, read_map
from thbridge.files.map_times import MAP_TIMES, read_map_times
from thbridge.files.resources import Resources
from thbridge.files.template_files import TemplateSet, read_template_set
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.study.study_file import CostModel, Study

ROUNDING = 1.0
"""Seconds by which a trip may be faster than a straight drive, because files round times and goals have tolerances."""


def costs_file(
    study: Study, beside: Path, place: Map, folder: Path, templates: TemplateSet, resources: Resources
) -> Path:
    """Return the file with the costs of moves.

    The study's own cost file has priority, then the cost file of the templates if it is for this map, then the cost
    file of the map. If the templates do not name a map, the cost file of the templates is for all maps.

    Args:
        study: the study.
        beside: folder to which paths in the study are relative.
        place: map of the study.
        folder: folder of the study's templates.
        templates: templates of the study.
        resources: maps and templates that are known by name.

    Raises:
        BadFile: there is no cost file for this map.
    """
    if study.game.costs is not None:
        of_a_set = str(study.game.costs) in resources.names("templates")
        return resources.root / "templates" / study.game.costs / MAP_TIMES if of_a_set else beside / study.game.costs
    of_map = resources.find("maps", study.map, beside)
    names_map = templates.costs is not None and _names(templates.map, of_map, place, resources)
    if place.costs is not None and not (names_map and study.game.cost_model is not CostModel.POSITION):
        return place.costs
    if templates.costs is not None and (templates.map is None or names_map):
        return folder / MAP_TIMES
    if templates.costs is None:
        problem = f"moves have no costs, because neither this folder nor the map {place.name} has a file {MAP_TIMES}"
    elif templates.map == place.name:
        problem = f"these costs are for the built-in map {place.name}, but the study has another map of this name"
    else:
        problem = f"these costs are for the map {templates.map}, and the map {place.name} has no file {MAP_TIMES}"
    measure = f"thbridge maps measure {of_map} --out {of_map / MAP_TIMES}"
    remedy = f"measure the trips with `{measure}`, or name another file with `game: costs:` in the study"
    raise BadFile(folder / MAP_TIMES, problem, remedy)


def _names(name: str | None, of_map: Path, place: Map, resources: Resources) -> bool:
    """Return True if a name in `set.yaml` means this map. The name of a built-in map also means copies of that map."""
    if name != place.name or name not in resources.names("maps"):
        return name == place.name
    shipped = resources.root / "maps" / name
    if of_map.samefile(shipped):
        return True
    original = read_map(shipped, with_costs=False)
    return (original.grid, original.rooms) == (place.grid, place.rooms)


def read_costs(path: Path, place: Map) -> CostMatrix:
    """Return the costs in a file. Raises BadFile: the file cannot be read, or does not fit the map."""
    costs = read_map_times(path)
    if len(costs.rooms) != len(place.rooms):
        raise BadFile(
            path,
            f"the file has {len(costs.rooms) + 1} nodes, but the map {place.name} has {len(place.rooms)} rooms and a "
            "corridor",
            f"write a file {MAP_TIMES} with {len(place.rooms) + 1} nodes into the map's folder by `thbridge maps "
            "measure`, or name a file with `game: costs:` in the study",
            line=1,
            key="number of nodes",
        )
    return costs


def doubts_of_costs(
    path: Path, costs: CostMatrix, study: Study, place: Map, templates: TemplateSet, resources: Resources
) -> Iterator[BadFile]:
    """Yield warnings that a cost file may be for another map.

    Args:
        path: the file that `costs_file` found.
        costs: content of the file.
        study: the study.
        place: map of the study.
        templates: templates of the study.
        resources: maps and templates that are known by name.
    """
    if study.game.costs is not None:
        if path.parent.parent == resources.root / "templates":
            meant = read_template_set(path.parent).map
            if meant not in {None, place.name}:
                problem = f"the costs of moves on the map {place.name} come from this file for the map {meant}"
                yield BadFile(path, problem, "If you do not want this, delete `game: costs:` in the study")
    elif path != place.costs:
        if templates.map is None:
            problem = (
                f"the costs of moves on the map {place.name} come from this file, but set.yaml does not name the "
                "file's map"
            )
            remedy = f"If the file is for this map, write `map: {place.name}` into set.yaml"
            yield BadFile(path, problem, remedy)
    elif too_cheap := tuple(_faster_than_robots(costs, study, place)):
        start, goal, least = too_cheap[0]
        problem = (
            f"{len(too_cheap)} trips take less time than the study's robots need: {start} to {goal} takes "
            f"{costs.cost(start, goal):g} s in this file, but at least {least:.0f} s at the robots' highest speed"
        )
        remedy = "If the file is for another map or other robots, measure the trips again with `thbridge maps measure`"
        yield BadFile(path, problem, remedy)


def _faster_than_robots(costs: CostMatrix, study: Study, place: Map) -> Iterator[tuple[Room, Room, float]]:
    """Yield each trip that is faster than a straight drive at the highest speed: start, goal, seconds of that drive."""
    planned = max(map(_greatest_speed, (study.robot, *study.each.values())))
    fastest = min(planned, study.world.max_vel_x)
    goals = {entry.room: (entry.goal,) for entry in place.rooms}
    for (start, poses), (goal, (there,)) in product([(CORRIDOR, place.starts), *goals.items()], goals.items()):
        least = min(pose.distance(there) for pose in poses) / max(fastest, 1e-3)
        if start != goal and costs.cost(start, goal) + ROUNDING < least:
            yield start, goal, least


def _greatest_speed(software: RobotParameters) -> float:
    dwa = software.DWAPlannerROS
    return max(software.TrajectoryPlannerROS.max_vel_x, dwa.max_vel_x, dwa.max_vel_trans)

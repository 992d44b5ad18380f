"""Compare the speed of a simulated team with IR-SIM: simulated seconds per processor second, in one run.

Run this script from the project's folder. Name the Python of an environment in which `pip install ir-sim==2.12.0` was
run: `.venv/bin/python scripts/compare_simulators.py --ir-sim /tmp/ir-sim/bin/python [--robots 1 10 50]`.

Both simulators drive the same number of robots with differential drive in the same hall, with lasers of 360 beams and a
range of 10 m. IR-SIM runs at 10 Hz: bodies, lasers, collisions and a straight drive to goals. Our simulator moves
bodies at 50 Hz, and each robot also localizes itself, keeps costmaps, plans, and avoids the other robots.
"""

import argparse
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

from scipy.ndimage import find_objects, label

from sim.parameters import LaserParameters, RobotParameters, WorldParameters
from sim.team import Team
from tests.support.maps.hall_of_shelves import hall
from tests.support.robots.robots_under_way import drive

SECONDS = 20
RUNS = 3

PEER = """
import sys, time
import matplotlib
matplotlib.use("Agg")
import irsim
steps = int(sys.argv[2])
world = irsim.make(sys.argv[1], display=False, log_level="ERROR")
for _ in range(5):
    world.step()
began = time.process_time()
for _ in range(steps):
    world.step()
print(time.process_time() - began)
"""


def peer_world(robots: int, folder: Path) -> Path:
    """Write IR-SIM's description of the hall with `robots` robots."""
    grid, places = hall()
    height, width = (cells * grid.resolution for cells in grid.cells.shape)
    # Walls and shelves are rectangles: IR-SIM is much faster with them than with a grid map.
    walls, _ = label(grid.cells[2:-2, 2:-2] > 0)
    boxes = [(rows.start + 2, rows.stop + 2, cols.start + 2, cols.stop + 2) for rows, cols in find_objects(walls)]
    rows, cols = grid.cells.shape
    boxes += [(0, 2, 0, cols), (rows - 2, rows, 0, cols), (0, rows, 0, 2), (0, rows, cols - 2, cols)]
    obstacles = [
        {
            "shape": {
                "name": "rectangle",
                "length": (right - left) * grid.resolution,
                "width": (top - low) * grid.resolution,
            },
            "state": [0.5 * (left + right) * grid.resolution, 0.5 * (low + top) * grid.resolution, 0.0],
        }
        for low, top, left, right in boxes
    ]
    team = [
        {
            "kinematics": {"name": "diff"},
            "shape": {"name": "circle", "radius": 0.2},
            "state": [place.x, place.y, 0.0],
            "goal": [goal.x, goal.y, 0.0],
            "behavior": {"name": "dash", "wander": True, "range_low": [1, 1, -3], "range_high": [25, 13, 3]},
            "vel_min": [-0.5, -1.0],
            "vel_max": [0.5, 1.0],
            "sensors": [
                {"type": "lidar2d", "range_max": 10.0, "angle_range": 2 * math.pi, "number": 360, "noise": True}
            ],
        }
        for place, goal in zip(places[:robots], places[-robots:], strict=True)
    ]
    world = {
        "world": {
            "width": width,
            "height": height,
            "step_time": 0.1,
            "sample_time": 0.1,
            "collision_mode": "unobstructed",
        },
        "robot": team,
        "obstacle": obstacles,
    }
    path = folder / "world.yaml"
    path.write_text(json.dumps(world))  # JSON is valid YAML
    return path


def peer(python: str, robots: int) -> float:
    """Return the simulated seconds per processor second of IR-SIM."""
    with tempfile.TemporaryDirectory() as folder:
        world = peer_world(robots, Path(folder))
        seconds = 2 if robots > 10 else 5
        done = subprocess.run(
            [python, "-c", PEER, str(world), str(10 * seconds)], stdout=subprocess.PIPE, text=True, check=True
        )
    return seconds / float(done.stdout.split()[-1])


def own(robots: int) -> float:
    """Return the simulated seconds per processor second of our simulator."""
    grid, places = hall()
    laser = LaserParameters(beams=360, field_of_view=2 * math.pi)
    team = Team(grid, WorldParameters(laser=laser), [RobotParameters()] * robots, places[:robots], 1, 1000.0)
    drive(team, places, 5)
    began = time.process_time()
    drive(team, places, SECONDS)
    return SECONDS / (time.process_time() - began)


def main() -> None:
    """Print the best of several runs of each simulator, which alternate."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ir-sim", required=True, help="Python of an environment with IR-SIM")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 2, 5, 10, 20, 50])
    arguments = parser.parse_args()
    print("robots     own  IR-SIM")
    for robots in arguments.robots:
        pairs = [(own(robots), peer(arguments.ir_sim, robots)) for _ in range(RUNS)]
        ours, theirs = (max(figures) for figures in zip(*pairs, strict=True))
        print(f"{robots:6d} {ours:7.2f} {theirs:7.2f}", flush=True)


if __name__ == "__main__":
    main()

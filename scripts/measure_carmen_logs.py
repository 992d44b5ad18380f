"""Measure the localizer on recordings of real robots: CARMEN logs with corrected poses, from public collections.

Run this script from the project's folder: `.venv/bin/python scripts/measure_carmen_logs.py LOGS --to FOLDER`, where
LOGS is a folder of `*-corrected.log.gz`. These logs have the laser's poses as found by a mapping program and, between
two scans, the wheel motion since the first of the two scans. The sum of these motions is the wheel odometry with all
its drift. A map is drawn from every second scan. On this map, `thbridge localize` localizes all scans, with a known and
with an unknown start pose, and draws the paths. The script prints Markdown tables with the localizer's distances from
the mapping program's poses, and with its reported probabilities of a wrong pose and the shares of wrong poses. Logs
without odometry between scans are skipped.

Source: CARMEN's log format (FLASER and ODOM).
"""

import argparse
import csv
import gzip
import math
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from tests.bench.robots.wrong_pose_runs import HEAD, UpdateRow, calibration, is_wrong

if TYPE_CHECKING:
    from rosbags.typesys.store import Msg

RESOLUTION = 0.05
LONGEST = 25.0
"""Range in meters; a beam with at least this range has hit nothing."""
SPEED = 0.5
"""Speed in meters per second that is assumed for logs without times."""
STORE = get_typestore(Stores.ROS1_NOETIC)
TYPES = STORE.types


@dataclass(frozen=True, slots=True, eq=False)
class LoggedScan:
    """Scan of a log.

    Attributes:
        ranges: (n,) meters, from right to left over half a circle.
        laser_in_map: pose of the laser, found by the mapping program.
        laser_in_odom: pose of the laser from wheel odometry alone.
        seconds: time since the beginning, seconds.
    """

    ranges: FloatArray
    laser_in_map: Pose2
    laser_in_odom: Pose2
    seconds: float


def scans_of(log: Path) -> list[LoggedScan]:
    """Read the scans of a log."""
    scans: list[LoggedScan] = []
    last: Pose2 | None = None
    way, driven, odom = Pose2(0.0, 0.0, 0.0), 0.0, Pose2(0.0, 0.0, 0.0)
    for words in _lines(log):
        if words[0] == "ODOM" and last is not None:
            way = last.between(Pose2(*map(float, words[1:4])))
        elif words[0] == "FLASER":
            count = int(words[1])
            here = Pose2(*map(float, words[2 + count : 5 + count]))
            odom = odom.compose(way)
            # In some logs, times decrease or are all equal, so times are computed from the path.
            driven += math.hypot(way.x, way.y) + 0.2 * abs(way.theta)
            ranges = np.array(words[2 : 2 + count], dtype=np.float64)
            scans.append(LoggedScan(ranges, here, odom, driven / SPEED + 0.25 * len(scans)))
            last, way = here, Pose2(0.0, 0.0, 0.0)
    return scans


def _lines(log: Path) -> Iterator[list[str]]:
    with gzip.open(log, "rt", errors="replace") as file:
        for line in file:
            words = line.split()
            if words:
                yield words


def directions(count: int) -> FloatArray:
    """Return (n,) directions of a scan's beams, radians: every degree or half degree, from right to left."""
    step = math.pi / (180.0 if count < 200 else 360.0)
    return -0.5 * math.pi + step * np.arange(count, dtype=np.float64)


def draw_map(scans: list[LoggedScan], folder: Path) -> Path:
    """Draw a map from scans at the mapping program's poses.

    A cell belongs to a wall if the number of beams that end in it is at least a third of the number of scans that see
    it.
    """
    ends = [_ends(scan) for scan in scans]
    low = np.min([each.min(axis=0) for each, _ in ends if len(each)], axis=0) - 1.0
    high = np.max([each.max(axis=0) for each, _ in ends if len(each)], axis=0) + 1.0
    cols, rows = np.ceil((high - low) / RESOLUTION).astype(int)
    hits, passed = np.zeros((rows, cols), dtype=np.int32), np.zeros((rows, cols), dtype=np.int32)
    for scan, (points, met) in zip(scans, ends, strict=True):
        start = np.array([scan.laser_in_map.x, scan.laser_in_map.y])
        seen = np.zeros((rows, cols), dtype=bool)
        for end, is_wall in zip(points, met, strict=True):
            length = float(np.hypot(*(end - start)))
            along = np.arange(0.0, max(length - RESOLUTION, 0.0), 0.5 * RESOLUTION)[:, np.newaxis] / max(length, 1e-9)
            col, row = ((start + along * (end - start) - low) / RESOLUTION).astype(int).T
            seen[row, col] = True
            if is_wall:
                col, row = ((end - low) / RESOLUTION).astype(int)
                hits[row, col] += 1
        passed += seen
    cells = np.where(hits * 3 >= np.maximum(passed, 1), 0, np.where(passed > 0, 254, 205)).astype(np.uint8)
    cells[(hits == 0) & (passed == 0)] = 205
    Image.fromarray(cells[::-1]).save(folder / "map.pgm")
    path = folder / "map.yaml"
    path.write_text(
        f"image: map.pgm\nresolution: {RESOLUTION}\norigin: [{low[0]:.3f}, {low[1]:.3f}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


def _ends(scan: LoggedScan) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return (n, 2) ends of the beams in the map, and (n,) flags, True if a beam hit something."""
    met = scan.ranges < LONGEST
    far = np.minimum(scan.ranges, LONGEST)
    angle = directions(len(scan.ranges)) + scan.laser_in_map.theta
    x = scan.laser_in_map.x + far * np.cos(angle)
    y = scan.laser_in_map.y + far * np.sin(angle)
    useful = (scan.ranges > 0.05) & (met | (scan.ranges < 100.0))
    return np.column_stack((x, y))[useful], met[useful]


def write_bag(scans: list[LoggedScan], path: Path) -> None:
    """Write scans and odometry as a ROS 1 bag."""
    odometry, laser = TYPES["nav_msgs/msg/Odometry"], TYPES["sensor_msgs/msg/LaserScan"]
    with Writer(path) as bag:
        wheels = bag.add_connection("/odom", odometry.__msgtype__, typestore=STORE)
        beams = bag.add_connection("/scan", laser.__msgtype__, typestore=STORE)
        for number, scan in enumerate(scans):
            stamp = round(1e9 * (1.0 + scan.seconds))
            bag.write(wheels, stamp, STORE.serialize_ros1(_odometry(number, stamp, scan), odometry.__msgtype__))
            said = laser(
                header=_header(number, stamp, "laser"),
                angle_min=float(directions(len(scan.ranges))[0]),
                angle_max=float(directions(len(scan.ranges))[-1]),
                angle_increment=float(np.diff(directions(len(scan.ranges)))[0]),
                time_increment=0.0,
                scan_time=0.2,
                range_min=0.05,
                range_max=LONGEST,
                ranges=np.where(scan.ranges < LONGEST, scan.ranges, np.inf).astype(np.float32),
                intensities=np.empty(0, dtype=np.float32),
            )
            bag.write(beams, stamp, STORE.serialize_ros1(said, laser.__msgtype__))


def _header(number: int, stamp: int, frame: str) -> "Msg":
    time = TYPES["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    return TYPES["std_msgs/msg/Header"](seq=number, stamp=time, frame_id=frame)


def _pose(pose: Pose2) -> "Msg":
    turned = TYPES["geometry_msgs/msg/Quaternion"](
        x=0.0, y=0.0, z=math.sin(pose.theta / 2.0), w=math.cos(pose.theta / 2.0)
    )
    return TYPES["geometry_msgs/msg/Pose"](
        position=TYPES["geometry_msgs/msg/Point"](x=pose.x, y=pose.y, z=0.0), orientation=turned
    )


def _odometry(number: int, stamp: int, scan: LoggedScan) -> "Msg":
    none = TYPES["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    still = TYPES["geometry_msgs/msg/Twist"](linear=none, angular=none)
    unknown = np.zeros(36)
    return TYPES["nav_msgs/msg/Odometry"](
        header=_header(number, stamp, "odom"),
        child_frame_id="base_link",
        pose=TYPES["geometry_msgs/msg/PoseWithCovariance"](pose=_pose(scan.laser_in_odom), covariance=unknown),
        twist=TYPES["geometry_msgs/msg/TwistWithCovariance"](twist=still, covariance=unknown),
    )


@dataclass(frozen=True, slots=True)
class Measured:
    """Distances between the localizer's poses and the mapping program's poses.

    Attributes:
        errors: (n,) distance at each update, meters.
        lost: (n,) flag of each update, 1 if the localizer reported that it is lost, otherwise 0.
        updates: updates, each with the reported probability that the pose is wrong, and True if the pose is wrong.
    """

    errors: FloatArray
    lost: FloatArray
    updates: list[UpdateRow]

    def text(self) -> str:
        """Return the cells of a row."""
        wrong = (self.errors > 1.0) & (self.lost == 0.0)
        found = np.flatnonzero((self.lost == 0.0) & (self.errors < 0.5))
        begin = 0 if not len(found) else int(found[0])
        after = self.errors[begin:]
        return (
            f"{len(self.errors)} | {begin} | {100 * after.mean():.1f} | {100 * np.percentile(after, 95):.1f} "
            f"| {100 * after.max():.0f} | {self.lost.mean():.3f} | {wrong.mean():.3f}"
        )


def localized(bag: Path, place: Path, scans: list[LoggedScan], folder: Path, *, known: bool) -> Measured:
    """Localize a bag with `thbridge localize`, with a known or an unknown start pose."""
    name = "start" if known else "anywhere"
    start = scans[0].laser_in_map
    begin = ["--initial-pose", f"{start.x}", f"{start.y}", f"{start.theta}"] if known else ["--global"]
    begin += ["--laser-pose", "0", "0", "0"]
    updates, picture = folder / f"{name}.csv", folder / f"{name}.png"
    command = [sys.executable, "-c", "from ui.cli import main; main()", "localize", str(bag), "--map", str(place)]
    outputs = ["--updates", str(updates), "--plot", str(picture), "--out", str(folder / f"{name}.tum")]
    done = subprocess.run([*command, *begin, *outputs], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{bag}: {done.stderr}")
    at = {round(1e3 * (1.0 + scan.seconds)): scan.laser_in_map for scan in scans}
    errors, lost, rows = [], [], []
    with updates.open() as file:
        for row in csv.DictReader(file):
            truth = at[round(1e3 * float(row["stamp"]))]
            errors.append(math.hypot(float(row["x"]) - truth.x, float(row["y"]) - truth.y))
            lost.append(row["lost"].lower() in ("true", "1"))
            wrong = is_wrong(Pose2(float(row["x"]), float(row["y"]), float(row["yaw"])), truth)
            rows.append(UpdateRow("amcl", name, bag.parent.name, (), float(row["p_wrong"]), wrong, lost[-1]))
    return Measured(np.array(errors), np.array(lost, dtype=np.float64), rows)


def main() -> None:
    """Measure all logs of a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("logs", type=Path, help="folder of *-corrected.log.gz")
    parser.add_argument("--to", type=Path, required=True, help="folder for maps, bags and pictures")
    parser.add_argument("--only", default="", help="use only logs with this text in their name")
    given = parser.parse_args()
    print(
        "| log | distance, m | start | updates | found at update | mean error, cm | 95 %, cm | largest, cm | lost "
        "| wrong, not lost |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    runs = []
    for log in sorted(given.logs.glob("*.log.gz")):
        name = log.name.removesuffix(".log.gz").removesuffix("-corrected")
        if given.only not in name:
            continue
        scans = scans_of(log)
        way = sum(a.laser_in_map.distance(b.laser_in_map) for a, b in pairwise(scans))
        if sum(a.laser_in_odom.distance(b.laser_in_odom) for a, b in pairwise(scans)) < 0.5 * way:
            print(f"| {name} | {way:.0f} | no odometry |", flush=True)
            continue
        folder = given.to / name
        folder.mkdir(parents=True, exist_ok=True)
        place = draw_map(scans[1::2], folder)
        bag = folder / "scans.bag"
        bag.unlink(missing_ok=True)
        write_bag(scans, bag)
        for known in (True, False):
            measured = localized(bag, place, scans, folder, known=known)
            print(f"| {name} | {way:.0f} | {'start' if known else 'anywhere'} | {measured.text()} |", flush=True)
            runs.append(measured.updates)
    print("", HEAD, *calibration(runs), sep="\n")


if __name__ == "__main__":
    main()

"""Bags as folders of tables, as pyarrow (and with it pandas) reads them."""

import csv
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv as arrow_csv
from pyarrow import parquet
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.support.bags import foreign_bags
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.analysis.export import exporting
from thbridge.analysis.export.folder import export_bag
from thbridge.files.errors import BadFile
from thbridge.files.ros.definitions import Definitions
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages.pack import RoomLabel
from thbridge.ros.publisher import TeamPublisher

TICKS = 120
BOTH = tuple(TableFormat)


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A session of two robots, drawn by hand."""
    path = tmp_path_factory.mktemp("bags") / "hunt.bag"
    rooms = (RoomLabel(1, "Küche", 1.0, 2.0), RoomLabel(2, "Room 2", 3.0, 2.0))
    publisher = TeamPublisher(2, MOUNT, SCAN_PERIOD, rooms=rooms)
    with BagWriter(path, Definitions(())) as writer:
        for message in publisher.opening(0, SESSION, arena()):
            writer.write(message)
        for snapshot in snapshots(2, TICKS):
            for message in publisher.tick(snapshot, records(snapshot.tick)):
                writer.write(message)
    return path


@pytest.fixture(scope="module")
def folder(bag: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tables") / "out"
    export_bag(bag, folder, BOTH)
    return folder


def table(folder: Path, name: str) -> pa.Table:
    return parquet.read_table(folder / f"{name}.parquet")


def dictionary(folder: Path) -> dict[tuple[str, str], dict[str, str]]:
    with (folder / "dictionary.csv").open(encoding="utf-8", newline="") as file:
        return {(row["table"], row["column"]): row for row in csv.DictReader(file)}


@pytest.mark.parametrize("topics", [None, {"/hunt/events", "/dialogue/utterances"}])
def test_the_name_of_a_room_stands_beside_its_number(bag: Path, tmp_path: Path, topics: set[str] | None) -> None:
    export_bag(bag, tmp_path / "out", BOTH, topics)
    for name in ("hunt_events", "dialogue_utterances"):
        rows = table(tmp_path / "out", name)
        assert rows.column_names.index("room_name") == rows.column_names.index("room") + 1
        named = set(zip(rows["room"].to_pylist(), rows["room_name"].to_pylist(), strict=True))
        assert named >= {(1, "Küche"), (2, "")}
        assert all(not name for room, name in named if room != 1)
        assert "name of the room" in dictionary(tmp_path / "out")[name, "room_name"]["meaning"]


def test_a_row_a_message_with_both_times(folder: Path) -> None:
    odometry = table(folder, "robot1_odom")
    assert odometry.num_rows == TICKS
    assert odometry["t_s"].to_pylist() == pytest.approx(np.arange(TICKS) / 50)
    assert odometry["stamp_ns"].to_pylist() == odometry["recorded_ns"].to_pylist()
    assert odometry["child_frame_id"][0].as_py() == "robot1/base_footprint"


def test_scans_are_lists_and_clouds_long_tables(folder: Path) -> None:
    ranges = table(folder, "robot1_scan")["ranges_m"]
    assert {len(each) for each in ranges.to_pylist()} == {MOUNT.beams}
    assert ranges[0].as_py()[3] == np.inf
    clouds, particles = table(folder, "robot1_particlecloud"), table(folder, "robot1_particlecloud.poses")
    assert particles.num_rows == 300 * clouds.num_rows
    assert particles["row"].to_pylist() == np.repeat(np.arange(clouds.num_rows), 300).tolist()
    assert particles["index"].to_pylist()[298:302] == [298, 299, 0, 1]
    assert "yaw_rad" in particles.column_names


def test_a_message_that_is_but_one_array_gives_the_elements(folder: Path) -> None:
    frames = table(folder, "tf")
    assert frames.num_rows == 4 * TICKS
    assert frames["child_frame_id"].to_pylist()[:2] == ["robot1/odom", "robot1/base_footprint"]
    assert frames["row"].to_pylist()[3:5] == [0, 1]


def test_the_json_of_events_is_in_columns(folder: Path) -> None:
    events = table(folder, "hunt_events").to_pylist()
    identified = next(event for event in events if event["kind"] == "identified")
    told = json.loads(identified["json"])
    assert (identified["event_points"], identified["event_name"]) == (told["points"], told["name"])
    assert np.isnan(next(event for event in events if event["kind"] == "arrived")["event_points"])


def test_csv_says_the_same(folder: Path) -> None:
    odometry = arrow_csv.read_csv(folder / "robot1_odom.csv")
    assert odometry["x_m"].to_pylist() == table(folder, "robot1_odom")["x_m"].to_pylist()
    scan = arrow_csv.read_csv(folder / "robot1_scan.csv")["ranges_m"][0].as_py()
    said = table(folder, "robot1_scan")["ranges_m"][0].as_py()
    assert np.array(scan.split(), dtype=np.float32) == pytest.approx(np.array(said, dtype=np.float32), nan_ok=True)


def test_the_dictionary_has_every_column_of_every_table_with_unit_and_frame(folder: Path) -> None:
    told = dictionary(folder)
    for path in folder.glob("*.parquet"):
        for column in parquet.read_schema(path):
            row = told.pop((path.stem, column.name))
            assert row["unit"] == (column.metadata or {}).get(b"unit", b"").decode()
            assert row["meaning"] and not row["meaning"].startswith(":"), row
    assert not told
    told = dictionary(folder)
    assert told["robot2_odom", "x_m"]["frame"] == "robot2/odom"
    assert told["robot2_odom", "linear_x_m_s"]["frame"] == "robot2/base_footprint"
    assert told["robot1_particlecloud.poses", "x_m"]["frame"] == "map"
    assert told["tf", "x_m"]["frame"] == "see frame_id" or " or " in told["tf", "x_m"]["frame"]


def test_the_session_and_a_readme_go_with_it(folder: Path) -> None:
    told = json.loads((folder / "session.json").read_text(encoding="utf-8"))
    assert (told["seed"], told["study"], told["versions"]) == (SESSION.seed, SESSION.study, SESSION.versions)
    assert (told["program"], told["participant"]) == (SESSION.program, SESSION.participant)
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert f"| `robot1_odom` | /robot1/odom | nav_msgs/Odometry | {TICKS} |" in readme


def test_the_same_bag_gives_the_same_bytes(bag: Path, folder: Path, tmp_path: Path) -> None:
    export_bag(bag, tmp_path / "again", BOTH)
    files = sorted(path.name for path in folder.iterdir())
    assert files == sorted(path.name for path in (tmp_path / "again").iterdir())
    assert all((folder / name).read_bytes() == (tmp_path / "again" / name).read_bytes() for name in files)


def test_pieces_join_without_a_seam(bag: Path, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However little is held in memory, the tables are the same; so are those of a recording's parts."""
    monkeypatch.setattr(exporting, "PIECE", 2000)
    export_bag(bag, tmp_path / "small", (TableFormat.PARQUET,))
    for path in folder.glob("*.parquet"):
        # As text, where NaN equals NaN.
        assert str(table(tmp_path / "small", path.stem).to_pydict()) == str(table(folder, path.stem).to_pydict())
    assert parquet.ParquetFile(tmp_path / "small" / "robot1_odom.parquet").num_row_groups > 10


def test_few_files_are_open_however_many_tables_there_are(bag: Path, folder: Path, tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    # A bag, a table, two temporary files, and what libraries want beside; files of other tests may lie in between.
    free = [os.dup(0) for _ in range(8)]
    for number in free:
        os.close(number)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(free) + 1, hard))
    try:
        export_bag(bag, tmp_path / "few", BOTH)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert len([*folder.iterdir()]) > 60
    assert all((folder / path.name).read_bytes() == path.read_bytes() for path in (tmp_path / "few").iterdir())


LOOK = """
import sys
from pathlib import Path
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report_page.page import build_report
from thbridge.files.tables.table_files import TableFormat
bag = Path(sys.argv[1])
export_bag(bag, bag.with_suffix(""), tuple(TableFormat))
build_report(bag)
print(*{"numba", "pandas", "scipy"} & sys.modules.keys())
"""


def test_tables_and_reports_need_no_compiler(bag: Path, tmp_path: Path) -> None:
    copy = shutil.copy(bag, tmp_path)
    done = subprocess.run([sys.executable, "-c", LOOK, copy], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_a_choice_of_topics_and_time(bag: Path, tmp_path: Path) -> None:
    export_bag(bag, tmp_path, (TableFormat.CSV,), {"/robot1/odom"}, start=0.5, until=1.0)
    assert sorted(path.name for path in tmp_path.glob("*.csv")) == ["dictionary.csv", "poses.csv", "robot1_odom.csv"]
    times = arrow_csv.read_csv(tmp_path / "robot1_odom.csv")["t_s"].to_pylist()
    assert (min(times), max(times)) == (0.5, 1.0)
    told = json.loads((tmp_path / "session.json").read_text(encoding="utf-8"))
    assert (told["seed"], told["study"]) == (SESSION.seed, SESSION.study), "whatever is chosen"


def test_a_choice_of_tables_with_what_belongs_to_them(bag: Path, tmp_path: Path) -> None:
    exported = export_bag(bag, tmp_path, (TableFormat.CSV,), tables={"poses", "robot1_particlecloud"})
    names = {"poses", "robot1_particlecloud", "robot1_particlecloud.poses"}
    assert {path.stem for path in tmp_path.glob("*.csv")} == {*names, "dictionary"}
    assert exported.tables.keys() == names


@pytest.mark.parametrize("compression", [None, Writer.CompressionFormat.LZ4, Writer.CompressionFormat.BZ2])
def test_bags_of_other_robots(tmp_path: Path, compression: Writer.CompressionFormat | None) -> None:
    foreign_bags.write(tmp_path / "a.bag", foreign_bags.Robot(compression=compression), seconds=1.0)
    exported = export_bag(tmp_path / "a.bag", tmp_path / "out", BOTH)
    assert set(exported.tables) == {"scan", "odom", "tf", "tf_static", "poses"}
    assert table(tmp_path / "out", "scan").num_rows == 11
    assert json.loads((tmp_path / "out" / "session.json").read_text())["seed"] is None


def test_types_that_nobody_knows_and_parts_of_a_recording(tmp_path: Path) -> None:
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg("float64 level\nstring mood", "far_away/msg/Soil"))
    parts = [tmp_path / "run_0.bag", tmp_path / "run_1.bag"]
    for number, part in enumerate(parts):
        with Writer(part) as writer:
            soil = writer.add_connection("/soil", "far_away/msg/Soil", typestore=store)
            for second in range(3):
                message = store.types["far_away/msg/Soil"](0.5 * second, "dry, mostly")
                data = store.serialize_ros1(message, "far_away/msg/Soil")
                writer.write(soil, (3 * number + second + 1) * 1_000_000_000, data)
            if number == 1:
                writer.write(soil, 9_000_000_000, b"\1")
    exported = export_bag(tmp_path / "run.bag", tmp_path / "out", BOTH)
    soil_table = table(tmp_path / "out", "soil")
    assert soil_table["t_s"].to_pylist() == [0, 1, 2, 3, 4, 5]
    assert soil_table["mood"].to_pylist() == ["dry, mostly"] * 6
    assert exported.notices == ["1 messages of /soil: the message ends too early."]
    assert dictionary(tmp_path / "out")["soil", "level"]["meaning"] == ""


def test_a_folder_that_holds_something_is_left_alone(bag: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(BadFile, match="this folder is not empty"):
        export_bag(bag, tmp_path, BOTH)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_all_robots_poses_are_in_one_table(folder: Path) -> None:
    poses = table(folder, "poses").to_pydict()
    assert poses["robot"] == ["robot1"] * TICKS + ["robot2"] * TICKS
    second = slice(TICKS, 2 * TICKS)
    truth, odometry = table(folder, "robot2_base_pose_ground_truth"), table(folder, "robot2_odom")
    assert poses["t_s"][second] == odometry["t_s"].to_pylist()
    assert poses["true_x_m"][second] == pytest.approx(truth["x_m"].to_pylist())
    assert poses["odometry_yaw_rad"][second] == pytest.approx(odometry["yaw_rad"].to_pylist())
    # The drawn team believes itself 3 cm ahead, up to 4 cm aside, and turned by 0.02 rad.
    aside = 0.04 * np.sin(np.arange(TICKS) / 100 + 1)
    assert poses["error_m"][second] == pytest.approx(np.hypot(0.03, aside), abs=1e-4)
    assert poses["error_yaw_rad"] == pytest.approx([0.02] * 2 * TICKS, abs=1e-6)

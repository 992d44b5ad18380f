"""A recording whose odometry is a kilometer off once: report, figure and table are of the way that was driven."""

from pathlib import Path

import pandas as pd
import pytest

from tests.support.bags.foreign_bags import Robot, write
from tests.support.programs.commands import invoke
from thbridge.analysis.plot.figures import draw
from thbridge.analysis.plot.kinds import FigureKind
from thbridge.analysis.plot.style import TWO_COLUMNS
from thbridge.analysis.report.builder import read_report
from thbridge.hunt.refusals import RequestRefused
from thbridge.recording.bag.reading.reader import messages

TOPICS = {"/odom": "/odom", None: "tf odom -> base_footprint"}


@pytest.fixture(scope="module", params=TOPICS)
def spiked(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A bag, and the sentence on what is left out of it."""
    bag = tmp_path_factory.mktemp("spiked") / "a.bag"
    write(bag, Robot(odom_topic=request.param, spikes={20: 1000.0, 61: -30.0}), seconds=6.0)
    why = "messages left out as outliers, because the robot cannot have driven there"
    told = f"{why}: 2 (after 1.00 s, by 1000.0 m and 0.00 rad;"
    return bag, f"{TOPICS[request.param]}: {told}"


def done(*arguments: object) -> str:
    finished = invoke(*arguments)
    assert finished.exit_code == 0, finished.output
    return " ".join(finished.output.split())


def test_the_report_leaves_them_out_and_says_so(spiked: tuple[Path, str], tmp_path: Path) -> None:
    bag, sentence = spiked
    done("report", bag, "--to", tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert sentence in page.replace("&gt;", ">")
    (track,) = read_report(messages(bag)).tracks
    assert 2.0 < track.distance < 4.0


def test_the_axes_of_a_figure_span_the_way_that_was_driven(spiked: tuple[Path, str], tmp_path: Path) -> None:
    bag, sentence = spiked
    assert sentence in done("bag", "plot", bag, "--what", "paths", "--to", tmp_path / "paths.svg")
    figure = draw(FigureKind.PATHS, read_report(messages(bag)), TWO_COLUMNS)
    assert not isinstance(figure, RequestRefused)
    (axes,) = figure.axes
    for low, high in (axes.get_xlim(), axes.get_ylim()):
        assert 0.0 < high - low < 10.0


def test_the_table_of_poses_leaves_them_out_and_the_command_says_so(spiked: tuple[Path, str], tmp_path: Path) -> None:
    bag, sentence = spiked
    assert f"poses: {sentence}" in done("bag", "export", bag, "--to", tmp_path, "--format", "csv")
    poses = pd.read_csv(tmp_path / "poses.csv")
    assert len(poses) == 119
    assert poses["odometry_x_m"].between(2.0, 6.0).all()

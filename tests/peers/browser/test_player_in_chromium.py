"""The player's page, opened from disk in Debian's Chromium, shows what the recording has; axe-core judges it."""

from pathlib import Path

import numpy as np
import pytest

from tests.support.hunts.recorded_hunts import record_beginning
from tests.support.programs.selenium_scripts import NEEDS_SELENIUM, seen_in_chromium
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import Report
from thbridge.files.ros.definitions import Definitions
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.messages import pack, types
from thbridge.ros.messages.session_records import UtteranceRecord
from thbridge.ros.names import UTTERANCES
from thbridge.ros.publisher import RosMessage, Topic
from ui.web.player.page import build_player

pytestmark = NEEDS_SELENIUM


HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The beginning of a hunt; at its end, a robot says a text that would run scripts as HTML."""
    folder = tmp_path_factory.mktemp("player")
    recorded = [*messages(record_beginning(folder / "recorded.bag", 2, 16.0))]
    said = UtteranceRecord(99, "robot", 0, 1, "select-room", HOSTILE, "claim", "robot")
    with BagWriter(folder / "hunt <img src=x onerror=alert(3)>.bag", Definitions(())) as writer:
        for message in recorded:
            writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, message.data))
        last = recorded[-1].stamp_ns
        writer.write(RosMessage(Topic(UTTERANCES, types.UTTERANCE), last, pack.utterance(0, said)))
    return folder / "hunt <img src=x onerror=alert(3)>.bag"


@pytest.fixture(scope="module")
def report(bag: Path) -> Report:
    return read_report(messages(bag))


@pytest.mark.parametrize(
    ("how", "width", "height", "scheme"),
    [
        ("mouse", 1440, 900, "light"),
        ("touch", 390, 844, "dark"),
        pytest.param("mouse", 1024, 768, "dark", marks=pytest.mark.slow),
        pytest.param("touch", 360, 740, "light", marks=pytest.mark.slow),
    ],
)
def test_a_person_looks_at_a_recording(
    how: str, width: int, height: int, scheme: str, bag: Path, report: Report, tmp_path: Path
) -> None:
    page = tmp_path / "hunt-player.html"
    page.write_text(build_player(bag), encoding="utf-8")
    program = Path(__file__).with_name("player_in_chromium.py")
    result = seen_in_chromium(program, page, how, width, height, scheme, tmp_path, timeout=200)
    assert result["errors"] == []
    assert result["faults"] == []
    steps = result["steps"]
    assert steps["start"]["at"] == 0.0
    assert steps["start"]["robots"] != steps["five seconds"]["robots"]
    assert steps["five seconds"]["at"] == pytest.approx(5.0)
    assert steps["middle"]["at"] == pytest.approx(report.duration / 2.0, rel=0.02)
    assert steps["next event"]["at"] > steps["middle"]["at"]
    assert steps["end"]["at"] == pytest.approx(report.duration, abs=0.02)
    assert steps["last entry"]["active"] == [steps["end"]["active"][0]]
    for name in ("five seconds", "middle", "next event", "end"):
        _assert_values_of(report, steps[name])
    zoomed, whole = steps["zoomed"], steps["whole again"]
    assert zoomed["duration"] - zoomed["from"] == pytest.approx(report.duration / 2.0, abs=0.02)
    assert zoomed["at"] == whole["at"], "the time axis does not move the playback"
    assert zoomed["ticks"] != whole["ticks"] == steps["start"]["ticks"]
    assert zoomed["plots"] == whole["plots"]
    assert (whole["from"], whole["duration"]) == (0.0, steps["start"]["duration"])
    # A script that ran would have opened a dialog, and the rest of the steps would have failed.
    assert steps["end"]["active"] == [f"Robot 1{HOSTILE}"]
    assert not any(step["wider"] for step in steps.values())


def _assert_values_of(report: Report, shown: dict[str, object]) -> None:
    """Check that a step of the page shows the recorded poses and values at its time."""
    at = shown["at"]
    assert isinstance(at, int | float)
    robots, plots = shown["robots"], shown["plots"]
    assert isinstance(robots, list)
    assert isinstance(plots, dict)
    for index, track in enumerate(report.tracks):
        x, y, *_ = robots[index]
        for value, column in ((x, 1), (y, 2)):
            assert value / 100.0 == pytest.approx(np.interp(at, track.truth[:, 0], track.truth[:, column]), abs=0.03)
        left = track.energy[track.energy[:, 0] <= at, 1][-1]
        assert float(plots["Energy"][index]) == pytest.approx(left, abs=0.06)
        nearby = np.abs(track.errors[:, 0] - at) < 0.05
        error = 100.0 * track.errors[nearby, 1]
        assert error.min() - 0.35 < float(plots["Position error"][index]) < error.max() + 0.35
    score = [record.score for time, record in report.scores if time <= at + 0.005][-1]
    assert plots["Score"] == [str(score)]

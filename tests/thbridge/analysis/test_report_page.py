import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from tests.thbridge.analysis.reported_drive import session
from thbridge.analysis.report.report import Report, WayMade
from thbridge.analysis.report_page.page import build_report, render
from thbridge.app.session.broadcast import Broadcast
from thbridge.files.errors import BadFile
from thbridge.files.ros.definitions import Definitions
from thbridge.hunt.rooms import RoomNames
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.publisher import RosMessage, TeamPublisher, Topic
from ui.model.shared.theme import LIGHT


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "a <b>.bag"
    with BagWriter(path, Definitions(())) as writer:
        recorder = Broadcast(TeamPublisher(2, MOUNT, SCAN_PERIOD), SESSION, arena(), [writer])
        for snapshot in snapshots(2, 300):
            recorder.record(snapshot, records(snapshot.tick))
    return path


@pytest.fixture(scope="module")
def page(bag: Path) -> str:
    return build_report(bag)


@pytest.fixture(scope="module")
def report() -> Report:
    return session(2, 400)


class Outside(HTMLParser):
    """Collects whatever a page would load from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.loads: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.loads += [
            value
            for name, value in attrs
            if name in ("src", "href", "xlink:href") and value and not value.startswith(("#", "data:"))
        ]
        if tag in ("script", "link", "iframe"):
            self.loads.append(tag)


def test_the_page_needs_nothing_but_itself(page: str) -> None:
    outside = Outside()
    outside.feed(page)
    assert outside.loads == []
    assert "@import" not in page


def test_every_figure_is_there_and_well_formed(page: str) -> None:
    drawn = re.findall(r"<svg.*?</svg>", page, re.DOTALL)
    titles = re.findall(r"<h2>(.*?)</h2>", page)
    assert titles == ["Robots", "Score", "Paths", "Localization error", "Energy", "Timeline", "Event log"]
    assert len(drawn) == 4
    for svg in drawn:
        ElementTree.fromstring(svg)


def test_the_page_begins_with_name_and_seed_and_versions_come_at_its_end(page: str) -> None:
    header, _, rest = page.partition("</header>")
    begins, _, _ = rest.rpartition("Versions and processor")
    for program, version in SESSION.versions.items():
        assert version not in header
        assert f"<li>{program}: {version}</li>" in page.removeprefix(header + "</header>" + begins)


def test_a_robot_has_its_color_of_the_windows(page: str) -> None:
    assert re.findall(r'class="dot" style="background: (#\w+)"', page) == list(LIGHT.robots[:2])


def test_names_within_the_figures_do_not_clash(page: str) -> None:
    named: dict[str, str] = {}
    for svg in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        for element in re.findall(r'<(?:clipPath|path|image) id="([^"]+)"', svg):
            assert named.setdefault(element, svg) is svg


def test_words_of_people_are_text_and_nothing_else(page: str) -> None:
    assert "Blue &lt;Bottle&gt;" in page
    assert "a &lt;b&gt;.bag" in page
    assert "Müller&#39;s £ study" in page


def test_the_same_bag_gives_the_same_page(bag: Path, page: str) -> None:
    assert build_report(bag) == page


def test_the_name_of_a_room_stands_beside_its_number(report: Report) -> None:
    page = render([replace(report, rooms=RoomNames.of([(1, "Kitchen <old>"), (2, "Room 2")]))], "a.bag")
    assert page.count("<td>1 (Kitchen &lt;old&gt;)</td>") > 1
    assert "<td>2</td>" in page


def test_the_page_tells_who_made_way_for_whom_when_and_how_long(report: Report) -> None:
    first, second = report.tracks
    made = (WayMade(61.0, 73.5, "robot2"), WayMade(80.0, 81.0, "robot2"))
    page = render([replace(report, tracks=(replace(first, ways_made=made), second))], "a.bag")
    plain = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    assert "1:01 1:13 robot 1 robot 2 12.5 1:20 1:21 robot 1 robot 2 1.0" in plain
    assert "Making way, s robot 1" in plain
    assert re.search(r"robot 1 .* 13\.5 robot 2 ", plain)


def test_a_foreign_bag_says_what_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "foreign.bag"
    with BagWriter(path, Definitions(())) as writer:
        writer.write(RosMessage(Topic("/chatter", "std_msgs/String"), 1, b"\x02\x00\x00\x00hi"))
    page = build_report(path)
    assert "Missing in this bag" in page
    assert "No map:" in page
    assert "<svg" not in page


def test_a_damaged_bag_is_refused(tmp_path: Path, bag: Path) -> None:
    path = tmp_path / "cut.bag"
    path.write_bytes(bag.read_bytes()[:-100])
    with pytest.raises(BadFile, match="reindex"):
        build_report(path)

"""Measure the size of recordings of waiting teams and of teams in a hunt, by topic, uncompressed and compressed.

Run this script from the project's folder: `.venv/bin/python scripts/measure_recordings.py`. It prints Markdown tables.
Each session is recorded in two bags: complete and uncompressed, and with the defaults of studies. The size of a topic
in a compressed bag is the size of a bag that contains only this topic.
"""

import argparse
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.common.observations import TICKS_PER_SECOND
from thbridge.analysis.cut import CutRange, cut
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session
from thbridge.recording.bag.options import Compression, RecordingDetail
from thbridge.recording.bag.reading.reader import info
from thbridge.roles.participant.tabui import TabUI
from thbridge.study.study_file import RecordingSection, Study
from thbridge.text_protocol.wire import legacy

WHOLE = RecordingSection(compression=Compression.NONE, detail=RecordingDetail.ALL)
SHOWN = 12
"""Number of topics in a table; the largest topics come first."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """Two bags of a session: complete and uncompressed, and with the defaults."""

    whole: Path
    default: Path


def record(folder: Path, study: Study, seconds: float, busy: bool) -> Recorded:
    """Record a session. If the team is busy, a simulated participant sends its robots through the rooms."""
    setting = read_setting(study, Path())
    players = [TabUI(build_bot(setting.templates, study.participant.strategy, study.seed))] if busy else []
    bags = Recorded(folder / f"whole-{study.robots}-{busy}.bag", folder / f"default-{study.robots}-{busy}.bag")
    plain = replace(setting, study=replace(study, recording=WHOLE))
    with build_writer(plain, bags.whole) as whole, build_writer(setting, bags.default) as default:
        opening = build_record(setting, PLAY, [legacy.SIMR, legacy.HIDER], "")
        said = Broadcast(build_publisher(setting), opening, setting.map.grid, [whole, default])
        roles = [build_simr(setting), build_hider(setting.templates, study.seed)]
        session = Session(build_keeper(setting), roles, [BagRecorder(said)], players)
        for _ in range(round(seconds * TICKS_PER_SECOND)):
            session.step()
    return bags


def by_topic(bags: Recorded, folder: Path) -> list[tuple[str, int, int]]:
    """Return the topics, each for all robots together, with its sizes in bytes: uncompressed, and with the defaults."""
    of_all: defaultdict[str, list[str]] = defaultdict(list)
    for topic in info(bags.whole).topics:
        head, _, rest = topic.name.removeprefix("/").partition("/")
        of_all[f"/robotN/{rest}" if head.startswith("robot") else topic.name].append(topic.name)
    found = []
    for name, topics in of_all.items():
        sizes = []
        for bag, compression in ((bags.whole, Compression.NONE), (bags.default, Compression.LZ4)):
            part = cut(
                bag, CutRange(topics=tuple(topics), compression=compression), folder / "part.bag", overwrite=True
            )
            sizes.append(part.path.stat().st_size)
        found.append((name, sizes[0], sizes[1]))
    return sorted(found, key=lambda topic: -topic[1])


def show(team_sizes: Sequence[int], map_name: str, seconds: float, shown_team: int) -> None:
    """Print the tables."""
    tables = []
    print("| robots | | complete, uncompressed | defaults | share |\n|---|---|---|---|---|")
    with TemporaryDirectory() as name:
        folder = Path(name)
        for robots in team_sizes:
            for busy in (False, True):
                bags = record(folder, replace(Study(), robots=robots, map=map_name), seconds, busy)
                whole, default = (bag.stat().st_size for bag in (bags.whole, bags.default))
                what = "in a hunt" if busy else "waiting"
                rates = f"{whole / seconds / 1e3:.0f} kB/s | {default / seconds / 1e3:.0f} kB/s"
                print(f"| {robots} | {what} | {rates} | {default / whole:.0%} |", flush=True)
                if robots == shown_team:
                    tables.append(by_topic(bags, folder))
    print(f"\n| {shown_team} robots, kB/s | waiting, complete | defaults | in a hunt, complete | defaults |")
    print("|---|---|---|---|---|")
    waiting, hunting = ({topic: sizes for topic, *sizes in table} for table in tables)
    for topic in list(hunting)[:SHOWN]:
        sizes = [*waiting.get(topic, (0, 0)), *hunting[topic]]
        print(f"| `{topic}` | " + " | ".join(f"{size / seconds / 1e3:.1f}" for size in sizes) + " |")


def main() -> None:
    """Read the arguments, and measure."""
    parser = argparse.ArgumentParser(description="Measure the size of recordings, by topic.")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 3, 10], help="team sizes")
    parser.add_argument("--map", default="arena8")
    parser.add_argument("--seconds", type=float, default=60.0, help="simulated time of each recording, seconds")
    parser.add_argument("--topics-of", type=int, default=3, help="size of the team whose topics are listed")
    chosen = parser.parse_args()
    show(chosen.robots, chosen.map, chosen.seconds, chosen.topics_of)


if __name__ == "__main__":
    main()

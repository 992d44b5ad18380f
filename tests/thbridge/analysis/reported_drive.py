"""Reports on a team that was drawn by hand."""

from dataclasses import dataclass

from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, SESSION, arena, records, snapshots
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import Report
from thbridge.ros.messages.types import plain_definition
from thbridge.ros.publisher import TeamPublisher


@dataclass(frozen=True)
class Recorded:
    topic: str
    msgtype: str
    stamp_ns: int
    data: bytes
    md5: str = ""


def recorded(topic: str, msgtype: str, second: float, data: bytes) -> Recorded:
    return Recorded(topic, msgtype, round(second * 1e9), data, plain_definition(msgtype).md5)


def session(robots: int, ticks: int) -> Report:
    publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
    messages = publisher.opening(0, SESSION, arena())
    for snapshot in snapshots(robots, ticks):
        messages += publisher.tick(snapshot, records(snapshot.tick))
    return read_report(recorded(m.topic.name, m.topic.msgtype, m.stamp_ns / 1e9, m.data) for m in messages)

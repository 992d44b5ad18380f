"""`thbridge bag`: look into recordings and mend them."""

import math
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from thbridge.analysis.check import BagTool, Finding, FindingSeverity, Judgement, judge
from thbridge.analysis.cut import CutRange, cut
from thbridge.analysis.summary import RecordingSummary, summarise
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.repair import reindex as reindex_bag
from thbridge.recording.bag.scan import scan
from thbridge.recording.recordings import parts_of
from ui.options import AsJson
from ui.terminal import FAILED, bad_input, out, print_json

bag_app = typer.Typer(help="Look into recordings and mend them.", no_args_is_help=True)


Bag = Annotated[Path, typer.Argument(help="A ROS 1 bag, or the name of a split one.")]
Out = Annotated[Path | None, typer.Option("--to", help="The new file; by default beside the bag.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace a file of that name.")]


class Packing(StrEnum):
    """Compression of chunks in an MCAP file."""

    ZSTD = "zstd"
    LZ4 = "lz4"
    NONE = "none"


@bag_app.command("info")
def bag_info_command(bag: Bag, as_json: AsJson = False) -> None:
    """Say what is in a bag: topics, types, rates, gaps, and the session if it is ours."""
    with bad_input():
        found = summarise(bag)
    if as_json:
        print_json(msgspec.to_builtins(found, enc_hook=str))
    else:
        _show_summary(found)


def _show_summary(found: RecordingSummary) -> None:
    files = f" in {len(found.parts)} files" if len(found.parts) > 1 else ""
    _say(f"{found.path}: {found.duration:.1f} s, {found.messages} messages, {found.size / 1e6:.1f} MB{files}")
    _say(f"compression: {found.compression}")
    if found.session is not None:
        versions = ", ".join(f"{name} {version}" for name, version in found.session.versions.items())
        _say(f"a session of ours, seed {found.session.seed}: {versions}")
    rows = [("topic", "messages", "Hz", "from", "to", "", "type", "md5", "published by")]
    for topic in found.topics:
        rate = "" if topic.hertz is None else f"{topic.hertz:.1f}"
        latched = "latched" if topic.latched else ""
        times = (_seconds(topic.start_ns, found.start_ns), _seconds(topic.end_ns, found.start_ns))
        callers = ", ".join(topic.callers)
        rows.append((topic.name, str(topic.messages), rate, *times, latched, topic.msgtype, topic.md5, callers))
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        # Names to the left, figures to the right.
        cells = (f"{cell:{'>' if 1 <= column <= 4 else '<'}{widths[column]}}" for column, cell in enumerate(row))
        _say("  ".join(cells).rstrip())
    for topic in found.topics:
        if not topic.latched and topic.gaps:
            longest = topic.gaps[0]
            number = f"{len(topic.gaps)} gap{'s' if len(topic.gaps) > 1 else ''}"
            since = _seconds(longest.start_ns, found.start_ns)
            _say(f"{topic.name}: {number}, the longest {longest.seconds:.1f} s, from {since} s on")


def _say(text: str) -> None:
    """Print a line as it is, for people and for grep."""
    out.print(text, highlight=False, markup=False, soft_wrap=True)


def _seconds(stamp_ns: int | None, start_ns: int | None) -> str:
    """Time of a stamp, in seconds from the recording's beginning."""
    return "" if stamp_ns is None or start_ns is None else f"{(stamp_ns - start_ns) / 1e9:.1f}"


@bag_app.command("check")
def bag_check_command(bag: Bag, as_json: AsJson = False) -> None:
    """Judge a bag: will rosbag, rviz, Foxglove, PlotJuggler and evo take it, and why not."""
    with bad_input():
        judgements = {part: judge(scan(part)) for part in parts_of(bag)}
    if as_json:
        print_json(_told(judgements))
    else:
        _show(judgements)
    if not all(judgement.ok for judgement in judgements.values()):
        raise typer.Exit(FAILED)


_VERDICTS = {
    FindingSeverity.ERROR: "stumbles: see its errors",
    FindingSeverity.WARNING: "takes it, with losses",
    FindingSeverity.NOTE: "takes it",
    None: "takes it",
}


def _verdicts(judgements: Mapping[Path, Judgement]) -> dict[BagTool, FindingSeverity | None]:
    """The worst finding for each tool in any part."""
    worst = {tool: [judgement.worst(tool) for judgement in judgements.values()] for tool in BagTool}
    return {
        tool: next((severity for severity in FindingSeverity if severity in met), None) for tool, met in worst.items()
    }


def _told(judgements: Mapping[Path, Judgement]) -> dict[str, object]:
    findings = [
        {
            "file": str(path),
            "rule": finding.rule,
            "severity": finding.severity,
            "tools": list(finding.tools),
            "topic": finding.topic,
            "what": finding.what,
            "remedy": finding.remedy,
            "first_ns": finding.first_ns,
            "at_seconds": _seconds_in(finding, judgement),
            "messages": finding.count,
        }
        for path, judgement in judgements.items()
        for finding in judgement.findings
    ]
    return {
        "ok": all(judgement.ok for judgement in judgements.values()),
        "messages": sum(judgement.messages for judgement in judgements.values()),
        "tools": {tool: severity or "ok" for tool, severity in _verdicts(judgements).items()},
        "findings": findings,
    }


def _show(judgements: Mapping[Path, Judgement]) -> None:
    for path, judgement in judgements.items():
        if len(judgements) > 1:
            _say(f"{path}:")
        for finding in judgement.findings:
            seconds = _seconds_in(finding, judgement)
            since = "" if seconds is None else f" (first at {seconds:.3f} s{_messages(finding.count)})"
            what = f"{finding.topic or 'the bag'}: {finding.what}{since}"
            remedy = finding.remedy[:1].upper() + finding.remedy[1:]
            _say(f"{finding.severity} for {', '.join(finding.tools)}: {what}. {remedy}. [{finding.rule}]")
    for tool, severity in _verdicts(judgements).items():
        _say(f"{tool:<12}{_VERDICTS[severity]}")


def _messages(count: int) -> str:
    return f"; {count} message{'s' if count > 1 else ''}" if count else ""


def _seconds_in(finding: Finding, judgement: Judgement) -> float | None:
    """Seconds from the bag's beginning to the first message concerned."""
    if finding.first_ns is None or judgement.start_ns is None:
        return None
    return (finding.first_ns - judgement.start_ns) / 1e9


@bag_app.command("reindex")
def bag_reindex_command(
    bag: Annotated[Path, typer.Argument(help="A bag whose writer was killed.")], as_json: AsJson = False
) -> None:
    """Recover a bag that was cut off; the original is kept beside it."""
    with bad_input():
        done = reindex_bag(bag)
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
        return
    _say(f"Recovered {done.messages} messages into {done.path}; the original is {done.backup}.")
    if done.lost_bytes:
        _say(f"{done.lost_bytes} bytes at its end were half written and are lost.")


@bag_app.command("cut")
def bag_cut_command(
    bag: Bag,
    start: Annotated[float, typer.Option("--from", help="Seconds from its beginning.", min=0.0)] = 0.0,
    end: Annotated[float | None, typer.Option("--until", help="Seconds from its beginning; by default all.")] = None,
    topics: Annotated[str | None, typer.Option(help="Names with commas between; by default all.")] = None,
    compression: Annotated[Compression, typer.Option(help="Of the new bag.")] = Compression.NONE,
    new: Out = None,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> None:
    """Cut a piece out of a bag; it begins with what was latched before. Parts become one bag."""
    names = None if topics is None else tuple(name.strip() for name in topics.split(","))
    piece = CutRange(start, math.inf if end is None else end, names, compression)
    with bad_input():
        done = cut(bag, piece, new or bag.with_name(f"{bag.stem}-cut.bag"), overwrite)
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
    else:
        carried = f", {done.carried} of them latched before" if done.carried else ""
        _say(f"Cut {done.messages} messages into {done.path}{carried}.")


@bag_app.command("to-mcap")
def bag_to_mcap_command(
    bag: Bag,
    compression: Annotated[Packing, typer.Option(help="Of the new file.")] = Packing.ZSTD,
    new: Out = None,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> None:
    """Convert a bag to MCAP, for Foxglove."""
    # A tenth of a second of imports that no other command needs.
    from thbridge.analysis.to_mcap import to_mcap  # noqa: PLC0415

    with bad_input():
        done = to_mcap(bag, new or bag.with_suffix(".mcap"), compression, overwrite)
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
    else:
        _say(f"Wrote {done.messages} messages to {done.path}.")

"""`thbridge bag`: look into recordings and mend them."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.table import Table

from thbridge.adapters.bag_reader import info as bag_info
from thbridge.adapters.bag_repair import reindex as reindex_bag
from thbridge.adapters.bag_scan import scan
from thbridge.bags.check import Finding, Judgement, Severity, Tool, judge
from ui.options import AsJson
from ui.terminal import FAILED, bad_input, out, print_json

bag_app = typer.Typer(help="Look into recordings and mend them.", no_args_is_help=True)


@bag_app.command("info")
def bag_info_command(bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")], as_json: AsJson = False) -> None:
    """Say what is in a bag."""
    with bad_input():
        found = bag_info(bag)
    if as_json:
        print_json(msgspec.to_builtins(found, enc_hook=str))
        return
    table = Table("topic", "type", "messages", title=f"{bag}: {found.duration:.1f} s, {found.messages} messages")
    for topic in found.topics:
        table.add_row(topic.name, topic.msgtype, str(topic.messages))
    out.print(table)


@bag_app.command("check")
def bag_check_command(bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")], as_json: AsJson = False) -> None:
    """Judge a bag: will rosbag, rviz, Foxglove, PlotJuggler and evo take it, and why not."""
    with bad_input():
        judgement = judge(scan(bag))
    if as_json:
        print_json(_told(judgement))
    else:
        _show(judgement)
    if not judgement.ok:
        raise typer.Exit(FAILED)


_VERDICTS = {
    Severity.ERROR: "stumbles: see its errors",
    Severity.WARNING: "takes it, with losses",
    Severity.NOTE: "takes it",
    None: "takes it",
}


def _told(judgement: Judgement) -> dict[str, object]:
    findings = [
        {
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
        for finding in judgement.findings
    ]
    tools = {tool: judgement.worst(tool) or "ok" for tool in Tool}
    return {"ok": judgement.ok, "messages": judgement.messages, "tools": tools, "findings": findings}


def _show(judgement: Judgement) -> None:
    for finding in judgement.findings:
        where = finding.topic or "the bag"
        seconds = _seconds_in(finding, judgement)
        since = "" if seconds is None else f" (first at {seconds:.3f} s{_messages(finding.count)})"
        tools = ", ".join(finding.tools)
        remedy = finding.remedy[:1].upper() + finding.remedy[1:]
        text = f"{finding.severity} for {tools}: {where}: {finding.what}{since}. {remedy}. [{finding.rule}]"
        out.print(text, highlight=False, markup=False, soft_wrap=True)
    for tool in Tool:
        out.print(f"{tool:<12}{_VERDICTS[judgement.worst(tool)]}", highlight=False, markup=False)


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
    out.print(f"Recovered {done.messages} messages into {done.path}; the original is {done.backup}.", highlight=False)
    if done.lost_bytes:
        out.print(f"{done.lost_bytes} bytes at its end were half written and are lost.", highlight=False)

"""What `thbridge bag` shows of recordings."""

from collections.abc import Mapping
from pathlib import Path

from thbridge.analysis.check import BagTool, Finding, FindingSeverity, Judgement
from thbridge.analysis.summary import RecordingSummary
from ui.terminal import say


def show_summary(found: RecordingSummary) -> None:
    """Print what is in a bag."""
    files = f" in {len(found.parts)} files" if len(found.parts) > 1 else ""
    say(f"{found.path}: {found.duration:.1f} s, {found.messages} messages, {found.size / 1e6:.1f} MB{files}")
    say(f"compression: {found.compression}")
    if found.session is not None:
        versions = ", ".join(f"{name} {version}" for name, version in found.session.versions.items())
        say(f"a session of ours, seed {found.session.seed}: {versions}")
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
        say("  ".join(cells).rstrip())
    for topic in found.topics:
        if not topic.latched and topic.gaps:
            longest = topic.gaps[0]
            number = f"{len(topic.gaps)} gap{'s' if len(topic.gaps) > 1 else ''}"
            since = _seconds(longest.start_ns, found.start_ns)
            say(f"{topic.name}: {number}, the longest {longest.seconds:.1f} s, from {since} s on")


def _seconds(stamp_ns: int | None, start_ns: int | None) -> str:
    """Time of a stamp, in seconds from the recording's beginning."""
    return "" if stamp_ns is None or start_ns is None else f"{(stamp_ns - start_ns) / 1e9:.1f}"


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


def judgements_as_json(judgements: Mapping[Path, Judgement]) -> dict[str, object]:
    """The judgements of a recording's parts as the JSON object has them."""
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


def show_judgements(judgements: Mapping[Path, Judgement]) -> None:
    """Print the judgements of a recording's parts."""
    for path, judgement in judgements.items():
        if len(judgements) > 1:
            say(f"{path}:")
        for finding in judgement.findings:
            seconds = _seconds_in(finding, judgement)
            since = "" if seconds is None else f" (first at {seconds:.3f} s{_messages(finding.count)})"
            what = f"{finding.topic or 'the bag'}: {finding.what}{since}"
            remedy = finding.remedy[:1].upper() + finding.remedy[1:]
            say(f"{finding.severity} for {', '.join(finding.tools)}: {what}. {remedy}. [{finding.rule}]")
    for tool, severity in _verdicts(judgements).items():
        say(f"{tool:<12}{_VERDICTS[severity]}")


def _messages(count: int) -> str:
    return f"; {count} message{'s' if count > 1 else ''}" if count else ""


def _seconds_in(finding: Finding, judgement: Judgement) -> float | None:
    """Seconds from the bag's beginning to the first message concerned."""
    if finding.first_ns is None or judgement.start_ns is None:
        return None
    return (finding.first_ns - judgement.start_ns) / 1e9

"""Output of `thbridge bag check`."""

from collections.abc import Mapping
from pathlib import Path

from thbridge.analysis.check import NO_TRAJECTORY, BagTool, Finding, FindingSeverity, Judgement
from thbridge.files.errors import visible
from ui.command_line.terminal import say

_VERDICTS = {
    FindingSeverity.ERROR: "has problems with this recording; see the errors",
    FindingSeverity.WARNING: "can read the recording, but not all of its data",
    FindingSeverity.NOTE: "can read the recording",
    None: "can read the recording",
}


def _verdicts(judgements: Mapping[Path, Judgement]) -> dict[BagTool, FindingSeverity | None]:
    """Return for each tool the greatest severity of a finding in all parts of a recording; None without a finding."""
    worst = {tool: [judgement.worst(tool) for judgement in judgements.values()] for tool in BagTool}
    return {
        tool: next((severity for severity in FindingSeverity if severity in met), None) for tool, met in worst.items()
    }


def judgements_as_json(judgements: Mapping[Path, Judgement]) -> dict[str, object]:
    """Return the judgements of a recording's parts as a JSON object."""
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
            what = visible(f"{finding.topic or 'the bag'}: {finding.what}{since}")
            remedy = finding.remedy[:1].upper() + finding.remedy[1:]
            say(f"{finding.severity} for {', '.join(finding.tools)}: {what}. {remedy}. [{finding.rule}]")
    nothing = all(
        any(finding.rule == NO_TRAJECTORY for finding in judgement.findings) for judgement in judgements.values()
    )
    for tool, severity in _verdicts(judgements).items():
        empty_for_it = nothing and tool is BagTool.EVO
        say(f"{tool:<12}{'finds no trajectory in the recording' if empty_for_it else _VERDICTS[severity]}")


def _messages(count: int) -> str:
    return f"; {count} message{'s' if count > 1 else ''}" if count else ""


def _seconds_in(finding: Finding, judgement: Judgement) -> float | None:
    """Return the seconds from the beginning of the bag to the first message concerned."""
    if finding.first_ns is None or judgement.start_ns is None:
        return None
    return (finding.first_ns - judgement.start_ns) / 1e9

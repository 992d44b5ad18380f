"""Output of `thbridge bag info`."""

from thbridge.analysis.bag_summary import RecordingSummary
from thbridge.files.errors import visible
from thbridge.ros.messages.session_records import MACHINE
from ui.command_line.terminal import say

WIDEST = 80
"""Maximum width of a column, in characters. A longer cell shifts only the rest of its row."""


def show_summary(found: RecordingSummary) -> None:
    """Print what a bag contains."""
    files = f" in {len(found.parts)} files" if len(found.parts) > 1 else ""
    say(f"{found.path}: {found.duration:.1f} s, {found.messages} messages, {found.size / 1e6:.1f} MB{files}")
    say(f"compression: {found.compression}")
    if found.session is not None:
        recorded = found.session.versions
        versions = ", ".join(f"{name} {version}" for name, version in recorded.items() if name not in MACHINE)
        say(f"recorded by thbridge, seed {found.session.seed}: {visible(versions)}")
        # The list of processor features is long, and only programs compare it.
        machine = ", ".join(
            f"{name} {recorded[name]}" for name in MACHINE if name in recorded and "features" not in name
        )
        say(f"recorded on: {visible(machine) or 'an unknown machine'}")
    rows = [("topic", "messages", "Hz", "from", "to", "", "type", "md5", "published by")]
    for topic in found.topics:
        rate = "" if topic.hertz is None else f"{topic.hertz:.1f}"
        latched = "latched" if topic.latched else ""
        times = (_seconds(topic.start_ns, found.start_ns), _seconds(topic.end_ns, found.start_ns))
        callers = ", ".join(topic.callers)
        names = (visible(topic.msgtype), visible(topic.md5), visible(callers))
        rows.append((visible(topic.name), str(topic.messages), rate, *times, latched, *names))
    widths = [min(WIDEST, max(len(row[column]) for row in rows)) for column in range(len(rows[0]))]
    for row in rows:
        # Names are aligned left, numbers right.
        cells = (f"{cell:{'>' if 1 <= column <= 4 else '<'}{widths[column]}}" for column, cell in enumerate(row))
        say("  ".join(cells).rstrip())
    for topic in found.topics:
        if not topic.latched and topic.gaps:
            longest = topic.gaps[0]
            number = f"{len(topic.gaps)} gap{'s' if len(topic.gaps) > 1 else ''}"
            since = _seconds(longest.start_ns, found.start_ns)
            say(f"{visible(topic.name)}: {number}; the longest has {longest.seconds:.1f} s and starts at {since} s")


def _seconds(stamp_ns: int | None, start_ns: int | None) -> str:
    """Return the time of a stamp in seconds from the beginning of the recording."""
    return "" if stamp_ns is None or start_ns is None else f"{(stamp_ns - start_ns) / 1e9:.1f}"

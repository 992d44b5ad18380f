"""Topics and tables that `thbridge bag export` writes."""

import difflib
from collections.abc import Collection
from fnmatch import fnmatchcase
from pathlib import Path

from thbridge.analysis.export import dialogues, poses
from thbridge.analysis.export.exporting import table_name
from thbridge.recording.bag.reading.reader import info
from thbridge.ros.messages.types import DIALOGUE_MOVE
from ui.command_line.terminal import BAD_INPUT, command, fail


def chosen_topics(bag: Path, patterns: Collection[str]) -> frozenset[str]:
    """Return the topics of a bag that match any of the patterns."""
    names = {topic.name for topic in info(bag).topics}
    chosen: set[str] = set()
    for pattern in patterns:
        fitting = {name for name in names if fnmatchcase(name, pattern)}
        if not fitting:
            _fail_without(bag, "topic", pattern, names)
        chosen |= fitting
    return frozenset(chosen)


def chosen_tables(bag: Path, patterns: Collection[str]) -> frozenset[str]:
    """Return the tables of a bag that match any of the patterns; `events` also means `hunt_events`."""
    topics = info(bag).topics
    names = {poses.NAME, *(table_name(topic.name) for topic in topics)}
    if any(topic.msgtype == DIALOGUE_MOVE for topic in topics):
        names.update(dialogues.NAMES)
    chosen: set[str] = set()
    for pattern in patterns:
        fitting = {name for name in names if fnmatchcase(name, pattern)}
        fitting = fitting or {name for name in names if name.endswith(f"_{pattern}")}
        if not fitting:
            _fail_without(bag, "table", pattern, names)
        chosen |= fitting
    return frozenset(chosen)


def _fail_without(bag: Path, what: str, pattern: str, names: Collection[str]) -> None:
    word = pattern.strip("/*")
    near = difflib.get_close_matches(pattern, sorted(names), n=3, cutoff=0.6)
    near += [name for name in sorted(names) if word and word in name and name not in near][:3]
    hint = f"Similar names are {', '.join(near)}" if near else f"No {what} has a similar name"
    fail(
        BAD_INPUT, f"--{what}s: there is no {what} {pattern}. {hint}; `{command('bag', 'info', bag)}` lists all topics."
    )


def names_in(given: Collection[str]) -> list[str]:
    """Return the names in the values of a repeated option. One value may contain several names, separated by commas."""
    return [name.strip() for text in given for name in text.split(",") if name.strip()]

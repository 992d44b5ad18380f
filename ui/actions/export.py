"""Topics for `thbridge bag export`."""

from fnmatch import fnmatchcase
from pathlib import Path

from thbridge.recording.bag.reader import info
from ui.terminal import BAD_INPUT, fail


def chosen_topics(bag: Path, patterns: list[str]) -> frozenset[str]:
    """The topics of a bag that match any of the patterns."""
    names = {topic.name for topic in info(bag).topics}
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in names):
            fail(BAD_INPUT, f"--topics: there is no topic {pattern}. There are {', '.join(sorted(names))}.")
    return frozenset(name for name in names if any(fnmatchcase(name, pattern) for pattern in patterns))

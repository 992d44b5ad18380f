"""Message definitions for bags and ROS graphs: our own texts, or the texts of an installed ROS 1, with comments."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from thbridge.ros.messages.types import OWN_TEXTS, TEXTS, Definition, full_text, md5_of, plain_definition

ROS_SHARES = (Path("/usr/share"), *sorted(Path("/opt/ros").glob("*/share"), reverse=True))
"""Folders with the .msg files of packages: first Debian's ROS, then ROS's own builds, newest first."""


class Definitions:
    """Definitions of message types.

    Args:
        shares: folders with files `PACKAGE/msg/TYPE.msg`, which are preferred. By default there are none, so that texts
            are the same on every machine. ROS's tools compare texts including comments: see `ROS_SHARES`.
    """

    def __init__(self, shares: Sequence[Path] = ()) -> None:
        self._shares = tuple(shares)
        self._text_of = cache(self._read)

    def of(self, msgtype: str) -> Definition:
        """Return the definition of a type, for example "nav_msgs/Odometry".

        An installed text is used only if it has the same fields as ours, because another release of ROS may have
        changed the type. For types that we do not write, this is the definition from rosbags.

        Raises:
            KeyError: the type does not exist.
        """
        plain = plain_definition(msgtype)
        if not self._shares:
            return plain
        text = full_text(msgtype, self._text_of)
        if text is None or md5_of(msgtype, text) != plain.md5:
            return plain
        return Definition(text, plain.md5)

    def _read(self, msgtype: str) -> str | None:
        if msgtype in OWN_TEXTS:
            return OWN_TEXTS[msgtype]
        package, _, name = msgtype.partition("/")
        for share in self._shares:
            try:
                return (share / package / "msg" / f"{name}.msg").read_text(encoding="utf-8")
            except (OSError, UnicodeDecodeError):
                continue
        return TEXTS.get(msgtype)

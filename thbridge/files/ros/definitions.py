"""Message definitions with the texts of an installed ROS 1, whose tools compare texts including comments."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from thbridge.ros.messages.definition_texts import ROS_TEXTS
from thbridge.ros.messages.types import OWN_TEXTS, Definition, full_text, md5_of, plain_definition

ROS_SHARES = (Path("/usr/share"), *sorted(Path("/opt/ros").glob("*/share"), reverse=True))
"""Folders with the .msg files of packages: first Debian's ROS, then ROS's own builds, newest first."""


class Definitions:
    """Looks up the definitions of message types for bags.

    Args:
        shares: folders with files `PACKAGE/msg/TYPE.msg`; empty for texts without comments.
    """

    def __init__(self, shares: Sequence[Path] = ROS_SHARES) -> None:
        self._shares = tuple(shares)
        self._text_of = cache(self._read)

    def of(self, msgtype: str) -> Definition:
        """The definition of a type, for example "nav_msgs/Odometry".

        An installed text is used only if its fields are ours: another release of ROS may have changed the type.

        Raises:
            KeyError: there is no such type.
        """
        plain = plain_definition(msgtype)
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
        return ROS_TEXTS.get(msgtype)

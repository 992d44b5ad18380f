"""Old and present wordings of recorded texts, so that the replay of an old recording counts as equal.

A session records sentences for people: reasons of failed moves, log lines, diagnostics, descriptions of inputs. A new
session writes the present wordings. When a recorded text is reworded, the old wording gets a row in `_ROWS`, as long as
recordings with the old wording must be replayed. Recordings are not changed: `reworded` returns a copy.

Texts in MAVLink frames are not replaced, because a frame has a checksum, and a longer sentence needs more frames.
"""

import re
import struct
from dataclasses import fields, is_dataclass

from rosbags.serde.errors import SerdeError
from rosbags.typesys.msg import normalize_msgtype

from thbridge.ros.messages.types import typestore

_ROWS = (
    # Reasons of failed moves: roles/shared/failure_reasons.py, hunt/rules.py
    (r"blocks the way of (robot \d+)\.", r"blocks the path of \1."),
    (
        r"Other robots stand in the way of (robot \d+) and do not clear it\.",
        r"Other robots block the path of \1 and do not move away.",
    ),
    (
        r"The map has no way there from where (robot \d+) believes it is\.",
        r"The map has no path there from where \1 believes it is.",
    ),
    (
        r"Where (robot \d+) should stand, the map has a wall, or one too near\.",
        r"The place where \1 should stand is inside a wall or too near to one.",
    ),
    (
        r"(Robot \d+) stands within something, or too near to it to set out\.",
        r"\1 stands inside an obstacle, or too near to one to start.",
    ),
    (r"(Robot \d+) believes that it is where the map has nothing\.", r"\1 believes that it is outside the map."),
    (r"(Robot \d+) has given up the way there\.", r"\1 has given up its goal."),
    (
        r"Somebody at the robots' controls has called (robot \d+) off\.",
        r"A person at the robots' controls has canceled the goal of \1.",
    ),
    (r"(Robot \d+) does not answer any more\.", r"\1 no longer answers."),
    (
        r"The map does not know what is where (robot \d+) should stand\.",
        r"The map does not show what is at the place where \1 should stand.",
    ),
    # Reasons of the navigator: sim/robot
    (r"there is no way from here to the goal", "there is no path from here to the goal"),
    (r"other robots stand in the way and do not clear it", "other robots block the path and do not move away"),
    (r"other robots stand in the way", "other robots block the path"),
    # Log and diagnostics: ros/diagnostics.py
    (r"^goal (.+) is reached$", r"goal \1 was reached"),
    (r"^goal (.+) is withdrawn$", r"goal \1 was preempted"),
    (r"^goal (.+) came too late$", r"goal \1 was recalled before it started"),
    (r"^goal (.+?) is given up(: .*)?$", r"goal \1 was given up\2"),
    (r"^(\S+) has run into something, (\d+) times so far$", r"\1 has hit something; collisions so far: \2"),
    (r"^no way on: the robot tries to get free$", "path blocked: the robot tries to get free"),
    (r"^a client takes goals back$", "a client cancels goals"),
    (r"^standard deviation \(m\)$", "standard deviation of the position (m)"),
    (r"^of the heading \(degrees\)$", "standard deviation of the heading (degrees)"),
    (r"^way left \(m\)$", "distance left (m)"),
    # States of goals: ros/actionlib.py
    (r"^a newer goal took its place$", "replaced by a newer goal"),
    (r"^taken back before it came$", "canceled before it arrived"),
    # Failures of installed parts: app/compose/installed_parts.py
    (r"\ba (\w+) is no Twist, and not None$", r"a \1 is neither a Twist nor None"),
    (r"\ba (\w+) is no Estimate$", r"a \1 is not an Estimate"),
    (r"\bits path is no \(m, 2\)", "its path is not an (m, 2)"),
    (
        r"\bthe covariance is no \(3, 3\) array of finite numbers with variances of at least 0$",
        "the covariance is not a (3, 3) array of finite numbers with variances of 0 or more",
    ),
    (r"\bthe particles are no \(n, 3\) array", "the particles are not an (n, 3) array"),
    (r"\b(agreement|p_wrong) is (\S+), and has to be from 0 to 1", r"\1 is \2, but must be from 0 to 1"),
    # Descriptions of inputs: app/session/input_records.py
    (r"^a connection is opened by the key (.+)$", r"a connection is opened with the key \1"),
    (
        r"^the connection is given up: (\d+) bytes wait for it$",
        r"the connection is closed: its client has not read \1 bytes",
    ),
    (r"^somebody has been silent for long$", "a silent client is pinged or dropped"),
    (r"^robots say that they are there$", "the vehicles send heartbeats"),
)
"""Patterns of old wordings, each with the present wording, in the order of replacement."""
_REWORDINGS = tuple((re.compile(old, re.DOTALL), new) for old, new in _ROWS)


def in_present_words(text: str) -> str:
    """Return a recorded text with present wordings; unchanged if the text has no old wording."""
    for old, new in _REWORDINGS:
        text = old.sub(new, text)
    return text


def reworded(msgtype: str, was: bytes, now: bytes) -> bytes:
    """Return a recorded message with present wordings in all strings that differ from a replayed message.

    Equal strings are not changed: they come from outside, or were not reworded.

    Args:
        msgtype: type of both messages.
        was: the recorded message.
        now: the replayed message.

    Returns:
        The message with the new strings, or `was` itself if no string was reworded or the message is unreadable.
    """
    store, name = typestore(), normalize_msgtype(msgtype)
    try:
        before, after = (store.deserialize_ros1(data, name) for data in (was, now))
    except (SerdeError, UnicodeDecodeError, struct.error):
        return was
    return bytes(store.serialize_ros1(before, name)) if _reword(before, after) else was


def _reword(was: object, now: object) -> bool:
    """Replace old wordings in the strings of a message in place; return True if a string has changed."""
    changed = False
    if isinstance(was, list) and isinstance(now, list):
        for index, (before, after) in enumerate(zip(was, now, strict=False)):
            if isinstance(before, str):
                new = _present(before, after)
                changed |= new != before
                was[index] = new
            else:
                changed |= _reword(before, after)
    elif is_dataclass(was) and type(was) is type(now):
        for field in fields(was):
            if field.name.startswith("__"):
                continue  # In the classes of rosbags, the name of the type is a field.
            before, after = getattr(was, field.name), getattr(now, field.name)
            if isinstance(before, str):
                new = _present(before, after)
                changed |= new != before
                setattr(was, field.name, new)
            else:
                changed |= _reword(before, after)
    return changed


def _present(was: str, now: object) -> str:
    return was if was == now else in_present_words(was)

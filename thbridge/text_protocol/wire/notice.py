r"""Notices: messages between our own programs that extend the protocol of 2016.

A notice is sent as ``%%error FROM TO thbridge {json}``. The JSON is compact ASCII without blanks (those in strings are
written ``\u0020``). So it is one token, and any server of the protocol passes it on unchanged.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NoReturn, TypeAlias, TypeVar

import msgspec

from thbridge.text_protocol.wire.lines import TextCommand, TextMessage, UnreadableText

JsonValue: TypeAlias = bool | int | float | str | Sequence["JsonValue"] | Mapping[str, "JsonValue"] | None
"""Any value of JSON; `parse_notice` returns lists and dictionaries."""

SERVER = "Server"
"""Sender name in the server's own notices."""

UNDELIVERED = "undelivered"
"""The server's notice of a failed delivery, with the fields `command`, `receiver`, `content` (its beginning) and
`reason`."""

REFUSED = "refused"
"""The server's notice before it closes a connection because of its key, with the field `reason`, a clause."""

COUNTED = range(1, 1 << 32)
"""Valid numbers of games and dialogues; they are also keys of random numbers. Other numbers come from faulty
senders."""

_MARK = "thbridge"
_REQUEST = "request"


@dataclass(frozen=True, slots=True)
class Notice:
    """Notice, as its receiver reads it.

    Attributes:
        sender: name of the program that sends it.
        receiver: name of the receiving program.
        kind: name of its subject, which determines its fields.
        fields: the fields.
    """

    sender: str
    receiver: str
    kind: str
    fields: Mapping[str, JsonValue]

    @property
    def request(self) -> int | None:
        """Number that the sender gave this request, the same in each repetition; None if it has no number."""
        number = self.fields.get(_REQUEST)
        return number if type(number) is int and number in COUNTED else None


class NoticeValue(msgspec.Struct, frozen=True, tag_field="kind"):
    """Base of the values in notices. Their tags are their kinds on the wire, which are the same in all releases."""


N = TypeVar("N", bound=NoticeValue)


def kind_of(value_class: type[NoticeValue]) -> str:
    """Return the kind, on the wire, of notices with values of a class."""
    return str(value_class.__struct_config__.tag)


def encode_notice(sender: str, receiver: str, value: NoticeValue, request: int | None = None) -> TextMessage:
    """Return the message with a value. Raises ValueError as `notice` does.

    Args:
        sender: name of the program that sends it.
        receiver: name of the receiving program.
        value: the value.
        request: see `Notice.request`.
    """
    fields = msgspec.to_builtins(value)
    return _message(sender, receiver, fields if request is None else {**fields, _REQUEST: request})


class NoticeDecoder(Generic[N]):
    """Decoder of all notices that one program accepts.

    Args:
        union: class of their values, or a union of such classes, which are distinguished by their tags.
    """

    def __init__(self, union: object) -> None:
        self._union = union

    def decode(self, notice: Notice) -> N | None:
        """Return the value of a notice; None if it is not for this program, or malformed."""
        try:
            value: N = msgspec.convert({**notice.fields, "kind": notice.kind}, self._union)
        except msgspec.ValidationError:
            return None
        return value

    def read(self, message: TextMessage) -> N | None:
        """Return the value of the notice in a message; None also if the message contains no notice."""
        notice = parse_notice(message)
        return self.decode(notice) if isinstance(notice, Notice) else None


def decode_notice(notice: Notice, value_class: type[N]) -> N | None:
    """Return the value of a notice if it is of this class and well formed, otherwise None."""
    return NoticeDecoder[N](value_class).decode(notice)


def notice(sender: str, receiver: str, kind: str, /, **fields: JsonValue) -> TextMessage:
    """Return the message with a notice; fields keep their order.

    Raises:
        ValueError: a number is not finite, a field is called ``kind``, or a name is not one token.
    """
    if "kind" in fields:
        raise ValueError("a field of a notice cannot be called kind")
    return _message(sender, receiver, {"kind": kind, **fields})


def _message(sender: str, receiver: str, fields: Mapping[str, JsonValue]) -> TextMessage:
    text = json.dumps(fields, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return TextMessage(TextCommand.ERROR, sender, receiver, (_MARK, text.replace(" ", r"\u0020")))


def is_notice(message: TextMessage) -> bool:
    """Return True when a message has the form of a notice; its JSON may still be invalid."""
    return message.command == TextCommand.ERROR and message.content[:1] == (_MARK,)


def parse_notice(message: TextMessage) -> Notice | UnreadableText:
    """Return the notice in a message."""
    if not is_notice(message):
        return UnreadableText(message.line(), "it is not a notice")
    text = " ".join(message.content[1:])
    try:
        value: JsonValue = json.loads(text, parse_constant=_refuse_constant)
    # A long line of nested brackets exhausts the parser's stack.
    except (ValueError, RecursionError) as error:
        return UnreadableText(message.line(), f"its JSON is broken: {error}")
    if not isinstance(value, dict):
        return UnreadableText(message.line(), "its JSON is not an object")
    if _has_half_a_character(text):
        return UnreadableText(message.line(), "its JSON has half of a surrogate pair, which no text can hold")
    kind = value.pop("kind", None)
    if not isinstance(kind, str):
        return UnreadableText(message.line(), "it has no kind")
    return Notice(message.sender, message.receiver, kind, value)


def _has_half_a_character(text: str) -> bool:
    """Return True if an escape is half of a surrogate pair without the other half; JSON's grammar allows this."""
    if r"\u" not in text:
        return False
    try:
        # Parsing joins pairs to one character. Halves stay, and cannot be encoded.
        json.dumps(json.loads(text), ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return True
    return False


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")

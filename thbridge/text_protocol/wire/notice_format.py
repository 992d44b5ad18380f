r"""Notices: messages between our own programs that extend the protocol of 2016.

A notice is sent as ``%%error FROM TO thbridge {json}``. The JSON is compact ASCII. It contains no blanks: a blank in a
string is written ``\u0020``. So the JSON is one token, and any server of the protocol passes it on unchanged.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Generic, NoReturn, TypeAlias, TypeVar

import msgspec

from thbridge.text_protocol.wire.lines import TextCommand, TextMessage, UnreadableText

JsonValue: TypeAlias = bool | int | float | str | Sequence["JsonValue"] | Mapping[str, "JsonValue"] | None
"""Any value of JSON. `parse_notice` returns its sequences as lists and its mappings as dictionaries."""

SERVER = "Server"
"""Name of the sender in the server's own notices."""

UNDELIVERED = "undelivered"
"""Kind of the server's notice about a failed delivery. Its fields are `command`, `receiver`, `content` (only the
beginning) and `reason`."""

REFUSED = "refused"
"""Kind of the notice before the server closes a connection because of the key. The field `reason` is a clause."""

COUNTED = range(1, 1 << 32)
"""Valid numbers of games and dialogues. These numbers are also keys of random numbers. Other numbers come from faulty
senders."""

_MARK = "thbridge"
_JSON = json.JSONEncoder(ensure_ascii=True, allow_nan=False, separators=(",", ":"))
_REQUEST = "request"


@dataclass(frozen=True, slots=True)
class Notice:
    """Notice as its receiver gets it.

    Attributes:
        sender: name of the program that sends it.
        receiver: name of the receiving program.
        kind: name of its subject. It determines the fields.
        fields: names and values of its fields.
    """

    sender: str
    receiver: str
    kind: str
    fields: Mapping[str, JsonValue]

    @property
    def request(self) -> int | None:
        """Number that the sender gave this request, the same in each repetition. None if the request has no number."""
        number = self.fields.get(_REQUEST)
        # The exact type is compared, because True is an instance of int too.
        return number if type(number) is int and number in COUNTED else None


class NoticeValue(msgspec.Struct, frozen=True, tag_field="kind"):
    """Base class of the values in notices. A class's tag is the kind of its notices on the wire. It never changes.

    Attributes:
        OMITTED: fields that are omitted while they are None, because earlier releases do not have them.
    """

    OMITTED: ClassVar[frozenset[str]] = frozenset()


N = TypeVar("N", bound=NoticeValue)


def kind_of(value_class: type[NoticeValue]) -> str:
    """Return the kind on the wire of notices that have values of this class."""
    return str(value_class.__struct_config__.tag)


def encode_notice(sender: str, receiver: str, value: NoticeValue, request: int | None = None) -> TextMessage:
    """Return the message with a value. Raises ValueError as `notice` does.

    Args:
        sender: name of the program that sends it.
        receiver: name of the receiving program.
        value: the value.
        request: see `Notice.request`.
    """
    fields: dict[str, JsonValue] = msgspec.to_builtins(value)
    for name in value.OMITTED:
        if fields[name] is None:
            del fields[name]
    return _message(sender, receiver, fields if request is None else {**fields, _REQUEST: request})


class NoticeDecoder(Generic[N]):
    """Decoder of all notices that one program accepts.

    Args:
        union: class of the values, or a union of classes with different tags.
    """

    def __init__(self, union: object) -> None:
        self._union = union

    def decode(self, notice: Notice) -> N | None:
        """Return the value of a notice. Return None if this program does not accept its kind, or if it is malformed."""
        try:
            value: N = msgspec.convert({**notice.fields, "kind": notice.kind}, self._union)
        except msgspec.ValidationError:
            return None
        return value

    def read(self, message: TextMessage) -> N | None:
        """Return the value of the notice in a message. See `decode`. If the message has no notice, return None."""
        notice = parse_notice(message)
        return self.decode(notice) if isinstance(notice, Notice) else None


def decode_notice(notice: Notice, value_class: type[N]) -> N | None:
    """Return the value of a notice if it is of this class and well formed, otherwise None."""
    return NoticeDecoder[N](value_class).decode(notice)


def notice(sender: str, receiver: str, kind: str, /, **fields: JsonValue) -> TextMessage:
    """Return the message with a notice. The fields keep their order.

    Raises:
        ValueError: a number is not finite, a field is called ``kind``, or a name is not one token.
    """
    if "kind" in fields:
        raise ValueError("a field of a notice cannot be called kind")
    return _message(sender, receiver, {"kind": kind, **fields})


def _message(sender: str, receiver: str, fields: Mapping[str, JsonValue]) -> TextMessage:
    return TextMessage(TextCommand.ERROR, sender, receiver, (_MARK, _JSON.encode(fields).replace(" ", r"\u0020")))


def is_notice(message: TextMessage) -> bool:
    """Return True if a message has the form of a notice. Its JSON may still be invalid."""
    return message.command == TextCommand.ERROR and message.content[:1] == (_MARK,)


def parse_notice(message: TextMessage) -> Notice | UnreadableText:
    """Return the notice in a message."""
    if not is_notice(message):
        return UnreadableText(message.line(), "it is not a notice")
    text = " ".join(message.content[1:])
    try:
        value: JsonValue = json.loads(text, parse_constant=_refuse_constant)
    # Many nested brackets cause RecursionError, because they exhaust the parser's stack.
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
    """Return True if the text contains only one half of a surrogate pair, as an escape. JSON's grammar allows this."""
    # Both halves begin like this. Most texts have other escapes only, such as blanks.
    if r"\ud" not in text.lower():
        return False
    try:
        # Parsing joins a pair to one character. A single half stays as it is, and encoding fails.
        json.dumps(json.loads(text), ensure_ascii=False).encode()
    except UnicodeEncodeError:
        return True
    return False


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")

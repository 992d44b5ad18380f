"""XML-RPC as in ROS 1: conversion of bytes to values and back, without sockets.

Input may be hostile. A document type is refused at its start, before it declares any entity. This prevents the billion
laughs attack and external entities. Size, nesting and number of elements have limits. The result of invalid input is a
`MalformedDocument`. Decoding never raises.

Source: http://xmlrpc.com/spec.md; Python's xmlrpc.client and ROS's xmlrpcpp for the forms that ROS nodes send: untyped
``<value>text</value>``, white space between elements, ``<i8>`` and ``<nil/>``.
"""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass, field
from typing import TypeAlias
from xml.parsers import expat

MAX_BYTES = 16 * 2**20
"""Maximum size of a document, bytes. A robot_description has about 100 kB."""

MAX_ELEMENTS = 250_000
"""Maximum number of XML elements in a document. A parameter needs about four."""

MAX_DEPTH = 128
"""Maximum depth of nested values."""

_LONGEST_FAULT = 10_000
"""Maximum number of characters in the text of a fault."""

_TAGS = 32
"""Approximate number of characters in the tags of a value."""

_ELEMENTS_PER_LEVEL = 4  # A level is value, struct, member, value; or value, array, data, value.
_I4 = range(-(2**31), 2**31)
_I8 = range(-(2**63), 2**63)


@dataclass(frozen=True, slots=True)
class DateTime:
    """Value of type ``dateTime.iso8601``. It is not parsed, because ROS does not use it and it has no time zone."""

    text: str


XmlRpcValue: TypeAlias = (
    bool | int | float | str | bytes | DateTime | list["XmlRpcValue"] | dict[str, "XmlRpcValue"] | None
)
"""Any value of XML-RPC, including the extensions ``nil`` and ``i8``."""


@dataclass(frozen=True, slots=True)
class MethodCall:
    """Call of a method with parameters by position."""

    method: str
    params: list[XmlRpcValue]


@dataclass(frozen=True, slots=True)
class MethodResponse:
    """Return value of a method."""

    value: XmlRpcValue


@dataclass(frozen=True, slots=True)
class Fault:
    """Failure of a call as an error of XML-RPC itself, in contrast to a status code of ROS."""

    code: int
    text: str


@dataclass(frozen=True, slots=True)
class MalformedDocument:
    """Document that could not be decoded. `reason` is a clause."""

    reason: str


def written_size(value: XmlRpcValue, enough: int) -> int:
    """Return the approximate number of characters of an encoded value. Counting stops at `enough`."""
    size = 0
    waiting = [value]
    while waiting and size <= enough:
        each = waiting.pop()
        size += _TAGS
        if isinstance(each, str | bytes):
            size += len(each)
        elif isinstance(each, list):
            waiting += each
        elif isinstance(each, dict):
            size += sum(map(len, each))
            waiting += each.values()
    return size


def encode_call(method: str, params: list[XmlRpcValue]) -> bytes:
    """Encode a call.

    Raises:
        ValueError: a parameter cannot be encoded. See `encode_response`.
    """
    listed = "".join(f"<param>\n{_written(value)}\n</param>\n" for value in params)
    return _document(
        f"<methodCall>\n<methodName>{_escaped(method)}</methodName>\n<params>\n{listed}</params>\n</methodCall>"
    )


def encode_response(value: XmlRpcValue) -> bytes:
    """Encode a successful response.

    Integers of more than 32 bits become ``i8``, and None becomes ``nil``. Python nodes can read these, but C++ nodes
    cannot. Characters that XML cannot contain, such as NUL, become U+FFFD.

    Raises:
        ValueError: an integer has more than 64 bits, or values are nested deeper than `MAX_DEPTH` or longer than
            `MAX_BYTES`.
    """
    return _document(f"<methodResponse>\n<params>\n<param>\n{_written(value)}\n</param>\n</params>\n</methodResponse>")


def encode_fault(code: int, text: str) -> bytes:
    """Encode a fault. A long text is cut."""
    value = _written({"faultCode": code, "faultString": text[:_LONGEST_FAULT]})
    return _document(f"<methodResponse>\n<fault>\n{value}\n</fault>\n</methodResponse>")


def decode_call(data: bytes) -> MethodCall | MalformedDocument:
    """Decode a call."""
    try:
        root = _parsed(data, "methodCall")
        name = root.only_child("methodName", others=("params",)).leaf()
        return MethodCall(name.strip(), _params(root))
    except _MalformedError as error:
        return MalformedDocument(str(error))


def decode_response(data: bytes) -> MethodResponse | Fault | MalformedDocument:
    """Decode the response to a call."""
    try:
        root = _parsed(data, "methodResponse")
        if any(child.name == "fault" for child in root.children):
            return _fault(_value(root.only_child("fault").only_child("value")))
        params = _params(root)
        if len(params) != 1:
            return MalformedDocument(f"an answer must contain one value, not {len(params)}")
        return MethodResponse(params[0])
    except _MalformedError as error:
        return MalformedDocument(str(error))


def _fault(value: XmlRpcValue) -> Fault | MalformedDocument:
    match value:
        case {"faultCode": int(code), "faultString": str(text)}:
            return Fault(code, text)
        case _:
            return MalformedDocument("a fault has no code or no text")


# -- writing ----------------------------------------------------------------------------------------------------------

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def _document(text: str) -> bytes:
    return b"<?xml version='1.0'?>\n" + text.encode() + b"\n"


def _escaped(text: str) -> str:
    legal = text if text.isprintable() else _NOT_IN_XML.sub("\ufffd", text)
    # XML readers convert a plain carriage return to a line feed.
    return legal.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace("\r", "&#13;")


class _Pieces:
    """Pieces of a document of limited length. A short call may request all parameters many times."""

    def __init__(self) -> None:
        self._pieces: list[str] = []
        self._room = MAX_BYTES

    def add(self, piece: str) -> None:
        self._room -= len(piece)
        if self._room < 0:
            raise ValueError(f"longer than {MAX_BYTES} characters")
        self._pieces.append(piece)

    def joined(self) -> str:
        return "".join(self._pieces)


def _written(value: XmlRpcValue) -> str:
    pieces = _Pieces()
    _write(value, pieces, 0)
    return pieces.joined()


def _write(value: XmlRpcValue, pieces: _Pieces, depth: int) -> None:
    if depth >= MAX_DEPTH:
        raise ValueError(f"values nested deeper than {MAX_DEPTH}")
    match value:
        case str():
            pieces.add(f"<value><string>{_escaped(value)}</string></value>")
        # This case is before int, because a bool is also an int.
        case bool():
            pieces.add(f"<value><boolean>{int(value)}</boolean></value>")
        case int():
            if value not in _I8:
                raise ValueError(f"{value} does not fit into 64 bits")
            name = "int" if value in _I4 else "i8"
            pieces.add(f"<value><{name}>{value}</{name}></value>")
        case float():
            pieces.add(f"<value><double>{value!r}</double></value>")
        case bytes():
            pieces.add(f"<value><base64>{base64.b64encode(value).decode()}</base64></value>")
        case DateTime(text):
            pieces.add(f"<value><dateTime.iso8601>{_escaped(text)}</dateTime.iso8601></value>")
        case None:
            pieces.add("<value><nil/></value>")
        case list():
            pieces.add("<value><array><data>")
            for item in value:
                _write(item, pieces, depth + 1)
            pieces.add("</data></array></value>")
        case dict():
            pieces.add("<value><struct>")
            for name, item in value.items():
                pieces.add(f"<member><name>{_escaped(name)}</name>")
                _write(item, pieces, depth + 1)
                pieces.add("</member>")
            pieces.add("</struct></value>")


# -- reading ----------------------------------------------------------------------------------------------------------


class _MalformedError(Exception):
    """Raised for a fault in a document, by the parser's callbacks or the interpretation. Only this module sees it."""


@dataclass(slots=True)
class _Element:
    name: str
    children: list[_Element] = field(default_factory=list)
    text: list[str] = field(default_factory=list)

    def leaf(self) -> str:
        """Return the text of an element that must contain only text."""
        if self.children:
            raise _MalformedError(f"<{self.children[0].name}> inside <{self.name}>")
        return "".join(self.text)

    def branches(self, *names: str) -> list[_Element]:
        """Return the children of an element that must contain only elements with these names."""
        if any(not piece.isspace() for piece in self.text):
            raise _MalformedError(f"text inside <{self.name}>")
        for child in self.children:
            if child.name not in names:
                raise _MalformedError(f"<{child.name}> inside <{self.name}>")
        return self.children

    def only_child(self, name: str, others: tuple[str, ...] = ()) -> _Element:
        found = [child for child in self.branches(name, *others) if child.name == name]
        if len(found) != 1:
            raise _MalformedError(f"<{self.name}> must contain one <{name}>")
        return found[0]


def _parsed(data: bytes, root: str) -> _Element:
    """Parse a document to a tree of elements, within the limits of this module."""
    if len(data) > MAX_BYTES:
        raise _MalformedError(f"longer than {MAX_BYTES} bytes")
    top = _Element("")
    path = [top]
    elements = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal elements
        elements += 1
        if elements > MAX_ELEMENTS:
            raise _MalformedError(f"more than {MAX_ELEMENTS} elements")
        if len(path) > _ELEMENTS_PER_LEVEL * MAX_DEPTH:
            raise _MalformedError("nested too deeply")
        # The names of Apache's extensions are ex:i8 and ex:nil.
        element = _Element(name.rpartition(":")[2])
        path[-1].children.append(element)
        path.append(element)

    def end(name: str) -> None:
        path.pop()

    def text(data: str) -> None:
        path[-1].text.append(data)

    def refuse(name: str, system: str | None, public: str | None, has_subset: bool) -> None:
        # A document type may define entities that expand to any size.
        raise _MalformedError("it declares a document type, which XML-RPC does not use")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = text
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, LookupError, ValueError) as error:  # The last two: unknown or wrong encoding.
        raise _MalformedError(str(error)) from None
    return top.only_child(root)


def _params(root: _Element) -> list[XmlRpcValue]:
    """Return the parameters of a call or response. A call without parameters may omit ``<params>``."""
    found = [child for child in root.children if child.name == "params"]
    if len(found) > 1:
        raise _MalformedError("more than one <params>")
    return [_value(param.only_child("value")) for params in found for param in params.branches("param")]


def _value(element: _Element, depth: int = 0) -> XmlRpcValue:
    if depth >= MAX_DEPTH:
        raise _MalformedError("nested too deeply")
    if not element.children:
        return element.leaf()  # A value without a type is a string, including its white space.
    if len(element.children) > 1 or any(not piece.isspace() for piece in element.text):
        raise _MalformedError("<value> must contain one element")
    typed = element.children[0]
    match typed.name:
        case "i4" | "int" | "i8" | "i1" | "i2":
            return _integer(typed.leaf())
        case "boolean":
            return _boolean(typed.leaf())
        case "double" | "float":
            return _double(typed.leaf())
        case "string":
            return typed.leaf()
        case "base64":
            return _base64(typed.leaf())
        case "dateTime.iso8601":
            return DateTime(typed.leaf().strip())
        case "nil":
            return None
        case "array":
            return [_value(item, depth + 1) for item in typed.only_child("data").branches("value")]
        case "struct":
            return dict(_member(member, depth + 1) for member in typed.branches("member"))
        case name:
            raise _MalformedError(f"<{name}> is not a type of XML-RPC")


def _member(member: _Element, depth: int) -> tuple[str, XmlRpcValue]:
    name = member.only_child("name", others=("value",)).leaf()
    return name, _value(member.only_child("value", others=("name",)), depth)


def _integer(text: str) -> int:
    # Twenty characters are enough for any 64-bit integer. For thousands of digits, Python would raise ValueError.
    if re.fullmatch(r"[+-]?[0-9]{1,20}", text.strip()) is None or (value := int(text)) not in _I8:
        raise _MalformedError(f"{text[:30]!r} is not an integer of 64 bits")
    return value


def _boolean(text: str) -> bool:
    match text.strip():
        case "0":
            return False
        case "1":
            return True
        case other:
            raise _MalformedError(f"{other[:30]!r} is not a boolean")


def _double(text: str) -> float:
    try:
        if "_" in text:  # Python accepts underscores between digits. XML-RPC does not.
            raise ValueError
        return float(text)
    except ValueError:
        raise _MalformedError(f"{text[:30]!r} is not a double") from None


def _base64(text: str) -> bytes:
    try:
        return base64.b64decode("".join(text.split()), validate=True)
    except ValueError:
        raise _MalformedError("invalid base64") from None

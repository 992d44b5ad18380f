"""Studies as text: the complete text for recordings, and a text with comments for people."""

import dataclasses
import re
from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, cast, get_args, get_origin, get_type_hints

from thbridge.files.yaml.declarations import allowed, sections_named_in
from thbridge.files.yaml.tree import quoted
from thbridge.study.built_in import STANDARD
from thbridge.study.noise import TARGET_PATHS
from thbridge.study.study_file import Study, StudyFile

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
"""Pattern of texts that need no quotes, unless YAML gives them another meaning."""
_HEAD = (
    "# The study that `thbridge play` uses if no other study is given. An omitted key has the value in this file.",
    f"# Exception: if `templates` is omitted, its value is {Study().templates}, the game of 2016.",
    "",
)
_SEATS = frozenset({"seats", "team"})
_RESERVED = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}


def resolved(study: Study) -> str:
    """Return the complete study as YAML, including defaults. If this text is read, the result is an equal study.

    Sections about several seats are omitted for a game with one participant. So recordings and sweeps of such games
    contain the same text as before there were seats.
    """
    omitted = _SEATS if not study.seats and study.team == STANDARD.team else frozenset[str]()
    return "\n".join(_lines(StudyFile.of(study), "", commented=False, omitted=omitted)) + "\n"


def commented_study() -> str:
    """Return the built-in study `standard` as a file. A comment explains the meaning, unit and range of each key."""
    return "\n".join([*_HEAD, *_lines(StudyFile.of(STANDARD), "", commented=True)]) + "\n"


def _lines(section: "DataclassInstance", key: str, *, commented: bool, omitted: Collection[str] = ()) -> Iterator[str]:
    hints = cast(Mapping[str, object], get_type_hints(type(section)))
    for field in dataclasses.fields(section):
        place = f"{key}.{field.name}" if key else field.name
        if place in SHOWN_ELSEWHERE or place in omitted:
            continue
        value = cast(object, getattr(section, field.name))
        if field.name == sections_named_in(type(section)):
            named = cast(tuple["DataclassInstance", ...], value)
            lines = list(_named_sections(field.name, named))
        elif isinstance(value, Mapping):
            like = cast("DataclassInstance", getattr(section, cast(str, field.metadata["like"])))
            lines = list(_entries(field.name, cast(Mapping[int, "DataclassInstance"], value), like))
        elif dataclasses.is_dataclass(value) and not isinstance(value, type):
            inner = _lines(value, place, commented=commented)
            lines = [f"{field.name}:", *(f"  {line}" if line else "" for line in inner)]
        elif value and isinstance(value, tuple) and dataclasses.is_dataclass(value[0]):
            lines = [f"{field.name}:", *(f"  - {as_yaml(item)}" for item in value)]
        else:
            lines = [f"{field.name}: {as_yaml(value)}"]
        if commented:
            words = allowed(hints[field.name], field.metadata)
            comment = f"# {field.metadata['help']}" + (f" [{words}]" if words else "")
            comments = [comment, *_keys_of_items(hints[field.name])]
            # Without the comment sign, these numbers would override a preset that an admin chooses later.
            lines = [
                *comments,
                *(f"# {line}" if key == "noise" and place != "noise.preset" else line for line in lines),
            ]
            if not key and len(lines) > 2:
                lines.insert(0, "")
        yield from lines


def _entries(name: str, entries: Mapping[int, "DataclassInstance"], like: "DataclassInstance") -> Iterator[str]:
    """Yield the lines of numbered sections. Each section lists only its differences from the section `like`."""
    yield f"{name}:" if entries else f"{name}: {{}}"
    for number, entry in entries.items():
        yield f"  {number}:"
        yield from (f"    {line}" for line in _differences(entry, like))


def _named_sections(name: str, sections: tuple["DataclassInstance", ...]) -> Iterator[str]:
    """Yield the line that lists the names of sections, followed by these sections."""
    names = [cast(str, getattr(section, "name")) for section in sections]  # noqa: B009 - any class of them
    yield f"{name}: {quoted(' '.join(names))}"
    for own_name, section in zip(names, sections, strict=True):
        yield f"{own_name}:"
        for field in dataclasses.fields(section):
            if field.name != "name":
                yield f"  {field.name}: {as_yaml(cast(object, getattr(section, field.name)))}"


def _differences(section: "DataclassInstance", like: "DataclassInstance") -> Iterator[str]:
    for field in dataclasses.fields(section):
        value, other = (cast(object, getattr(each, field.name)) for each in (section, like))
        if value == other:
            continue
        if field.name == sections_named_in(type(section)):
            yield from _named_sections(field.name, cast(tuple["DataclassInstance", ...], value))
        elif dataclasses.is_dataclass(value) and not isinstance(value, type):
            yield f"{field.name}:"
            yield from (f"  {line}" for line in _differences(value, cast("DataclassInstance", other)))
        else:
            yield f"{field.name}: {as_yaml(value)}"


def _keys_of_items(hint: object) -> Iterator[str]:
    """Yield comments on the keys of an item, if the type is a list of sections."""
    item = get_args(hint)[0] if get_origin(hint) is tuple else None
    if not (isinstance(item, type) and dataclasses.is_dataclass(item)):
        return
    hints = cast(Mapping[str, object], get_type_hints(item))
    for field in dataclasses.fields(item):
        words = allowed(hints[field.name], field.metadata)
        yield f"#   {field.name}: {field.metadata['help']}" + (f" [{words}]" if words else "")


SHOWN_ELSEWHERE = {"world.odometry", *TARGET_PATHS.values()}
"""Keys that this text shows in the section `noise` instead of their own section."""


def as_yaml(value: object) -> str:
    """Return a value as YAML. If the YAML is read, the result is an equal value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, tuple):
        return f"[{', '.join(as_yaml(item) for item in value)}]"
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        values = {field.name: cast(object, getattr(value, field.name)) for field in dataclasses.fields(value)}
        standard = {field.name: cast(object, field.default) for field in dataclasses.fields(value)}
        keys = (f"{name}: {as_yaml(entry)}" for name, entry in values.items() if entry != standard[name])
        return f"{{{', '.join(keys)}}}"
    text = str(value)
    return text if is_plain_word(text) else quoted(text)


def is_plain_word(text: str) -> bool:
    """Return True if a text needs no quotes in a YAML file."""
    return _WORD.fullmatch(text) is not None and text.lower() not in _RESERVED

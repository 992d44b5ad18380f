"""Conversion of command line arguments to values. Error messages have the same words as messages about files."""

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, EnumType
from pathlib import Path
from types import NoneType, UnionType
from typing import cast, get_args

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption
from typer.models import ParameterInfo

from thbridge.files.yaml.angles import doubt_about, radians_of
from thbridge.files.yaml.declarations import bounds, wanted
from ui.command_line.terminal import note

_COMMA = re.compile(r"[-+]?\d*,\d+")
"""Decimal number with a comma."""
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,4})?")
_OF_ANGLES = re.compile(r"yaw|angle")
"""Options that take an angle."""
_IS_NOT: Mapping[type, str] = {int: "not a whole number", float: "not a number"}


def convert_if_given(command: TyperCommand | TyperGroup, context: typer.Context) -> None:
    """Make a command convert the arguments that the user gave, and keep defaults unchanged.

    This replaces Typer's own conversion by pydantic. Importing pydantic takes longer than starting a command.
    """
    declared = {} if command.callback is None else inspect.signature(command.callback, eval_str=True).parameters
    for parameter in command.get_params(context):
        if isinstance(parameter, TyperOption | TyperArgument):
            annotation = declared[parameter.name].annotation if parameter.name in declared else None
            parameter.process_value = _Conversion(parameter, *_described(annotation))  # type: ignore[assignment, method-assign]


def _described(annotation: object) -> tuple[object, ParameterInfo]:
    """Return the type of a parameter without None, and the metadata of its annotation."""
    kind, info = getattr(annotation, "__origin__", annotation), ParameterInfo()
    for mark in getattr(annotation, "__metadata__", ()):
        info = mark if isinstance(mark, ParameterInfo) else info
    if isinstance(kind, UnionType):
        kind = next(each for each in get_args(kind) if each is not NoneType)
    return kind, info


@dataclass(frozen=True, slots=True)
class _Conversion:
    """Conversion of an argument; it returns the argument unchanged while a shell completes words."""

    parameter: TyperOption | TyperArgument
    kind: object
    info: ParameterInfo

    def __call__(self, context: typer.Context, value: object) -> object:
        if context.resilient_parsing:
            return value
        parameter, source = self.parameter, context.get_parameter_source(self.parameter.name)
        if source is not None and source.name != "DEFAULT":
            try:
                value = self._converted(value)
            except ValueError as fault:
                raise typer.BadParameter(str(fault), context, parameter) from None
        if parameter.required and parameter.value_is_missing(value):
            words = f"Missing {parameter.param_type_name} {parameter.get_error_hint()}."
            context.fail(f"{words} {parameter.get_missing_message(context) or ''}".rstrip())
        return value if parameter.callback is None else parameter.callback(context, parameter, value)

    def _converted(self, value: object) -> object:
        if isinstance(value, str):
            return self._word(self.kind, self._in_radians(value) if _OF_ANGLES.search(self.parameter.name) else value)
        kinds = get_args(self.kind)
        if not kinds:
            return value
        words = [*cast("Iterable[str]", value)]
        if kinds == (float, float, float):
            words[-1] = self._in_radians(words[-1])
        return tuple(map(self._word, kinds * len(words) if len(kinds) == 1 else kinds, words))

    def _word(self, kind: object, word: str) -> object:
        if isinstance(kind, EnumType):
            folded = (lambda text: text) if self.info.case_sensitive else str.casefold
            members = {folded(str(member.value)): member for member in cast("Iterable[Enum]", kind)}
            if folded(word) not in members:
                raise ValueError(f"{word!r} is not one of {', '.join(map(repr, members))}.")
            return members[folded(word)]
        if kind is int or kind is float:
            return self._number(kind, word)
        return Path(word) if kind is Path else word

    def _number(self, kind: type[int | float], word: str) -> float:
        limits = {"minimum": self.info.min, "maximum": self.info.max}
        least, most = bounds(limits)
        problem = _IS_NOT[kind]
        try:
            value = float(word)
        except ValueError:
            if _COMMA.fullmatch(word):
                raise ValueError(f"{word!r} is not a number. Use a decimal point: {word.replace(',', '.')}.") from None
        else:
            if kind is float or value.is_integer():
                if least <= value <= most or (self.info.min, self.info.max) == (None, None):
                    return kind(value)
                problem = "out of range" if _NUMBER.fullmatch(word) else problem
        raise ValueError(f"{word!r} is {problem}. {wanted(kind, limits)}.")

    def _in_radians(self, word: str) -> str:
        """Convert an angle with a unit to radians; print a warning if a number without a unit is doubtful."""
        radians = radians_of(word)
        if radians is not None:
            return repr(radians)
        doubt = doubt_about(word, float(word)) if _NUMBER.fullmatch(word) else None
        if doubt is not None:
            problem, remedy = doubt
            note(f"{self.parameter.opts[0]}: {problem}. {remedy}.")
        return word

"""Values of options and arguments: words of the command line, converted; faults are told in the words of files."""

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
"""Names of options for an angle."""
_IS_NOT: Mapping[type, str] = {int: "not a whole number", float: "not a number"}


def convert_if_given(command: TyperCommand | TyperGroup, context: typer.Context) -> None:
    """Have the options and arguments of a command convert what is given, and leave a default as it is.

    Typer's own conversion, which this takes the place of, is by pydantic, whose import takes longer than a start.
    """
    declared = {} if command.callback is None else inspect.signature(command.callback, eval_str=True).parameters
    for parameter in command.get_params(context):
        if isinstance(parameter, TyperOption | TyperArgument):
            annotation = declared[parameter.name].annotation if parameter.name in declared else None
            parameter.process_value = _Conversion(parameter, *_described(annotation))  # type: ignore[assignment, method-assign]


def _described(annotation: object) -> tuple[object, ParameterInfo]:
    """Return the type of a parameter, without None, and what else its annotation declares."""
    kind, info = getattr(annotation, "__origin__", annotation), ParameterInfo()
    for mark in getattr(annotation, "__metadata__", ()):
        info = mark if isinstance(mark, ParameterInfo) else info
    if isinstance(kind, UnionType):
        kind = next(each for each in get_args(kind) if each is not NoneType)
    return kind, info


@dataclass(frozen=True, slots=True)
class _Conversion:
    """Conversion of what is given to a parameter; while a shell completes words, they are left as they are."""

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
                raise ValueError(f"{word!r} is not a number. Write a point: {word.replace(',', '.')}.") from None
        else:
            if kind is float or value.is_integer():
                if least <= value <= most or (self.info.min, self.info.max) == (None, None):
                    return kind(value)
                problem = "out of range" if _NUMBER.fullmatch(word) else problem
        raise ValueError(f"{word!r} is {problem}. {wanted(kind, limits)}.")

    def _in_radians(self, word: str) -> str:
        """Return a number of radians for an angle with a unit; print a doubt about one that has none."""
        radians = radians_of(word)
        if radians is not None:
            return repr(radians)
        doubt = doubt_about(word, float(word)) if _NUMBER.fullmatch(word) else None
        if doubt is not None:
            problem, remedy = doubt
            note(f"{self.parameter.opts[0]}: {problem}. {remedy}.")
        return word

"""Groups of commands."""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from typer._click.core import ParameterSource  # typer's own copy of click
from typer._click.exceptions import BadParameter
from typer._coercion import RuntimeParam, build_runtime_param
from typer.core import TyperArgument, TyperGroup, TyperOption

from thbridge.files.yaml.angles import doubt_about, radians_of
from thbridge.files.yaml.declarations import wanted
from ui.command_line.outputs import share_outputs
from ui.command_line.terminal import faults_of_files, note

if TYPE_CHECKING:
    from typer._click.core import Command, Context
    from typer.core import _TyperParameter


_COMMA = re.compile(r"[-+]?\d*,\d+")
"""Decimal number with a comma."""
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,4})?")
_OF_ANGLES = re.compile(r"yaw|angle")
"""Names of options for an angle."""


class ConversionIfGiven(RuntimeParam):
    """Conversion of an option or argument that leaves a default as it is, and all words while a shell completes them.

    Typer converts by pydantic, which takes long to load.
    """

    def _coerce_value(self, value: object, param: "_TyperParameter", ctx: "Context") -> object:
        if ctx.resilient_parsing or ctx.get_parameter_source(param.name) is ParameterSource.DEFAULT:
            return value
        value = _in_radians(value, param)
        try:
            return build_runtime_param(param.type_descriptor).coerce(value, param, ctx)
        except BadParameter:
            words = [str(word) for word in (value if isinstance(value, list | tuple) else [value])]
            if (word := next(filter(_COMMA.fullmatch, words), None)) is not None:
                remedy = f"Write a point: {word.replace(',', '.')}"
                raise BadParameter(f"{word!r} is not a number. {remedy}.", ctx, param) from None
            kind = _KINDS.get(param.type_descriptor.annotation)
            if kind is None or not isinstance(value, str):
                raise
            problem = "is out of range" if _NUMBER.fullmatch(value) and _is_of(kind, value) else f"is {_IS_NOT[kind]}"
            raise BadParameter(f"{value!r} {problem}. {_wanted(kind, param)}.", ctx, param) from None


_KINDS: Mapping[object, type] = {int: int, int | None: int, float: float, float | None: float}
_IS_NOT: Mapping[type, str] = {int: "not a whole number", float: "not a number"}


def _is_of(kind: type, word: str) -> bool:
    """Return True for a number of this kind."""
    return kind is float or float(word).is_integer()


def _wanted(kind: type, param: "_TyperParameter") -> str:
    """Return a request to write a number that an option takes, in the words of files."""
    info = param.type_descriptor.parameter_info
    return wanted(kind, {"minimum": info.min, "maximum": info.max})


def _in_radians(value: object, param: "_TyperParameter") -> object:
    """Return what is given to an option with its angle, the last of three numbers or the only one, in radians."""
    if param.type_descriptor.annotation == tuple[float, float, float] and isinstance(value, list | tuple):
        return [*value[:-1], _radians_in(str(value[-1]), param)]
    return _radians_in(value, param) if isinstance(value, str) and _OF_ANGLES.search(param.name or "") else value


def _radians_in(word: str, param: "_TyperParameter") -> str:
    radians = radians_of(word)
    if radians is not None:
        return repr(radians)
    doubt = doubt_about(word, float(word)) if _NUMBER.fullmatch(word) else None
    if doubt is not None:
        problem, remedy = doubt
        note(f"{param.opts[0]}: {problem}. {remedy}.")
    return word


class CommandGroup(TyperGroup):
    """Commands, and the flags before them; what is not given is not converted."""

    def parse_args(self, ctx: "Context", args: list[str]) -> list[str]:
        """Take the flags."""
        _convert_if_given(self, ctx)
        return super().parse_args(ctx, args)

    def resolve_command(self, ctx: "Context", args: list[str]) -> "tuple[str | None, Command | None, list[str]]":
        """Find the command."""
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None:
            _convert_if_given(command, ctx)
        return name, command, rest

    def invoke(self, ctx: "Context") -> object:
        """Carry a command out; faults of files that it does not tell end in a message, too."""
        with faults_of_files():
            return super().invoke(ctx)


def _convert_if_given(command: "Command", ctx: "Context") -> None:
    for parameter in command.get_params(ctx):
        if isinstance(parameter, TyperOption | TyperArgument):
            described = parameter.type_descriptor
            parameter._runtime_param = ConversionIfGiven(described.parameter_info, described.annotation)


class SharingGroup(CommandGroup):
    """Commands whose outputs others of the machine may read, as the account's umask says."""

    def invoke(self, ctx: "Context") -> object:
        """Carry a command out."""
        share_outputs()
        return super().invoke(ctx)

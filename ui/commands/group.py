"""Groups of commands."""

from typing import TYPE_CHECKING

from typer._coercion import RuntimeParam
from typer.core import TyperArgument, TyperGroup, TyperOption

if TYPE_CHECKING:
    from typer._click.core import Command, Context  # typer's own copy of click


class AsTyped(RuntimeParam):
    """Conversion of an option or argument that leaves it as it was typed."""

    def _coerce_value(self, value: object, param: object, ctx: object) -> object:
        return value


class CommandGroup(TyperGroup):
    """Commands, and the flags before them. It converts no value in vain: typer would load pydantic for that."""

    def parse_args(self, ctx: "Context", args: list[str]) -> list[str]:
        """Take flags that are not given for False, which needs no conversion, where None does."""
        for parameter in self.get_params(ctx):
            parameter.default = False
        return super().parse_args(ctx, args)

    def resolve_command(self, ctx: "Context", args: list[str]) -> "tuple[str | None, Command | None, list[str]]":
        """Find a command; when a shell completes its words, they stay as they are typed."""
        name, command, rest = super().resolve_command(ctx, args)
        if ctx.resilient_parsing and command is not None:
            for parameter in command.get_params(ctx):
                if isinstance(parameter, TyperOption | TyperArgument):
                    described = parameter.type_descriptor
                    parameter._runtime_param = AsTyped(described.parameter_info, described.annotation)
        return name, command, rest

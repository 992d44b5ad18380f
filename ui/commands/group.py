"""Groups of commands."""

from typing import TYPE_CHECKING

from typer.core import TyperGroup

if TYPE_CHECKING:
    from typer._click.core import Context  # typer's own copy of click


class CommandGroup(TyperGroup):
    """Commands, and the flags before them."""

    def parse_args(self, ctx: "Context", args: list[str]) -> list[str]:
        """Take flags that are not given for False: typer would load pydantic, to convert their None."""
        for parameter in self.get_params(ctx):
            parameter.default = False
        return super().parse_args(ctx, args)

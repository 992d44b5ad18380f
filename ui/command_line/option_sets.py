"""Sets of options: dataclasses that several commands use as one parameter."""

import dataclasses
import inspect
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, cast, get_type_hints

P = ParamSpec("P")


def with_option_sets(function: Callable[P, None]) -> Callable[P, None]:
    """Return a command in which each parameter that is a dataclass is replaced by one option for each of its fields.

    A field declares its option in the same form as a parameter of a command.
    """
    sets: dict[str, type] = {}
    options: list[inspect.Parameter] = []
    for name, parameter in inspect.signature(function, eval_str=True).parameters.items():
        kind = parameter.annotation
        if not dataclasses.is_dataclass(kind):
            options.append(parameter.replace(kind=parameter.KEYWORD_ONLY))
            continue
        sets[name] = cast(type, kind)
        hints = get_type_hints(kind, include_extras=True)
        for field in dataclasses.fields(kind):
            default = parameter.empty if field.default is dataclasses.MISSING else field.default
            options.append(
                inspect.Parameter(field.name, parameter.KEYWORD_ONLY, default=default, annotation=hints[field.name])
            )

    @wraps(function)
    def command(*positional: P.args, **given: P.kwargs) -> None:
        for name, kind in sets.items():
            given[name] = kind(**{field.name: given.pop(field.name) for field in dataclasses.fields(kind)})
        function(*positional, **given)

    command.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    return command

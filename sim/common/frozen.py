"""Frozen dataclasses, created twice as fast as usual: for messages and states made thousands of times per second.

A frozen dataclass refuses assignments even in its own `__init__`. So `__init__` usually calls
`object.__setattr__` for each field. Here `__init__` calls the setters of the slots directly, which is faster.
"""

from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from typing import TypeVar, dataclass_transform

T = TypeVar("T")


@dataclass_transform(frozen_default=True)
def frozen(*, eq: bool = True) -> Callable[[type[T]], type[T]]:
    """Make a dataclass that is frozen and has slots. Its fields may have defaults but no default factories.

    Args:
        eq: False for classes whose instances are equal only to themselves.
    """

    def made(plain: type[T]) -> type[T]:
        kind = dataclass(frozen=True, slots=True, eq=eq)(plain)
        known: dict[str, object] = {}
        parameters, body = ["self"], []
        for field in fields(kind):  # type: ignore[arg-type]  # a dataclass now
            known[f"set_{field.name}"] = kind.__dict__[field.name].__set__
            parameters.append(field.name)
            if field.default is not MISSING:
                known[f"default_{field.name}"] = field.default
                parameters[-1] += f"=default_{field.name}"
            body.append(f"set_{field.name}(self, {field.name})")
        if hasattr(kind, "__post_init__"):
            body.append("self.__post_init__()")
        exec(f"def __init__({', '.join(parameters)}): {'; '.join(body)}", known)  # as dataclass does
        known["__init__"].__qualname__ = f"{kind.__qualname__}.__init__"  # type: ignore[attr-defined]
        kind.__init__ = known["__init__"]  # type: ignore[assignment]
        return kind

    return made

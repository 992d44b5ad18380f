"""JSON from files and messages, which other programs may have written."""

import json
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


def _deep_as_value_error(parse: Callable[P, T]) -> Callable[P, T]:
    @wraps(parse)
    def parsed(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            return parse(*args, **kwargs)
        except RecursionError:
            raise ValueError("JSON nested too deeply") from None

    return parsed


json_of = _deep_as_value_error(json.loads)
"""Parser like `json.loads`, which also raises ValueError if nesting exhausts the parser's stack."""

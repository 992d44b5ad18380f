"""Values of parameters that only `make test-slow` tests, because other values take the same path through the
program."""

import pytest


def slow(*values: object) -> list[object]:
    """Return the values of a parameter, each marked as slow; tuples are values of several parameters."""
    return [
        pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.slow) for value in values
    ]

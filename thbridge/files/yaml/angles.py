"""Angles as people write them: in radians, or with a unit, such as `90deg`, `deg(90)` and `rad(pi/2)`.

The forms with brackets come from rosparam (yaml loader of roslib, `rad(...)` and `deg(...)`).
"""

import math
import re

_CALLED = re.compile(r"(deg|rad)\((.*)\)")
_SUFFIXED = re.compile(r"([-+\d.eE]+)\s*(deg|rad|°)")
_FACTOR = r"(?:\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+|pi)"
_PRODUCT = re.compile(rf"\s*([-+]?)\s*({_FACTOR}(?:\s*[*/]\s*{_FACTOR})*)\s*")
_WHOLE = re.compile(r"[-+]?\d+")
WHOLE = 3
"""Minimum whole number of radians that looks like degrees. Angles such as pi are not written as whole numbers."""


def radians_of(text: str) -> float | None:
    """Return the radians of an angle with a unit, or None for any other text."""
    if called := _CALLED.fullmatch(text):
        unit, number = called[1], called[2]
    elif suffixed := _SUFFIXED.fullmatch(text):
        number, unit = suffixed[1], suffixed[2]
    else:
        return None
    value = product(number)
    return value if value is None or unit == "rad" else math.radians(value)


def product(text: str) -> float | None:
    """Return the value of a product or quotient of numbers and pi, or None for any other text."""
    found = _PRODUCT.fullmatch(text)
    if found is None:
        return None
    value = -1.0 if found[1] == "-" else 1.0
    for sign, factor in re.findall(rf"([*/]?)\s*({_FACTOR})", found[2]):
        number = math.pi if factor == "pi" else float(factor)
        if sign == "/" and number == 0.0:
            return None
        value = value / number if sign == "/" else value * number
    return value


def doubt_about(text: str, radians: float) -> tuple[str, str] | None:
    """Return the reason why a number of radians looks like degrees, and the remedy; None if it does not.

    Args:
        text: the number as it is written.
        radians: its value.
    """
    within = math.remainder(radians, math.tau)
    if abs(radians) > math.tau:
        problem = (
            f"{text} rad is more than a full turn; it is read as {within:.4g} rad ({math.degrees(within):.4g} degrees)"
        )
        return problem, f"Write {text}deg if degrees are meant, or else {within:.4g}"
    if _WHOLE.fullmatch(text) and abs(radians) >= WHOLE:
        problem = f"{text} rad is {math.degrees(radians):.4g} degrees"
        return problem, f"Write {text}deg if degrees are meant"
    return None


def doubt_about_rate(text: str, rate: float) -> tuple[str, str] | None:
    """Return the reason why a turn rate, rad/s, looks like degrees per second, and the remedy; None if it does not."""
    if abs(rate) <= math.tau:
        return None
    problem = f"{text} rad/s is {abs(rate) / math.tau:.1f} turns per second"
    return problem, f"Write {math.radians(rate):.4g} if degrees per second are meant"

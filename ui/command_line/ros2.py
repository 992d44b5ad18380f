"""Options of ROS 2 graphs: carriers, and the packages that they need."""

from __future__ import annotations

from importlib.util import find_spec

from ui.command_line.terminal import BAD_INPUT, fail


def check_zenoh(option: str) -> None:
    """End the program if the packages for zenoh are missing. `option` is the option or command that needs them."""
    missing = [package for package, module in _PACKAGES.items() if find_spec(module) is None]
    if missing:
        what = " and ".join(missing)
        verb = "is" if len(missing) == 1 else "are"
        fail(BAD_INPUT, f"{option}: {what} {verb} not installed. Run: pip install 'thbridge[ros2]'")


_PACKAGES = {"eclipse-zenoh": "zenoh", "xxhash": "xxhash"}
"""Packages of the extra `ros2`, and their modules."""

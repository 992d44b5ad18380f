"""The source of ROS's own filter and planner, which are measured beside ours where it is at hand."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def navigation() -> Path | None:
    """A checkout of github.com/ros-planning/navigation, named by NAVIGATION_SRC; without it ROS's is not measured."""
    source = os.environ.get("NAVIGATION_SRC")
    return Path(source) if source else None

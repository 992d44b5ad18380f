"""The source of ROS's own filter and planner, which are measured beside ours where it is at hand."""

import os
from pathlib import Path

import pytest

from tests.bench.robots.amcl_peer import build_amcl


@pytest.fixture(scope="session")
def navigation() -> Path | None:
    """A checkout of github.com/ros-planning/navigation, named by NAVIGATION_SRC; without it ROS's is not measured."""
    source = os.environ.get("NAVIGATION_SRC")
    return Path(source) if source else None


@pytest.fixture(scope="session")
def amcl_peer(navigation: Path | None, tmp_path_factory: pytest.TempPathFactory) -> Path | None:
    """ROS's filter, built as ROS builds it for release; None without its source."""
    return None if navigation is None else build_amcl(navigation / "amcl", tmp_path_factory.mktemp("amcl"))

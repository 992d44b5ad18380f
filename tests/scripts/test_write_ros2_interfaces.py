"""The ROS 2 package of our own messages agrees with the code."""

import importlib.util

from tests.support.project import ROOT

SCRIPT = ROOT / "scripts" / "write_ros2_interfaces.py"
PACKAGE = ROOT / "docs" / "launch" / "thbridge_msgs"


def test_the_package_is_up_to_date() -> None:
    spec = importlib.util.spec_from_file_location("write_ros2_interfaces", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = {str(file.relative_to(PACKAGE)): file.read_text() for file in PACKAGE.rglob("*") if file.is_file()}
    assert module.own_package() == written, "python scripts/write_ros2_interfaces.py"

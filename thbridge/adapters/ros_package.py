"""Our message types as a ROS package, for tools that know types only from packages."""

from pathlib import Path

from thbridge.adapters.errors import BadFile
from thbridge.ros.types import OWN_TEXTS

PACKAGE = "thbridge_msgs"

_PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="2">
  <name>thbridge_msgs</name>
  <version>0.1.0</version>
  <description>Messages of the treasure hunt: session, game events, score, utterances, inputs</description>
  <maintainer email="maintainers@thbridge.invalid">thbridge</maintainer>
  <license>Proprietary</license>
  <buildtool_depend>catkin</buildtool_depend>
  <build_depend>message_generation</build_depend>
  <depend>std_msgs</depend>
  <exec_depend>message_runtime</exec_depend>
</package>
"""

_CMAKE = """\
cmake_minimum_required(VERSION 3.0.2)
project(thbridge_msgs)
find_package(catkin REQUIRED COMPONENTS message_generation std_msgs)
add_message_files(DIRECTORY msg)
generate_messages(DEPENDENCIES std_msgs)
catkin_package(CATKIN_DEPENDS message_runtime std_msgs)
"""


def write_package(folder: Path) -> Path:
    """Write the catkin package `thbridge_msgs` into a folder, over an older one.

    Returns:
        The package's folder.

    Raises:
        BadFile: it cannot be written.
    """
    package = folder / PACKAGE
    try:
        (package / "msg").mkdir(parents=True, exist_ok=True)
        (package / "package.xml").write_text(_PACKAGE_XML, encoding="utf-8")
        (package / "CMakeLists.txt").write_text(_CMAKE, encoding="utf-8")
        for msgtype, text in OWN_TEXTS.items():
            (package / "msg" / f"{msgtype.partition('/')[2]}.msg").write_text(text, encoding="utf-8")
    except OSError as error:
        problem = f"it cannot be written ({error.strerror})"
        raise BadFile(package, None, None, problem, "name a folder that may be written to") from error
    return package

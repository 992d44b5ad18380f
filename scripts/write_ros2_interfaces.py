"""Write the ROS 2 package of our own messages, `docs/launch/thbridge_msgs`, which colcon builds.

python scripts/write_ros2_interfaces.py [FOLDER]
python scripts/write_ros2_interfaces.py --for-tests FOLDER

With --for-tests, write the packages that have no wheel for rclpy: our own, and the types of nav2_msgs and tf2_msgs
that we use.
"""

import argparse
from pathlib import Path

from thbridge.ros2.interface_texts import KILTED_TEXTS

ROOT = Path(__file__).parents[1]

OWN = "thbridge_msgs"
FOR_TESTS = (OWN, "nav2_msgs", "tf2_msgs")

PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>thbridge_msgs</name>
  <version>0.1.0</version>
  <description>Messages of the treasure hunt: session, events, score, dialogues, inputs</description>
  <maintainer email="maintainers@thbridge.invalid">thbridge</maintainer>
  <license>Proprietary</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>std_msgs</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(thbridge_msgs)
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(std_msgs REQUIRED)
rosidl_generate_interfaces(${{PROJECT_NAME}}
{files}
  DEPENDENCIES std_msgs
)
ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""


def definitions(package: str) -> dict[str, str]:
    """Return the files of a package's types, by path in the package."""
    named = ((name.split("/"), text) for name, text in KILTED_TEXTS.items())
    return {f"{kind}/{name}.{kind}": f"{text.rstrip()}\n" for (owner, kind, name), text in named if owner == package}


def own_package() -> dict[str, str]:
    """Return the files of the package of our own messages, by path in the package."""
    messages = definitions(OWN)
    files = "\n".join(f'  "{path}"' for path in messages)
    return {"package.xml": PACKAGE_XML, "CMakeLists.txt": CMAKE.format(files=files), **messages}


def write(folder: Path, files: dict[str, str]) -> None:
    """Write the files of a package."""
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", default=ROOT / "docs" / "launch")
    parser.add_argument("--for-tests", action="store_true")
    options = parser.parse_args()
    if options.for_tests:
        for package in FOR_TESTS:
            write(options.folder / package, definitions(package))
    else:
        write(options.folder / OWN, own_package())

"""ROS packages with message types that an installed ROS lacks, for tools that need them as packages."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from thbridge.files.disk.synced import make_folder
from thbridge.files.disk.whole import new_folder, write_whole
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.ros.definitions import ROS_SHARES
from thbridge.ros.messages.definition_texts import ROS_TEXTS
from thbridge.ros.messages.types import MAVROS_TYPES, OWN_TEXTS

_PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="2">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>{description}</description>
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
project({name})
find_package(catkin REQUIRED COMPONENTS message_generation std_msgs)
add_message_files(DIRECTORY msg)
generate_messages(DEPENDENCIES std_msgs)
catkin_package(CATKIN_DEPENDS message_runtime std_msgs)
"""


@dataclass(frozen=True, slots=True)
class _Package:
    name: str
    description: str
    texts: Mapping[str, str]


_OWN = _Package("thbridge_msgs", "Messages of the treasure hunt: session, events, score, dialogues, inputs", OWN_TEXTS)
_MAVROS = _Package(
    "mavros_msgs",
    "The two messages of mavros that thbridge records, for a ROS without mavros",
    {msgtype: ROS_TEXTS[msgtype] for msgtype in MAVROS_TYPES},
)


def write_packages(folder: Path) -> tuple[Path, ...]:
    """Write the catkin package `thbridge_msgs` to a folder, and `mavros_msgs` if ROS lacks it; replace older ones.

    Returns:
        The packages' folders.

    Raises:
        BadFile: a package cannot be written.
    """
    has_mavros = any((share / _MAVROS.name).is_dir() for share in ROS_SHARES)
    return tuple(_written(package, folder) for package in (_OWN, *(() if has_mavros else (_MAVROS,))))


def _written(package: _Package, parent: Path) -> Path:
    folder = parent / package.name
    files = {
        "package.xml": _PACKAGE_XML.format(name=package.name, description=package.description),
        "CMakeLists.txt": _CMAKE.format(name=package.name),
        **{f"msg/{msgtype.partition('/')[2]}.msg": text for msgtype, text in package.texts.items()},
    }
    remedy = "name a folder with write permission"
    if folder.exists():
        _fill(folder, files, remedy)
    else:
        with new_folder(folder, remedy) as new:
            _fill(new, files, remedy)
    return folder


def _fill(folder: Path, files: Mapping[str, str], remedy: str) -> None:
    try:
        make_folder(folder / "msg")
    except OSError as error:
        raise BadFile(folder, f"it cannot be written ({reason_of(error)})", remedy) from None
    for name, text in files.items():
        write_whole(folder / name, text.encode(), remedy)

"""rosbridge_suite of ROS 1 from its sources, run by Debian's Python: neither Debian nor PyPI has it."""

import os
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tests.peers.ros_programs import PYTHON, Ros, knows
from tests.support.programs.peer_programs import run_peer

SOURCES = Path(os.environ.get("ROSBRIDGE_SRC", ""))
ROSLIBPY = Path(__file__).parents[3] / ".peers" / "roslibpy" / "bin" / "python"

NEEDS_ROSBRIDGE = pytest.mark.skipif(
    "ROSBRIDGE_SRC" not in os.environ or not knows("rospy", "tornado", "autobahn", "twisted", "bson"),
    reason="rosbridge_suite is no package of Debian's or PyPI's: name a checkout of its branch ros1 by ROSBRIDGE_SRC, "
    "and install python3-tornado python3-autobahn python3-twisted python3-bson",
)

MANIFEST = """<package format="2"><name>{0}</name><version>1.0.0</version><description>{0}</description>
<maintainer email="nobody@example.org">nobody</maintainer><license>BSD</license></package>"""
AUTHENTICATION = "string mac\n---\nbool authenticated\n"
"""Stands for rosauth's service, which rosbridge imports and does not call."""
TYPES = "nav_msgs sensor_msgs move_base_msgs std_msgs geometry_msgs actionlib_msgs tf2_msgs rosgraph_msgs thbridge_msgs"


def _generate(generator: str, package: str, files: Path, out: Path, *, kind: str) -> None:
    out.mkdir(parents=True)
    (out.parent / "__init__.py").touch()
    tool, own = (
        f"/usr/lib/genpy/{generator}",
        [f"-I{package}:{files.parent / 'msg'}", "-Istd_msgs:/usr/share/std_msgs/msg"],
    )
    run_peer([PYTHON, tool, "-p", package, *own, "-o", out, *files.glob(f"*.{kind}")]).check_returncode()
    run_peer([PYTHON, "/usr/lib/genpy/genmsg_py.py", "--initpy", "-p", package, "-o", out]).check_returncode()


def _install(folder: Path) -> dict[str, str]:
    """Generate rosbridge's types, and return the variables by which its nodes find them and all packages."""
    modules, packages = folder / "modules", folder / "packages"
    shutil.copytree(SOURCES / "rosapi" / "src" / "rosapi", modules / "rosapi")
    (folder / "rosauth" / "srv").mkdir(parents=True)
    (folder / "rosauth" / "srv" / "Authentication.srv").write_text(AUTHENTICATION)
    for package in ("rosbridge_msgs", "rosapi"):
        _generate("genmsg_py.py", package, SOURCES / package / "msg", modules / package / "msg", kind="msg")
    for package, sources in (("rosapi", SOURCES / "rosapi"), ("rosauth", folder / "rosauth")):
        _generate("gensrv_py.py", package, sources / "srv", modules / package / "srv", kind="srv")
    # Debian's packages of messages have no manifests, which rosbridge wants of each.
    for package in (*TYPES.split(), "rosapi", "rosbridge_msgs"):
        (packages / package).mkdir(parents=True)
        (packages / package / "package.xml").write_text(MANIFEST.format(package))
    paths = (modules, SOURCES / "rosbridge_library" / "src", SOURCES / "rosbridge_server" / "src")
    return {"PYTHONPATH": ":".join(map(str, paths)), "ROS_PACKAGE_PATH": str(packages)}


@contextmanager
def rosbridge(ros: Ros, folder: Path, port: int) -> Iterator[None]:
    """Run rosbridge's server and rosapi at the master of a session."""
    ros.environment |= _install(folder)
    server = SOURCES / "rosbridge_server" / "scripts" / "rosbridge_websocket.py"
    with ExitStack() as running:
        running.enter_context(ros.running(PYTHON, str(SOURCES / "rosapi" / "scripts" / "rosapi_node")))
        bridge = running.enter_context(ros.running(PYTHON, str(server), f"_port:={port}", "_address:=127.0.0.1"))
        running.callback(bridge.kill)  # Asked to end, it waits for its clients.
        assert bridge.stdout is not None
        for line in bridge.stdout:
            if "Rosbridge WebSocket server started" in line:
                break
        else:
            raise AssertionError("rosbridge did not start")
        yield

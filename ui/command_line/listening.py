"""Addresses of a session in addition to its text server: ROS graph, researchers' windows, ground stations."""

import dataclasses
import os
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.ros2graph.values.address import CarrierKind, Ros2Address
from thbridge.rosgraph.sockets.joining import GraphAddress, MasterPresence, is_master_uri
from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_URI, WATCH_PORT, ListeningAddress, parse_address
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.sockets.keys import RingKeys
from thbridge.study.study_file import Study
from ui.command_line.keys import watch_keys
from ui.command_line.options import Ros2Options, RosOptions, WatchOptions
from ui.command_line.ros2 import check_zenoh
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note

if TYPE_CHECKING:
    from thbridge.mavlink.sockets.server import MavlinkPorts


def graph_of(options: RosOptions, open_to: Sequence[str] = ()) -> GraphAddress | None:
    """Return the ROS graph to join and the networks that may reach it. If None, the session joins no graph."""
    if not options.join:
        return None
    uri = options.ros_master or ROS_MASTER_URI
    if not is_master_uri(uri):
        remedy = f"Write, for example, {ROS_MASTER_URI}"
        fail(BAD_INPUT, f"--ros-master: {uri!r} is not the address of a ROS master. {remedy}.")
    return GraphAddress(uri, options.ros_host or LOCALHOST, Admission.to(open_to))


def ros2_of(study: Study, options: Ros2Options) -> Ros2Address | None:
    """Return the ROS 2 graph to join; if None, the session joins no ROS 2 graph."""
    if not options.join_ros2:
        if options.carrier is not None:
            fail(BAD_INPUT, "--carrier requires a ROS 2 graph. Add --ros2, or omit --carrier.")
        # A domain from the environment is meant for all programs.
        if options.ros2_domain is not None and str(options.ros2_domain) != os.environ.get("ROS_DOMAIN_ID"):
            fail(BAD_INPUT, "--ros2-domain requires a ROS 2 graph. Add --ros2, or omit --ros2-domain.")
        return None
    address = study.ros2.address
    domain = address.domain if options.ros2_domain is None else options.ros2_domain
    address = dataclasses.replace(address, domain=domain, carrier=options.carrier or address.carrier)
    if address.carrier is CarrierKind.ZENOH:
        check_zenoh("ros2: carrier: zenoh" if options.carrier is None else "--carrier zenoh")
    return address


def watch_of(
    study: Study, file: Path | None, options: WatchOptions, ring: RingKeys | None = None
) -> WatchAddress | None:
    """Return the address for researchers' windows; if None, no window can connect.

    Options override the study.

    Args:
        study: the study, as changed by options.
        file: file of the study.
        options: options of the command.
        ring: keys of the session. They also admit windows, unless there are separate keys for windows.
    """
    section = study.watch
    host, port = section.host, section.port
    at, key = options.watch, options.watch_key
    if at is not None:
        given, _, number = at.rpartition(":")
        if not number.isdecimal() or int(number) > 65535 or (":" in at and not given):
            fail(BAD_INPUT, f"--watch: {at!r} is not an address. Write a port, such as {WATCH_PORT}, or HOST:PORT.")
        host, port = given.strip("[]") or host, int(number)
    if port is None:
        if key is not None:
            fail(BAD_INPUT, f"--watch-key requires --watch PORT. Add --watch {WATCH_PORT}, or omit --watch-key.")
        return None
    # Imported here, because sessions without links do not need MAVLink.

    beside = Path() if file is None else file.parent
    path = key or (None if section.key is None else beside / section.key)
    return WatchAddress(host, port, ring if path is None else watch_keys(path))


def check_foxglove(port: int | None) -> None:
    """End the program if a port for Foxglove is given, but the package foxglove-sdk is missing."""
    if port is not None and find_spec("foxglove") is None:
        fail(BAD_INPUT, "--foxglove: foxglove-sdk is not installed. Run: pip install 'thbridge[foxglove]'")


def ports_of(study: Study, file: Path | None, key: Path | None) -> "MavlinkPorts | None":
    """Return the links for ground stations; if None, MAVLink is off. If `key` is given, it replaces the study's key."""
    section = study.mavlink
    if not section.on:
        if key is not None:
            fail(BAD_INPUT, "--signing-key: MAVLink is off in this session. Add --mavlink, or omit --signing-key.")
        return None
    # Imported here, because sessions without links do not need MAVLink.
    from thbridge.mavlink.files.signing_key import read_signing_key  # noqa: PLC0415
    from thbridge.mavlink.files.signing_timestamps import TimestampFile  # noqa: PLC0415
    from thbridge.mavlink.sockets.server import MavlinkPorts  # noqa: PLC0415

    beside = Path() if file is None else file.parent
    path = key or (None if section.signing_key is None else beside / section.signing_key)
    with bad_input():
        secret = None if path is None else read_signing_key(path)
    listens = None if section.udp_listen is None else parse_address(section.udp_listen)
    tcp = None if section.tcp is None else parse_address(section.tcp)
    store = None if path is None else TimestampFile(path)
    return MavlinkPorts(section.targets, tcp, secret, listens, Admission.to(study.open_to), store)


def hosts_of(graph: GraphAddress | None, quiet: bool = False, ros2: Ros2Address | None = None) -> StartupCallbacks:
    """Return callbacks that report the start of the ROS graphs and of the ports for watching, MAVLink and Foxglove.

    If a start fails, its callback ends the program.
    """

    def joined(master: MasterPresence | CannotListen) -> None:
        if isinstance(master, CannotListen):
            fail(BAD_INPUT, f"ROS: {master}")
        if not quiet and graph is not None:
            note(f"ROS: {master.value} ({graph.master_uri}).")

    def watched(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, f"--watch: {where}")
        if not quiet:
            note(f"Researchers can connect to {where.host}:{where.port}.")

    def linked(names: Sequence[str] | CannotListen) -> None:
        if isinstance(names, CannotListen):
            fail(BAD_INPUT, f"MAVLink: {names}")
        if not quiet:
            note(f"MAVLink links of the robots: {', '.join(names) or 'none'}.")

    def shown(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, f"--foxglove: {where}")
        if not quiet:
            note(f"Foxglove can connect to ws://{where.host}:{where.port}.")

    def joined_ros2(rivals: Sequence[str] | CannotListen | CannotReach) -> None:
        if isinstance(rivals, CannotListen | CannotReach):
            fail(BAD_INPUT, f"ROS 2: {rivals}")
        if rivals:
            problem = f"{rivals[0]}, a node of another program in this domain, already speaks for these robots"
            fail(BAD_INPUT, f"ROS 2: {problem}. Stop it, or choose another domain with --ros2-domain.")
        if not quiet:
            note(f"ROS 2: {ros2}.")

    return StartupCallbacks(joined, watched, linked, shown, joined_ros2)

"""Settings of a session: the study, and the ports and graphs that options add to it."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path

from thbridge.app.compose import StudySetting, read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.files.errors import BadFile
from thbridge.files.signing_key import read_signing_key
from thbridge.files.yaml.tree import read_text
from thbridge.sockets.addresses import (
    LOCALHOST,
    ROS_MASTER_URI,
    WATCH_PORT,
    Address,
    ListeningAddress,
    parse_address,
    parse_target,
)
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.mavlink.server import MavlinkPorts
from thbridge.sockets.rosgraph.joining import GraphAddress, MasterPresence, is_master_uri
from thbridge.study.study_file import Study, load_study
from thbridge.wire.mavlink.options import AutopilotIdentity
from ui.terminal import BAD_INPUT, bad_input, fail, note


def study_of(file: Path | None, changes: Mapping[str, object]) -> Study:
    """The study of a file, or the default one, with what options change; None changes nothing."""
    study = Study()
    if file is not None:
        with bad_input():
            loaded = load_study(file)
        for notice in loaded.notices:
            note(notice)
        study = loaded.value
    given = {key: value for key, value in changes.items() if value is not None}
    changed = dataclasses.replace(study, **given)  # type: ignore[arg-type]  # the options have their types from typer
    if any(number > changed.robots for number in changed.each):
        problem = f"--robots {changed.robots}: the study has software for robot {max(changed.each)} (`each`)"
        fail(BAD_INPUT, f"{problem}. Give more robots, or delete it from the study.")
    return changed


def with_server(study: Study, host: str | None, port: int | None) -> Study:
    """The study with another address to listen on; None changes nothing."""
    given = study.server
    changed = dataclasses.replace(
        given, host=given.host if host is None else host, port=given.port if port is None else port
    )
    return dataclasses.replace(study, server=changed)


def setting_of(study: Study, file: Path | None) -> StudySetting:
    """Everything the study names; paths start from the folder of its file."""
    with bad_input():
        return read_setting(study, Path() if file is None else file.parent)


def graph_of(ros: bool, master: str | None, host: str | None) -> GraphAddress | None:
    """Return the ROS graph to join; None where that is not wanted."""
    if not ros:
        return None
    uri = master or ROS_MASTER_URI
    if not is_master_uri(uri):
        fail(BAD_INPUT, f"--ros-master: {uri!r} is not a master's address. Write {ROS_MASTER_URI}, for example.")
    return GraphAddress(uri, host or LOCALHOST)


def watch_of(study: Study, file: Path | None, at: str | None, key: Path | None) -> WatchAddress | None:
    """Return the address for researchers' windows, None for none; the study gives it where options do not."""
    section = study.watch
    host, port = section.host, section.port
    if at is not None:
        given, _, number = at.rpartition(":")
        if not number.isdecimal() or int(number) > 65535 or (":" in at and not given):
            fail(BAD_INPUT, f"--watch: {at!r} is no address. Write a port, such as {WATCH_PORT}, or HOST:PORT.")
        host, port = given.strip("[]") or host, int(number)
    if port is None:
        if key is not None:
            fail(BAD_INPUT, f"--watch-key: nobody may watch. Add --watch {WATCH_PORT}, or leave the option out.")
        return None
    beside = Path() if file is None else file.parent
    path = key or (None if section.key is None else beside / section.key)
    return WatchAddress(host, port, None if path is None else parse_key(path))


def with_mavlink(
    study: Study,
    on: bool | None = None,
    *,
    identity: AutopilotIdentity | None = None,
    udp: Sequence[str] | None = None,
    udp_listen: str | None = None,
    tcp: str | None = None,
    tlog: bool | None = None,
) -> Study:
    """The study with what options say of MAVLink; None changes nothing."""
    for option, text in (("--udp-listen", udp_listen), ("--tcp", tcp)):
        if text is not None and parse_address(text) is None:
            fail(BAD_INPUT, f"{option}: {text!r} is no address. Write HOST:PORT, such as 127.0.0.1:14550.")
    targets = None if udp is None else tuple(dict.fromkeys(udp))
    taken: set[Address] = set()
    for text in targets or ():
        target = parse_target(text)
        if target is None:
            fail(
                BAD_INPUT,
                f"--udp: {text!r} is no address. Write HOST:PORT, such as 127.0.0.1:14550, or HOST:PORT/ROBOT.",
            )
        if target.number is not None and target.number > study.robots:
            fail(BAD_INPUT, f"--udp: {text!r}: there is no robot {target.number}. There are {study.robots}.")
        if target.address in taken:
            fail(BAD_INPUT, f"--udp: {target.address} is there for other robots already. Give {text!r} another port.")
        taken.add(target.address)
    given = {"on": on, "identity": identity, "udp": targets, "udp_listen": udp_listen, "tcp": tcp, "tlog": tlog}
    changes = {key: value for key, value in given.items() if value is not None}
    section = dataclasses.replace(study.mavlink, **changes)  # type: ignore[arg-type]  # the options have their types
    unused = next((key for key in changes if key != "on"), None)
    if unused is not None and not section.on:
        option = unused.replace("_", "-")
        fail(BAD_INPUT, f"--{option}: the robots do not speak MAVLink. Add --mavlink, or leave the option out.")
    return dataclasses.replace(study, mavlink=section)


def ports_of(study: Study, file: Path | None, key: Path | None) -> MavlinkPorts | None:
    """Return the links for ground stations, None for none; `key` wins over the study's."""
    section = study.mavlink
    if not section.on:
        if key is not None:
            fail(BAD_INPUT, "--signing-key: the robots do not speak MAVLink. Add --mavlink, or leave the option out.")
        return None
    beside = Path() if file is None else file.parent
    path = key or (None if section.signing_key is None else beside / section.signing_key)
    with bad_input():
        secret = None if path is None else read_signing_key(path)
    listens = None if section.udp_listen is None else parse_address(section.udp_listen)
    return MavlinkPorts(section.targets, None if section.tcp is None else parse_address(section.tcp), secret, listens)


def parse_key(path: Path) -> str:
    """Return the key in a file."""
    with bad_input():
        key = next(iter(read_text(path).splitlines()), "").strip()
        if not key:
            raise BadFile(path, 1, None, "there is no key in this line", "write one, some random letters, into it")
    return key


def hosts_of(graph: GraphAddress | None, quiet: bool = False) -> StartupCallbacks:
    """Return callbacks that tell how graph, watch and MAVLink have started; each ends the program on failure."""

    def joined(master: MasterPresence | CannotListen) -> None:
        if isinstance(master, CannotListen):
            fail(BAD_INPUT, f"ROS: {master}")
        if not quiet and graph is not None:
            note(f"ROS: {master.value} ({graph.master_uri}).")

    def watched(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, f"--watch: {where}")
        if not quiet:
            note(f"Researchers can watch at {where.host}:{where.port}.")

    def linked(names: Sequence[str] | CannotListen) -> None:
        if isinstance(names, CannotListen):
            fail(BAD_INPUT, f"MAVLink: {names}")
        if not quiet:
            note(f"Robots speak MAVLink: {', '.join(names) or 'to nobody'}.")

    return StartupCallbacks(joined, watched, linked)

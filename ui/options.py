"""Options that commands share, and the study that they make."""

import dataclasses
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sim.common.kernels import is_compiled
from thbridge.app.compose import StudySetting, read_setting
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.files.errors import BadFile
from thbridge.files.map_files import read_grid
from thbridge.files.signing_key import read_signing_key
from thbridge.files.yaml.tree import read_text
from thbridge.recording.recordings import make_room, try_place
from thbridge.roles.bot_strategy import BotStrategy
from thbridge.sockets.addresses import (
    LOCALHOST,
    ROS_MASTER_URI,
    TEXT_SERVER_PORT,
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

StudyFile = Annotated[
    Path | None, typer.Argument(help="Study file (YAML); see `thbridge study init`. Options below win over it.")
]
StudyOption = Annotated[Path | None, typer.Option("--study", help="Study file (YAML).")]
# The bounds are those of the study file, so that the study in a bag can be read again.
Robots = Annotated[int | None, typer.Option(help="Size of the team.", min=1, max=64)]
MapName = Annotated[str | None, typer.Option("--map", help="Name of a map, or path of its folder (with a slash).")]
Seed = Annotated[
    int | None, typer.Option(help="Same seed, same study, same inputs: the same run.", min=0, max=2**31 - 1)
]
Port = Annotated[int | None, typer.Option(help="TCP port for other programs; 0 takes a free one.", min=0, max=65535)]
BagFile = Annotated[Path | None, typer.Option(help="Where to record. An older file is kept under a new name.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")]
Templates = Annotated[str | None, typer.Option(help="Name of a set of templates, or path of its folder.")]
ADDRESS = f"{LOCALHOST}:{TEXT_SERVER_PORT}"
Server = Annotated[str, typer.Option("--server", help="Where the text server is, HOST:PORT.", metavar="HOST:PORT")]
Ros = Annotated[bool, typer.Option("--ros", help="Take part in a ROS 1 graph; see docs/live-graph.md.")]
RosMaster = Annotated[
    str | None,
    typer.Option(
        "--ros-master",
        envvar="ROS_MASTER_URI",
        metavar="URI",
        help=f"The ROS master, by default {ROS_MASTER_URI}. Where none answers on this machine, this program is it.",
    ),
]
RosHost = Annotated[
    str | None,
    typer.Option(
        "--ros-host",
        envvar=["ROS_HOSTNAME", "ROS_IP"],
        help="Address for ROS nodes to reach this program, by default 127.0.0.1: who reaches it can drive robots.",
    ),
]

WatchAt = Annotated[
    str | None,
    typer.Option(
        "--watch",
        metavar="[HOST:]PORT",
        help=f"Let researchers' windows connect, for example at {WATCH_PORT}; see docs/watching.md.",
    ),
]
WatchKey = Annotated[
    Path | None,
    typer.Option("--watch-key", help="File whose first line whoever watches has to know. They see the truth."),
]
Mavlink = Annotated[
    bool | None,
    typer.Option("--mavlink/--no-mavlink", help="Make every robot a MAVLink rover; see docs/mavlink.md."),
]
MavlinkIdentity = Annotated[
    AutopilotIdentity | None,
    typer.Option("--identity", help="Whose autopilot robots say they have; QGroundControl commands only ardupilot's."),
]
MavlinkUdp = Annotated[
    list[str] | None,
    typer.Option(
        "--udp",
        metavar="HOST:PORT",
        help="Where a ground station listens, HOST:PORT/ROBOT for one robot alone; may be given several times.",
    ),
]
MavlinkUdpListen = Annotated[
    str | None,
    typer.Option(
        "--udp-listen", metavar="HOST:PORT", help="Where ground stations that speak first find robots by UDP."
    ),
]
MavlinkTcp = Annotated[
    str | None, typer.Option("--tcp", metavar="HOST:PORT", help="Where ground stations may connect by TCP.")
]
KeyFile = Annotated[
    Path | None,
    typer.Option("--signing-key", metavar="FILE", help="MAVLink frames are signed and verified with this file's key."),
]
TlogWanted = Annotated[
    bool | None, typer.Option("--tlog/--no-tlog", help="Also write all MAVLink frames into a .tlog beside the bag.")
]


class ColourScheme(StrEnum):
    """Colours of windows."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


LookOption = Annotated[ColourScheme, typer.Option("--look", help="Light or dark windows; `system`: as the desktop is.")]


class ParticipantKind(StrEnum):
    """Kind of participant: a person who types, or a simulated one by its strategy."""

    PERSON = "person"
    SUGGESTION = BotStrategy.SUGGESTION
    NEAREST = BotStrategy.NEAREST
    RANDOM = BotStrategy.RANDOM


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
        if target.robot is not None and target.robot >= study.robots:
            fail(BAD_INPUT, f"--udp: {text!r}: there is no robot {target.robot + 1}. There are {study.robots}.")
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


def make_ready(bag: Path, option: str = "--bag") -> None:
    """Check that a bag can be recorded where an option says, and move an older one out of the way."""
    if bag.suffix != ".bag" or bag.is_dir():
        fail(BAD_INPUT, f"{option}: {bag} is not the name of a bag. Give a file name that ends in .bag.")
    try:
        moved = make_room(bag)
        try_place(bag)
    except OSError as error:
        fail(BAD_INPUT, f"{bag}: cannot record there ({error.strerror}). Choose another file by {option}.")
    if moved is not None:
        note(f"The older recording is now {moved}.")


def make_copy_ready(copy: Path, recording: Path) -> None:
    """Check that --to names a place for the bag of a replay, and not the recording that is replayed."""
    if copy.resolve() == recording.resolve():
        fail(BAD_INPUT, f"--to: {copy} is the recording itself. Give another name.")
    make_ready(copy, "--to")


def announce_compiling() -> None:
    """Tell that the first start takes its time, where it does."""
    if not is_compiled():
        note("Compiling the simulator for this machine; only the first start takes this long, some 25 s.")


def write_report(bag: Path, page: Path, map_yaml: Path | None = None) -> None:
    """Make the report of a bag, on a map of its own if one is given.

    Raises:
        BadFile: the bag or the map cannot be read, or the page not be written.
    """
    # Half a second of imports that no other command needs.
    from thbridge.analysis.report.page import build_report  # noqa: PLC0415

    if page.exists() and bag.exists() and page.samefile(bag):
        raise BadFile(page, None, None, "this is the bag itself", "choose another file by --to")
    html = build_report(bag, None if map_yaml is None else read_grid(map_yaml))
    try:
        page.write_text(html, encoding="utf-8")
    except OSError as error:
        problem = f"it cannot be written ({error.strerror})"
        raise BadFile(page, None, None, problem, "choose another file by --to") from None
    note(f"Report: {page}")

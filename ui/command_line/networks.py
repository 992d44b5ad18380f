"""Connections from other machines: refused unless the study or an option names the networks that may connect."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from thbridge.ros2graph.values.address import CarrierKind
from thbridge.sockets.addresses import parse_address
from thbridge.sockets.admission import is_own, parse_network
from ui.command_line.terminal import BAD_INPUT, command, fail, note

if TYPE_CHECKING:
    from thbridge.app.listeners import WatchAddress
    from thbridge.ros2graph.values.address import Ros2Address
    from thbridge.rosgraph.sockets.joining import GraphAddress
    from thbridge.sockets.keys import RingKeys
    from thbridge.study.study_file import Study


def with_open_to(study: Study, networks: Sequence[str] | None) -> Study:
    """Return the study with the networks that options name; without networks, return it unchanged."""
    check_networks("--open-to", networks or ())
    return dataclasses.replace(study, open_to=tuple(networks)) if networks else study


def check_networks(option: str, networks: Sequence[str]) -> None:
    """End the program if one of an option's networks is invalid."""
    for text in networks:
        if parse_network(text) is None:
            remedy = "Write, for example, 10.0.0.0/24; 0.0.0.0/0 means all machines"
            fail(BAD_INPUT, f"{option}: {text!r} is not a network. {remedy}.")


def check_browsers(host: str, open_to: Sequence[str], *, encrypted: bool) -> None:
    """Do the same as `check_doors` for a server for browsers at a host; `encrypted` is True with TLS."""
    if is_own(host):
        return
    if not open_to:
        _refuse("browsers", host)
    if encrypted:
        note(f"Browsers in {', '.join(open_to)} can connect without a key (TLS).")
    else:
        _note_plain(open_to, ["browsers"])


def check_router(host: str, open_to: Sequence[str]) -> None:
    """Do the same as `check_doors` for a zenoh router at a host."""
    if is_own(host):
        return
    if not open_to:
        _refuse("the zenoh router", host)
    _note_plain(open_to, ["the zenoh router"])


def check_doors(
    study: Study,
    keys: RingKeys | None = None,
    watch: WatchAddress | None = None,
    graph: GraphAddress | None = None,
    ros2: Ros2Address | None = None,
    *,
    serves_text: bool = True,
) -> None:
    """End the program if other machines could connect without permission; otherwise print which machines may connect.

    Args:
        study: the study, as changed by options.
        keys: keys of programs and windows on other machines.
        watch: address for researchers' windows.
        graph: ROS graph that the session joins.
        ros2: ROS 2 graph that the session joins.
        serves_text: False for a program whose text server is elsewhere.
    """
    networks = ", ".join(study.open_to)
    plain, keyed = _exposed(_plain_doors(study, graph, ros2)), {}
    if serves_text and not is_own(study.server.host):
        if keys is not None:
            keyed["the text server"] = study.server.host
        if keys is None or networks:
            plain = {"the text server": study.server.host} | plain
    if plain and not networks:
        what, host = next(iter(plain.items()))
        _refuse(what, host)
    if watch is not None and not is_own(watch.host):
        if watch.keys is None or watch.keys.tls is None:
            problem = f"researchers' windows: any client at {watch.host} could see all data and command robots"
            make = command("keys", "new", "NAME")
            remedy = f"Create a key with `{make}` and add --watch-key keys, or listen on 127.0.0.1"
            fail(BAD_INPUT, f"{problem}. {remedy}.")
        keyed["researchers' windows"] = watch.host
    if keyed:
        note(f"These servers accept remote clients that present a key (TLS): {', '.join(keyed)}.")
    if plain:
        _note_plain(study.open_to, plain)


def _refuse(what: str, host: str) -> NoReturn:
    problem = f"{what}: other machines could reach {host}, but no network is allowed to connect"
    with_keys = " For programs that have a key, add --keys FOLDER instead." if what == "the text server" else ""
    remedy = "Add --open-to NETWORK (open_to in the study), such as 10.0.0.0/24, or listen on 127.0.0.1"
    fail(BAD_INPUT, f"{problem}. {remedy}.{with_keys}")


def _note_plain(networks: Iterable[str], what: Iterable[str]) -> None:
    known = ", ".join(networks)
    note(f"These servers accept clients from {known} without a key and without encryption: {', '.join(what)}.")


def _plain_doors(study: Study, graph: GraphAddress | None, ros2: Ros2Address | None) -> dict[str, str]:
    """Return the host of each server that requires no key, except the text server."""
    mavlink = study.mavlink
    hosts = {} if graph is None else {"ROS": graph.host}
    if ros2 is not None and ros2.carrier is CarrierKind.DDS:
        hosts["ROS 2"] = ros2.host
    if mavlink.on:
        listens = (("MAVLink by TCP", mavlink.tcp), ("MAVLink by UDP", mavlink.udp_listen))
        hosts |= {what: address.host for what, at in listens if at and (address := parse_address(at))}
    return hosts


def _exposed(hosts: Mapping[str, str]) -> dict[str, str]:
    return {what: host for what, host in hosts.items() if not is_own(host)}

"""Doors to other machines: refused unless the networks that may come are named, and told."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

from thbridge.sockets.addresses import parse_address
from thbridge.sockets.admission import is_own, parse_network
from ui.terminal import BAD_INPUT, fail, note

if TYPE_CHECKING:
    from thbridge.app.listeners import WatchAddress
    from thbridge.sockets.rosgraph.joining import GraphAddress
    from thbridge.study.study_file import Study


def with_open_to(study: Study, networks: Sequence[str] | None) -> Study:
    """Return the study with the networks that options name; None, or none, changes nothing."""
    for text in networks or ():
        if parse_network(text) is None:
            fail(
                BAD_INPUT, f"--open-to: {text!r} is no network. Write 10.0.0.0/24, for example; 0.0.0.0/0 is everybody."
            )
    return dataclasses.replace(study, open_to=tuple(networks)) if networks else study


def check_doors(
    study: Study, watch: WatchAddress | None = None, graph: GraphAddress | None = None, *, serves_text: bool = True
) -> None:
    """End the program where other machines could reach what nobody has opened to them; else tell what is open to whom.

    Args:
        study: with what options change in it.
        watch: address for researchers' windows.
        graph: the ROS graph to take part in.
        serves_text: False for a program whose text server is elsewhere.
    """
    mavlink = study.mavlink
    hosts = {"the text server": study.server.host} if serves_text else {}
    if watch is not None:
        hosts["researchers' windows"] = watch.host
    if graph is not None:
        hosts["ROS"] = graph.host
    if mavlink.on:
        listens = (("MAVLink by TCP", mavlink.tcp), ("MAVLink by UDP", mavlink.udp_listen))
        hosts |= {what: address.host for what, at in listens if at and (address := parse_address(at))}
    exposed = {what: host for what, host in hosts.items() if not is_own(host)}
    if not exposed:
        return
    if not study.open_to:
        what, host = next(iter(exposed.items()))
        problem = f"{what}: other machines could reach {host}, and no network is named that may"
        fail(BAD_INPUT, f"{problem}. Add --open-to NETWORK (open_to in the study), such as 10.0.0.0/24; or 127.0.0.1.")
    if watch is not None and watch.keys is None and not is_own(watch.host):
        problem = f"researchers' windows: whoever reaches {watch.host} would see the truth and command robots"
        fail(BAD_INPUT, f"{problem}. Add --watch-key FILE with a key that nobody can guess, or listen on 127.0.0.1.")
    note(f"Open to {', '.join(study.open_to)}, without encryption: {', '.join(exposed)}.")

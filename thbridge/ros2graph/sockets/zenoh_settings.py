"""Settings of zenoh sessions: those of rmw_zenoh, as far as they differ from zenoh's defaults.

Source: rmw_zenoh, DEFAULT_RMW_ZENOH_SESSION_CONFIG.json5 and DEFAULT_RMW_ZENOH_ROUTER_CONFIG.json5.
"""

import json
import os
from typing import TypeAlias

import zenoh

from thbridge.sockets.addresses import LOCALHOST, Address
from thbridge.sockets.admission import is_own

Setting: TypeAlias = "bool | int | str | list[str] | dict[str, Setting]"

# zenoh reads this when it opens its first session. By default, 2 threads receive for all connections, so 2 programs
# that send without end would delay all others.
os.environ.setdefault("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")

_FREE_PORT = Address(LOCALHOST, 0)
_LONGEST_MESSAGE = 32 << 20
"""Maximum number of bytes of a received message. zenoh's default is 1 GiB."""

_QUEUE: dict[str, Setting] = {
    "size": {"data_low": 16},
    "congestion_control": {"drop": {"wait_before_drop": 0, "max_wait_before_drop_fragments": 5000}},
}
"""Queue of messages for a peer: more batches (of 64 kB) than zenoh's 2, and shorter waits (in microseconds) for a peer
that reads nothing. zenoh waits 1 ms for a message, and 50 ms for a long one, which would delay all topics by seconds.
"""


def peer_settings(session: str, router: Address, own: Address = _FREE_PORT) -> zenoh.Config:
    """Return the settings of a node's session with this id. It listens at its own address, on this machine only.

    It connects to the router, and again whenever the connection is lost. If the router is on another machine, the
    session is a client, because the programs there cannot connect to it, and a router forwards nothing between peers.
    """
    return _config(
        {
            "mode": "peer" if is_own(router.host) else "client",
            "id": session,
            "connect": {
                "endpoints": [_endpoint(router)],
                "timeout_ms": -1,
                "exit_on_failure": False,
                "retry": {"period_init_ms": 500, "period_max_ms": 2000},
            },
            "listen": {"endpoints": [_endpoint(own)]},
        }
    )


def router_settings(address: Address) -> zenoh.Config:
    """Return the settings of a router that listens at this address."""
    return _config({"mode": "router", "listen": {"endpoints": [_endpoint(address)]}})


def _config(settings: dict[str, Setting]) -> zenoh.Config:
    common: dict[str, Setting] = {
        "scouting": {
            "multicast": {"enabled": False},
            "gossip": {
                "enabled": True,
                "target": {"router": ["router", "peer"], "peer": ["router"]},
                "autoconnect": {"router": [], "peer": ["router", "peer"]},
                "autoconnect_strategy": {"peer": {"to_router": "always", "to_peer": "greater-zid"}},
            },
        },
        # Caches of latched topics work only with time stamps.
        "timestamping": {"enabled": True},
        "transport": {"link": {"rx": {"max_message_size": _LONGEST_MESSAGE}, "tx": {"queue": _QUEUE}}},
    }
    return zenoh.Config.from_json5(json.dumps(common | settings))


def _endpoint(address: Address) -> str:
    return f"tcp/{address}"

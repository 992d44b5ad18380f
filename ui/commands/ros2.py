"""Commands of `thbridge ros2`: a zenoh router."""

from __future__ import annotations

from typing import Annotated

import typer

from thbridge.ros2graph.values.address import ROUTER
from thbridge.sockets.addresses import ListeningAddress, parse_address
from thbridge.sockets.errors import CannotListen
from ui.command_line.options import OpenTo
from ui.command_line.ros2 import check_zenoh
from ui.command_line.terminal import BAD_INPUT, fail


def ros2_router(
    listen: Annotated[
        str,
        typer.Option(
            metavar="HOST:PORT", help="Address to listen on; 0.0.0.0 also accepts the other machines of --open-to."
        ),
    ] = ROUTER,
    open_to: OpenTo = None,
) -> None:
    """Run a zenoh router for ROS 2 programs, as a substitute for rmw_zenohd, until the command is stopped."""
    import asyncio

    from thbridge.sockets.admission import Admission
    from ui.command_line.networks import check_networks, check_router

    address = parse_address(listen)
    if address is None:
        fail(BAD_INPUT, f"--listen: {listen!r} is not an address. Write, for example, {ROUTER}.")
    networks = tuple(open_to or ())
    check_networks("--open-to", networks)
    check_router(address.host, networks)
    check_zenoh("ros2 router")

    from thbridge.ros2graph.sockets import zenoh_router

    def ready(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, str(where))
        print(f"listening on {where.host}:{where.port}", flush=True)  # noqa: T201 - programs wait for this line

    asyncio.run(zenoh_router.serve(address, ready, Admission.to(networks)))

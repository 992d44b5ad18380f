"""Addresses of schedulers of Dask clusters."""

from ipaddress import ip_address
from urllib.parse import urlsplit

from ui.command_line.terminal import note


def warn_if_open(scheduler: str) -> None:
    """Print a warning if the scheduler at this address is reached over a network without TLS."""
    if is_open_to_others(scheduler):
        note(
            f"Warning: {scheduler} is another machine, reached without TLS. Any machine that reaches the scheduler can "
            "run programs on its workers and on this computer. Use a tls:// address; see `thbridge docs sweeps`."
        )


def is_open_to_others(scheduler: str) -> bool:
    """Return True if the scheduler at this address is reached over a network without TLS."""
    scheme, separator, rest = scheduler.rpartition("://")
    if separator and scheme in {"tls", "wss", "inproc"}:
        return False
    try:
        return not ip_address(urlsplit(f"//{rest}").hostname or "").is_loopback
    except ValueError:
        return rest.partition(":")[0].lower() != "localhost"

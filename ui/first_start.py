"""The first start, which compiles the simulator."""

from sim.common.kernels import is_compiled
from ui.terminal import note


def announce_compiling() -> None:
    """Tell that the first start takes its time, where it does."""
    if not is_compiled():
        note("Compiling the simulator for this machine; only the first start takes this long, some 25 s.")

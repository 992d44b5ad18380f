"""Sends one robot somewhere, from a ground station: take command, guided mode, go, and wait until it is there.

Without sockets and clocks; a `GroundStation` speaks for it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from thbridge.wire.mavlink.dialect import mav
from thbridge.wire.mavlink.ground_station import (
    Acked,
    GroundStation,
    Order,
    Reached,
    StationEvent,
    Texted,
    Unanswered,
)

_CENTIMETRES = 1e-4
"""What one unit of a local position is, in a command that carries integers."""

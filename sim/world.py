"""The physics: differential-drive robots that move, touch walls and one another, and count their wheels' turns."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.geometry import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class WorldState:
    """The truth about n robots at one tick; its arrays are read-only.

    Attributes:
        tick: physics steps since the session began.
        poses: (n, 3) x, y, theta of every base in the map frame, theta in [-pi, pi).
        twists: (n, 2) true velocities of the last tick, base frame: m/s forward, rad/s anti-clockwise.
        odom_poses: (n, 3) where the wheels say the bases are, in each robot's own frame odom (its start).
        odom_twists: (n, 2) the velocities that the wheels measured in the last tick.
        charge: (n,) energy left, in the game's units.
        contact: (n,) bool, stopped by a wall or another robot, and not yet away from it.
        collisions: (n,) int64, how often contact began.
    """

    tick: int
    poses: FloatArray
    twists: FloatArray
    odom_poses: FloatArray
    odom_twists: FloatArray
    charge: FloatArray
    contact: NDArray[np.bool_]
    collisions: NDArray[np.int64]

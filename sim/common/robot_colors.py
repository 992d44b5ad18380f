"""Colors of robots on a light background: the same in windows, reports and figures."""

ROBOT_COLORS = (
    "#0070d0",
    "#b05010",
    "#601060",
    "#208050",
    "#b02030",
    "#003090",
    "#905070",
    "#304000",
    "#7060a0",
    "#700030",
)
"""Colors of the robots. Color-blind people can also distinguish them, and each has enough contrast to white."""


def robot_color(index: int) -> str:
    """Return the color of the robot with this index, from 0. After the last color, the colors repeat."""
    return ROBOT_COLORS[index % len(ROBOT_COLORS)]

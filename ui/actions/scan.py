"""Poses for `thbridge scan`."""

from pathlib import Path

import numpy as np

from sim.common.geometry import FloatArray
from thbridge.files.csv_files import read_columns
from ui.terminal import BAD_INPUT, fail


def read_poses(pose: tuple[float, float, float] | None, batch: Path | None) -> FloatArray:
    """(n, 3) poses, of the option or of a file."""
    if (pose is None) == (batch is None):
        fail(BAD_INPUT, "--pose, --batch: just one of the two is needed. Write --pose X Y YAW, or --batch FILE.csv.")
    return np.array([pose]) if batch is None else read_columns(batch, ("x", "y", "yaw"))

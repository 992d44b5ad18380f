"""The type of arrays of doubles."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

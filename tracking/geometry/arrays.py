"""The array types of this room."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Image = NDArray[np.uint8]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

"""Which neighbours of a pixel count for it in erosion, dilation, opening and closing."""

import numpy as np

SQUARE_2, SQUARE_3, SQUARE_5, SQUARE_9 = (np.ones((side, side), np.uint8) for side in (2, 3, 5, 9))
"""All in a square of so many pixels; of an odd side, the pixel is in its middle."""

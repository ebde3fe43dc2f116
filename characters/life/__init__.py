"""What makes a character look alive whatever it does: gaze, blinks, breath, small movements.

All of it is laid over the pose that its clips give.
"""

from characters.life.blink import Blinking
from characters.life.gaze import HUMAN, Gaze, Limits
from characters.life.life import Life
from characters.life.stirring import Stirring

__all__ = ["HUMAN", "Blinking", "Gaze", "Life", "Limits", "Stirring"]

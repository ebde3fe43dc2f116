"""What is seen of a speaker."""

from typing import Literal

View = Literal["hands", "body", "face"]
"""The upper body with the hands, the whole body, or the face."""

"""From an emotion to bytes on a wire, and telemetry back.

>>> from cubeling import robot
>>> with robot.connect("sim:cubeling") as dino:
...     dino.express(robot.Emotion(valence=0.8, arousal=0.5))
...     dino.telemetry.commanded.label
'happy'
"""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)

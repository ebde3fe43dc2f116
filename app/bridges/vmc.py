"""The VMC protocol: any program that shows a VRM model shows our character by it.

https://protocol.vmc.info, version 2.x, of a performer: OSC over UDP, in Unity's axes (left-handed,
+y up, +z ahead, metres), bones by the names of Unity's HumanBodyBones, expressions as in VRM 0.
"""

import math
from collections.abc import Iterator, Sequence

from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.osc_socket import OscMessage, OscSender, Value
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.running.instrument import Instrument
from cubeling.characters import Character, CharacterError, PosedCharacter
from cubeling.characters.model import PresetFace, TPoseBones
from cubeling.characters.motion import rotations

VRM0_NAMES = {
    "happy": "Joy",
    "angry": "Angry",
    "sad": "Sorrow",
    "surprised": "Surprised",
    "relaxed": "Fun",
    "aa": "A",
    "ih": "I",
    "ou": "U",
    "ee": "E",
    "oh": "O",
    "blink": "Blink",
    "blinkLeft": "Blink_L",
    "blinkRight": "Blink_R",
}
"""Names of the expressions as receivers know them, whatever VRM their model is. VRM 0 has no preset
of surprise; models that have it call it so."""

UNITY_THUMBS = {"Metacarpal": "Proximal", "Proximal": "Intermediate", "Distal": "Distal"}
"""Unity counts the bones of a thumb as those of fingers, VRM 1.0 does not."""


class VmcOut(Instrument):
    """Sends the first character of a session.

    Raises AppError at the beginning if that is no person.
    """

    def __init__(self, address: UdpAddress) -> None:
        self._sender = OscSender(address)
        self._character: Character | None = None
        self._body: VmcBody | None = None
        self._first: float | None = None

    def begin(self, cast: Sequence[Character]) -> None:
        """Measure the character's bones; raises AppError if it is no person."""
        try:
            self._character, self._body = cast[0], VmcBody(cast[0])
        except CharacterError as error:
            raise AppError(f"--vmc: {error}; choose one with --character") from None

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Send the character's bones and face; a character that is no person stands still."""
        if cast[0] is not self._character:  # the player has chosen another one
            try:
                self.begin(cast)
            except AppError:
                self._character, self._body = cast[0], None
        if self._body is not None:
            now = step.posed.timestamp
            self._first = now if self._first is None else self._first
            self._sender.send(self._body.messages(step.posed, now - self._first))
        return Inputs()

    def close(self) -> None:
        """Close the socket; a second call does nothing."""
        self._sender.close()


class VmcBody:
    """Turns the poses of one character into messages."""

    def __init__(self, character: Character) -> None:
        self._bones = TPoseBones(character)
        self._face = PresetFace(character.morphs)
        self._names = [unity_name(part) for part in self._bones.parts]
        self._hips = self._bones.parts.index("hips")

    def messages(self, posed: PosedCharacter, since_first: float) -> Iterator[OscMessage]:
        """Yield the messages of a frame that comes so long after the first [s]."""
        turns, hips = self._bones.update(posed.pose)
        places = self._bones.offsets.copy()
        places[self._hips] = hips
        table = posed.table_from_character
        scale = math.hypot(*table[:3, 1])  # on the table a person is as tall as a hand
        yaw = math.atan2(table[0, 2], table[2, 2])
        root = rotations.about("y", yaw)
        yield OscMessage("/VMC/Ext/OK", (int(posed.visible),))
        yield OscMessage("/VMC/Ext/T", (since_first,))
        yield OscMessage("/VMC/Ext/Root/Pos", ("root", *in_unity(table[:3, 3] / scale, root)))
        for name, place, turn in zip(self._names, places, turns, strict=True):
            yield OscMessage("/VMC/Ext/Bone/Pos", (name, *in_unity(place, turn)))
        for preset, weight in self._face.read(posed.pose.morphs).items():
            yield OscMessage("/VMC/Ext/Blend/Val", (VRM0_NAMES[preset], weight))
        yield OscMessage("/VMC/Ext/Blend/Apply", ())


def in_unity(place: rotations.Array, turn: rotations.Array) -> tuple[Value, ...]:
    """Return a place (3,) and a rotation (4,) in Unity's axes, seven numbers.

    Ours are right-handed with +x to the left of who looks along +z; Unity's +x is to the right.

    >>> import numpy as np
    >>> in_unity(np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3, 0.9]))
    (-1.0, 2.0, 3.0, 0.1, -0.2, -0.3, 0.9)
    """
    x, y, z = place.tolist()
    qx, qy, qz, qw = turn.tolist()
    return -x, y, z, qx, -qy, -qz, qw


def unity_name(part: str) -> str:
    """Return Unity's name of a bone that VRM 1.0 names.

    >>> unity_name("leftUpperArm"), unity_name("rightThumbProximal")
    ('LeftUpperArm', 'RightThumbIntermediate')
    """
    side, thumb, joint = part.partition("Thumb")
    name = f"{side}{thumb}{UNITY_THUMBS[joint]}" if thumb else part
    return name[0].upper() + name[1:]

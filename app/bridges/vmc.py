"""The VMC protocol: any program that shows a VRM model shows our character by it.

https://protocol.vmc.info, version 2.x, of a performer: OSC over UDP, in Unity's axes (left-handed,
+y up, +z ahead, metres), bones by the names of Unity's HumanBodyBones, expressions as in VRM 0.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from cubeling.app.bridges.addresses import MAX_PORT, UdpAddress
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
    """Sends the people of a cast, each to an address of its own: receivers show one each.

    Parameters
    ----------
    addresses
        Those of the characters in the order of the cast. Further ones follow on the next ports.

    Raises AppError at the beginning if none of the cast is a person.
    """

    def __init__(self, *addresses: UdpAddress) -> None:
        self._addresses = addresses
        self._senders = {each: OscSender(each) for each in addresses}
        self._sent: list[tuple[Character, VmcBody | None]] = []
        self._first: float | None = None

    def address_of(self, place: int) -> UdpAddress:
        """Return where a character is sent, by its place in the cast; raises AppError."""
        if place < len(self._addresses):
            return self._addresses[place]
        last = self._addresses[-1]
        port = last.port + place + 1 - len(self._addresses)
        if port > MAX_PORT:
            raise AppError(f"--vmc: there is no port {port} for character {place + 1}")
        return replace(last, port=port)

    def begin(self, cast: Sequence[Character]) -> None:
        """Measure the bones of all; raises AppError if nobody is a person."""
        problem = self._take(cast)
        if problem is not None:
            raise AppError(f"--vmc: {problem}; choose one with --character") from None

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Send bones and faces; who is no person stands still."""
        known = [character for character, _ in self._sent]
        if any(one is not other for one, other in zip(known, cast, strict=True)):
            self._take(cast)  # the player has chosen another one
        for place, ((_, body), performance) in enumerate(zip(self._sent, step.cast, strict=True)):
            if body is not None:
                posed = performance.posed
                self._first = posed.timestamp if self._first is None else self._first
                sender = self._senders[self.address_of(place)]
                sender.send(body.messages(posed, posed.timestamp - self._first))
        return Inputs()

    def _take(self, cast: Sequence[Character]) -> CharacterError | None:
        """Measure a cast; return why nobody can be sent, or None."""
        problem, self._sent = None, []
        for place, character in enumerate(cast):
            body = None
            try:
                body = VmcBody(character)
            except CharacterError as error:
                problem = problem or error
            else:
                address = self.address_of(place)
                if address not in self._senders:
                    self._senders[address] = OscSender(address)
            self._sent.append((character, body))
        return problem if all(body is None for _, body in self._sent) else None

    def close(self) -> None:
        """Close the sockets; a second call does nothing."""
        for sender in self._senders.values():
            sender.close()


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

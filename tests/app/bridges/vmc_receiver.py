"""A receiver of the VMC protocol, written by what the protocol and its receivers publish.

It knows nothing of our sender: messages as in protocol.vmc.info, local positions and rotations in
Unity's left-handed axes (EVMC4U), turned over to a VRM 1.0 model (x against x) as receivers of
three-vrm do, and from normalised to raw bones as three-vrm's VRMHumanoidRig does.
"""

import numpy as np
from pythonosc.osc_packet import OscPacket

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton

THUMBS = {"Proximal": "Metacarpal", "Intermediate": "Proximal", "Distal": "Distal"}


class VmcReceiver:
    """Keeps what was received last."""

    def __init__(self):
        self.bones, self.blend, self.applied, self.root = {}, {}, {}, None
        self.loaded = None

    def take(self, datagram):
        for each in OscPacket(datagram).messages:
            address, given = each.message.address, each.message.params
            if address == "/VMC/Ext/Bone/Pos":
                name, *numbers = given
                self.bones[name] = np.array(numbers)
            elif address == "/VMC/Ext/Root/Pos":
                assert given[0] == "root"
                self.root = np.array(given[1:])
            elif address == "/VMC/Ext/Blend/Val":
                self.blend[given[0]] = given[1]
            elif address == "/VMC/Ext/Blend/Apply":
                self.applied = dict(self.blend)
            elif address == "/VMC/Ext/OK":
                self.loaded = given[0]

    def normalised(self, part):
        """Return the local rotation of a bone by its name in VRM 1.0, in the model's axes."""
        name = part
        if "Thumb" in part:
            side, _, joint = part.partition("Thumb")
            name = f"{side}Thumb{({v: k for k, v in THUMBS.items()})[joint]}"
        numbers = self.bones.get(name[0].upper() + name[1:])
        return None if numbers is None else numbers[3:] * [1.0, -1.0, -1.0, 1.0]

    def pose(self, skeleton: Skeleton) -> Pose:
        """Return the pose of a model whose joints have VRM 1.0's names; its hips stay."""
        rest = skeleton.rest
        world = rotations.from_matrix(rest.globals(skeleton)[:, :3, :3])
        turns = rest.rotations.copy()
        for joint, name in enumerate(skeleton.names):
            turn = self.normalised(name)
            if turn is None:
                continue
            parent = skeleton.parents[joint]
            above = world[parent] if parent >= 0 else rotations.IDENTITY
            raw = rotations.multiply(rotations.conjugate(above), rotations.multiply(turn, above))
            turns[joint] = rotations.multiply(raw, rest.rotations[joint])
        return Pose(rest.translations, turns)

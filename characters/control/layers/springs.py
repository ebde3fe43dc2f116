"""Spring bones: hair, ears and clothes that swing after the body, in the world."""

import numpy as np

from cubeling.characters.body.springs import SpringBody
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose


class SpringLayer:
    """Swings the spring bones of a character; it is the last that turns joints."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._body: SpringBody | None = None
        if character.springs:
            self._body = SpringBody(character.skeleton, character.springs, character.height)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its spring bones swung.

        They are simulated in the size of the character, so that they do not swing faster on a
        small one.
        """
        if self._body is None:
            return pose
        world_from_character = np.array(context.table_from_character)
        world_from_character[:3] /= context.scale
        return self._body.update(pose, world_from_character, context.elapsed)

"""Characters: skeletons, motions, and the pictures of them.

Commands come in, posed characters and their pictures go out; this room knows no camera, no cube
and no robot. Start with `Character.load` and `Animator`.
"""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)

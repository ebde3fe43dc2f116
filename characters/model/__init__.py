"""Characters: skeleton, meshes, clips and sidecar file."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)

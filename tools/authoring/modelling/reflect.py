"""The other half of what is the same on both sides."""

from dataclasses import replace

import numpy as np

from characters.model.mesh import Mesh
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.shapes import other_side


def reflected(mesh: Mesh, skeleton: Skeleton) -> Mesh:
    """Return the image of a mesh without morphs in the plane x = 0, on the other side's joints."""
    other = np.array([skeleton.names.index(other_side(name)) for name in skeleton.names])
    flip = np.array([-1.0, 1.0, 1.0], np.float32)
    return replace(
        mesh,
        positions=mesh.positions * flip,
        normals=mesh.normals * flip,
        triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]),
        joints=np.where(mesh.weights > 0, other[mesh.joints], 0).astype(np.uint16),
    )

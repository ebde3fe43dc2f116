"""A ray tracer for triangle meshes: the reference that screen-space effects are measured against.

A tool of the developers, not part of the program. `RayTracer` casts rays; the other modules build
what an effect needs on it: what a camera sees, ambient occlusion, the light of an area.
"""

from tools.ray_tracing.ambient import ambient_occlusion, wendland
from tools.ray_tracing.area_light import AreaLight, Pane, light_fraction, pane_transmittance
from tools.ray_tracing.camera import VisibleSurfaces, trace_camera, trace_depth_layers
from tools.ray_tracing.mesh import Triangles
from tools.ray_tracing.tracer import RayHits, RayTracer

__all__ = [
    "AreaLight",
    "Pane",
    "RayHits",
    "RayTracer",
    "Triangles",
    "VisibleSurfaces",
    "ambient_occlusion",
    "light_fraction",
    "pane_transmittance",
    "trace_camera",
    "trace_depth_layers",
    "wendland",
]

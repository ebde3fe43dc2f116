"""The program's own pictures against rays: the light from all around in each texel."""

from dataclasses import dataclass, replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.rendering import Effect, Quality, Stage
from cubeling.characters.rendering.deferred.ambient_occlusion import AmbientOcclusionSettings
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from tests.bench.ambient_occlusion.scenes import floor, posed
from tests.bench.ambient_occlusion.scoring import Floats, Score, score
from tests.bench.picture import SIZE, scene
from tools.ray_tracing import RayTracer, Triangles, ambient_occlusion, trace_camera

QUALITY = Quality("occluded", 2, False, True, frozenset([Effect.AMBIENT_OCCLUSION]))
"""As `rich`, with this effect alone."""

TABLE_SIDE_M = 4.0


@dataclass(frozen=True)
class ProductQuality:
    """A character in the program's picture."""

    name: str
    """Its name."""

    texels: int
    """Texels of the character that are compared."""

    misplaced_mm: float
    """Distance between where the program and the rays see its surface, 95th percentile [mm]."""

    occluded: float
    """RMSE of no occlusion at all."""

    drawn: Score
    """Against the rays."""


class ReadPass(RenderPass):
    """Keeps what the picture shows of its characters."""

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Read what is seen in each texel, and how much of the light from all around arrives."""
        fineness = layer.target.fineness
        self.size = fineness * layer.area.width, fineness * layer.area.height
        self.matrix = frame.camera_matrix.copy()
        self.matrix[:2, 2] += 0.5 - np.array([layer.area.x, layer.area.y])
        self.matrix[:2] *= fineness
        self.seen = self._texels(layer.target.geometry.normal_id, np.float16)[..., 3] > 0.5
        self.position = self._texels(layer.target.geometry.position, np.float32)[..., :3]
        self.open_share = self._texels(layer.target.light.ambient, np.float16)[..., 3]

    def _texels(
        self, texture: moderngl.Texture, kind: type[np.float16] | type[np.float32]
    ) -> Floats:
        rows = np.frombuffer(texture.read(), kind).reshape(texture.height, texture.width, 4)
        return rows[: self.size[1], : self.size[0]].astype(np.float32)


def product_quality(context: moderngl.Context, name: str, rays: int) -> ProductQuality:
    """Draw a character as the program does, and trace the same scene; `name` may be a file."""
    body = Character.load(name)
    view, actor_at = scene(body)
    view = replace(view, occluders=(), distortion=np.zeros(0))
    actor = actor_at(0)
    stage = Stage(context, SIZE)
    stage.quality = QUALITY
    read = ReadPass()
    stage.passes.append(read)
    stage.draw(view, [actor])
    stage.release()
    mesh = posed(body, actor.posed.pose, np.asarray(actor.posed.table_from_character, float))
    table = np.asarray(view.camera_from_table, float)
    tracer = RayTracer(Triangles.joined([floor(TABLE_SIDE_M), mesh]).transformed(table))
    surfaces = trace_camera(tracer, read.matrix, read.size)
    truth = ambient_occlusion(tracer, surfaces, AmbientOcclusionSettings().radius_m, rays)
    both: NDArray[np.bool_] = read.seen & (surfaces.normal_id[..., 3] == 2)
    apart = np.linalg.norm(read.position - surfaces.position[..., :3], axis=-1)[both]
    return ProductQuality(
        body.name,
        int(both.sum()),
        1e3 * float(np.percentile(apart, 95)),
        score(np.ones_like(truth), truth, both).rmse,
        score(read.open_share, truth, both),
    )

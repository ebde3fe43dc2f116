"""Shadows on faces against rays, close up: `python -m tests.bench.picture --faces`.

The heads of the bundled characters, and of those of `../shared/data/gltf` where that exists, fill
the picture in six moods, lit from the front and from the side. For some texels of the picture, rays
to all parts of the lamp find the light that `rich` finds in a map, past the same posed mesh. A
shadow that is not there is a texel that faces the lamp, that the lamp lights by the rays, and that
is darker than that by more than `VISIBLE`. One where the rays find a shadow within `EDGE_PX` is the
edge of that shadow; the column "with edges" counts it too.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.characters import Animator, Character, CharacterCommand
from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.rendering import QUALITIES, CameraView, Effect, SceneCharacter, Stage
from cubeling.characters.rendering.camera_picture.light import Light
from cubeling.characters.rendering.deferred.lamp import Lamp
from cubeling.characters.rendering.portrait_camera import (
    CharacterExtent,
    PortraitCamera,
    joints_below,
)
from cubeling.characters.skeleton import rotations
from tests.bench.ambient_occlusion.scenes import posed
from tests.bench.skin import FixedLight, fixed_light
from tests.bench.soft_shadows import area_of
from tests.characters.rendering.watch import Texels, WatchPass
from tools.ray_tracing import RayTracer, light_fraction

SIZE = (560, 560)
STEP = 3
"""Rays are cast from one in so many texels along each side."""

RICH = QUALITIES["rich"]
NONE = replace(RICH, name="no effects", effects=frozenset(), max_error_px=0.0)
SHADOWS = replace(NONE, name="soft shadows", effects=frozenset([Effect.SOFT_SHADOWS]))
MIN_LIGHT = 0.02
"""Texels with less light than this before it is shadowed are as dark either way."""

MODELS = Path(__file__).parents[2].parent / "shared" / "data" / "gltf"
HEIGHT_M = 0.18
YAW_RAD = -0.35
"""Faces are seen a little from their left, as in play [rad]."""

SETTLED_S = 2.0
"""After so long a face shows its mood [s]."""

MOODS = {
    "neutral": Emotion(0.0, 0.0, "neutral"),
    "happy": Emotion(0.7, 0.6, "happy"),
    "angry": Emotion(-0.7, 0.6, "angry"),
    "sad": Emotion(-0.6, -0.4, "sad"),
    "surprised": Emotion(0.1, 0.8, "surprised"),
    "relaxed": Emotion(0.6, -0.6, "relaxed"),
}
LIGHTS = {"front": (0.35, 0.85, 0.45), "side": (0.85, 0.62, 0.1)}
"""Directions to the key light in the table frame."""

LIT, VISIBLE = 0.9, 0.1
"""Shares of the lamp's light: from the first on, a point is lit by it, and less by the second
shows."""

EDGE_PX = 3.0
"""So far beside the true one the edge of a shadow may be drawn [px]."""

MIN_COSINE = 0.05
"""Between a triangle's normal and the light: what is steeper gets nearly none of it."""

MAX_SHARE = 0.005
"""Bound on the share of cells with a shadow that is not there, of each head in each mood."""

LIFT_M = 2e-5
"""Rays begin so high above the skin [m]."""

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class FaceLight:
    """The share of the lamp's light in texels of one face."""

    found: Floats
    """As `rich` draws it, (texels,)."""

    true: Floats
    """As rays find it, (texels,)."""

    where: NDArray[np.bool_]
    """Where they are in the picture, (height, width) / `STEP`."""

    @property
    def false_shadow(self) -> float:
        """Share of texels with a shadow that is not there, nor beside them."""
        return float((self._too_dark & ~self._beside_shadow).mean())

    @property
    def with_edges(self) -> float:
        """Share of texels that the lamp lights and that are darker."""
        return float(self._too_dark.mean())

    @property
    def _too_dark(self) -> NDArray[np.bool_]:
        return np.asarray((self.true >= LIT) & (self.found < self.true - VISIBLE))

    @property
    def _beside_shadow(self) -> NDArray[np.bool_]:
        shadow = np.zeros(self.where.shape, np.uint8)
        shadow[self.where] = self.true < LIT
        reach = 1 + 2 * round(EDGE_PX * RICH.fineness / STEP)
        return np.asarray(cv2.dilate(shadow, np.ones((reach, reach), np.uint8))[self.where] > 0)

    @property
    def false_light(self) -> float:
        """Share of texels that are lit though no ray reaches the lamp."""
        return float(((self.true <= VISIBLE) & (self.found > LIT)).mean())

    @property
    def error(self) -> float:
        """Root mean square of the difference."""
        return float(np.sqrt(((self.found - self.true) ** 2).mean()))


def heads() -> Iterator[Character]:
    """Yield the bundled characters, then those of others."""
    for name in Character.bundled_names():
        yield Character.load(name)
    for path in sorted(MODELS.glob("*.glb")):
        yield Character.load(str(path))


def in_mood(character: Character, emotion: Emotion) -> SceneCharacter:
    """Return a character that has stood in a mood for a while."""
    animator = Animator(character)
    for time in np.arange(0.0, SETTLED_S, 0.1):
        shown: PosedCharacter = animator.update(CharacterCommand(float(time), emotion=emotion))
    low, high = character.bounds
    place = np.eye(4)
    scale = HEIGHT_M / max(character.height, 0.5 * float((high - low).max()))
    place[:3, :3] = scale * rotations.to_matrix(rotations.about("y", YAW_RAD))
    return SceneCharacter(character, replace(shown, table_from_character=place))


def view_of(actor: SceneCharacter) -> CameraView:
    """Return a view that the head of a character fills."""
    place = actor.posed.table_from_character
    joints = joints_below(actor.character, "head")
    points = CharacterExtent(actor.character).points(actor.posed.pose, joints)
    camera = PortraitCamera.around(points @ place[:3, :3].T + place[:3, 3], 0.1, SIZE)
    grey = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    return CameraView(grey, camera.matrix, np.zeros(0), camera.camera_from_table)


def draw(stage: Stage, actor: SceneCharacter, view: CameraView, light: Light) -> NDArray[np.uint8]:
    """Return the picture of a character in some light."""
    stage._light = FixedLight(light)  # type: ignore[assignment]
    return np.asarray(stage.draw(view, [actor]), np.uint8)


def measure(
    stage: Stage, actor: SceneCharacter, view: CameraView, light: Light, rays: int
) -> FaceLight:
    """Draw a face with shadows and without, and cast rays from some of its texels."""
    watch = WatchPass()
    stage.passes.append(watch)
    light_of: dict[str, Texels] = {}
    for quality in (SHADOWS, NONE):
        stage.quality = quality
        watch.forget()
        draw(stage, actor, view, light)
        light_of[quality.name] = watch.diffuse[::STEP, ::STEP, :3].sum(axis=-1)
    layer = watch.frame.layer
    assert layer is not None
    rows = np.arange(0, watch.diffuse.shape[0], STEP) < layer.texels[1]
    columns = np.arange(0, watch.diffuse.shape[1], STEP) < layer.texels[0]
    seen = (light_of[NONE.name] > MIN_LIGHT) & rows[:, None] & columns
    position = watch.position[::STEP, ::STEP, :3][seen]
    stage.passes.remove(watch)
    found = (light_of[SHADOWS.name] / np.maximum(light_of[NONE.name], MIN_LIGHT))[seen]
    table_from_camera = np.linalg.inv(np.asarray(view.camera_from_table, float))
    points = position @ table_from_camera[:3, :3].T + table_from_camera[:3, 3]
    assert isinstance(actor.character, Character)
    posed_mesh = posed(actor.character, actor.posed.pose, actor.posed.table_from_character)
    tracer = RayTracer(posed_mesh)
    ways = (points - table_from_camera[:3, 3]).astype("f4")
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    hits = tracer.hits((points - 1e-3 * ways).astype("f4"), ways)
    flat = tracer.flat_normals(np.maximum(hits.triangles, 0))
    flat *= -np.sign(np.einsum("ij,ij->i", flat, ways))[:, None]
    lit = (flat @ light.to_light > MIN_COSINE) & (hits.triangles >= 0)
    casters = np.concatenate([each.enclosing for each in watch.frame.characters])
    lamp = area_of(Lamp.over(casters, light.to_light))
    origins = (points + LIFT_M * flat)[lit].astype("f4")
    true = light_fraction(tracer, origins, lamp, rays=rays)[:, 1]
    where = np.zeros(seen.shape, bool)
    where[seen] = lit
    return FaceLight(found[lit].astype(np.float32), true, where[: rows.sum(), : columns.sum()])


def print_faces(
    context: moderngl.Context, rays: int, pictures: Path | None, names: Sequence[str] = ()
) -> int:
    """Print the table, write the pictures, and return an exit code."""
    table = Table(title="shadows on faces, close up: worst mood of each")
    for heading in (
        "face, light",
        "texels",
        "shadow not there",
        "in mood",
        "with edges",
        "light not there",
        "RMSE",
    ):
        table.add_column(
            heading, justify="left" if heading in ("face, light", "in mood") else "right"
        )
    stage = Stage(context, SIZE)
    worst = 0.0
    for character in heads():
        if names and character.name not in names:
            continue
        actors = {mood: in_mood(character, emotion) for mood, emotion in MOODS.items()}
        for name, direction in LIGHTS.items():
            light = fixed_light(direction)
            found = {
                mood: measure(stage, actor, view_of(actor), light, rays)
                for mood, actor in actors.items()
            }
            mood = max(found, key=lambda each: found[each].false_shadow)
            share = found[mood].false_shadow
            worst = max(worst, share)
            table.add_row(
                f"{character.name}, {name}",
                f"{sum(len(each.found) for each in found.values())}",
                f"{share:.2%}",
                mood,
                f"{max(each.with_edges for each in found.values()):.2%}",
                f"{max(each.false_light for each in found.values()):.2%}",
                f"{max(each.error for each in found.values()):.3f}",
            )
        if pictures is not None:
            pictures.mkdir(parents=True, exist_ok=True)
            stage.quality = RICH
            light = fixed_light(LIGHTS["front"])
            drawn = [draw(stage, actor, view_of(actor), light) for actor in actors.values()]
            rows = [np.concatenate(drawn[first : first + 3], axis=1) for first in (0, 3)]
            cv2.imwrite(str(pictures / f"{character.name}.png"), np.concatenate(rows))
    stage.release()
    console = Console()
    console.print(table)
    console.print(f"worst share of shadow that is not there {worst:.2%}, bound {MAX_SHARE:.1%}")
    return int(worst > MAX_SHARE)

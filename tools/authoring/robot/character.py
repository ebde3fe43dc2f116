"""The virtual robot: a small four-legged machine with lamps in the colour of its mood."""

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.meshes import join
from tools.authoring.modelling.quadruped import loop_clip
from tools.authoring.modelling.shapes import Vector, linear_rgb
from tools.authoring.robot.angry import angry
from tools.authoring.robot.body import body, lit_lenses as body_lenses, sockets
from tools.authoring.robot.expressions import expression_names, with_expressions
from tools.authoring.robot.happy import happy
from tools.authoring.robot.head import eyes, head, lit_lenses as head_lenses
from tools.authoring.robot.motion import LEVELS
from tools.authoring.robot.neutral import neutral
from tools.authoring.robot.rig import FEET, MOODS, scaled_with_head, shipped_skeleton, skeleton

IDLE_DURATION_S = 6.0
LAMP_EMISSION = 0.55
"""Emission of the lamps as a factor of their colour."""
LAMP_COLORS: dict[str, Vector] = {
    "happy": linear_rgb("#35d06c"),
    "neutral": linear_rgb("#ffb52e"),
    "angry": linear_rgb("#ff3a2a"),
}
"""Linear RGB of the lamps: the screen's colours of the moods, brighter."""


def build_robot() -> Character:
    """Return the bundled robot."""
    bound = skeleton()
    shipped = shipped_skeleton(bound)
    made = meshes(bound)
    return Character("robot", shipped, clips(shipped), made, expression_names(made))


def clips(shipped: Skeleton) -> dict[str, Clip]:
    """Return all clips by name: idle, and every mood at three intensities."""
    anims = {"idle": neutral(1, IDLE_DURATION_S, taps=False)}
    for level, name in enumerate(LEVELS):
        anims[f"neutral_{name}"] = neutral(level)
        anims[f"happy_{name}"] = happy(level)
        anims[f"angry_{name}"] = angry(level)
    return {name: loop_clip(name, anim, shipped, FEET) for name, anim in anims.items()}


def meshes(bound: Skeleton) -> tuple[Mesh, ...]:
    """Return the casing, the eyes and the lamps of every colour, bound to the skeleton's pose."""
    small = skeleton(1.0)
    faces = [scaled_with_head(piece, bound) for piece in head(small)]
    casing = join("casing", [*body(bound), *sockets(bound), *faces], Material(roughness=0.42))
    balls = [scaled_with_head(piece, bound) for piece in eyes(small)]
    glass = join("eyes", balls, Material(roughness=0.12))
    lamps = (_lamps(mood, small, bound) for mood in MOODS)
    return with_expressions(casing, bound), glass, *lamps


def _lamps(mood: str, small: Skeleton, bound: Skeleton) -> Mesh:
    color = LAMP_COLORS[mood]
    r, g, b = (LAMP_EMISSION * level for level in color)
    pieces = [scaled_with_head(piece, bound) for piece in head_lenses(mood, color, small)]
    pieces += body_lenses(mood, color, bound)
    return join(f"{mood} lamps", pieces, Material(roughness=0.3, emissive=(r, g, b)))

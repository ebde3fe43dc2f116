"""The robot's likeness: a small four-legged machine with lamps in the colour of its mood."""

from characters.model.character import Character
from characters.model.mesh import Material, Mesh
from characters.motion.clip import Clip
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.meshes import join
from tools.authoring.modelling.quadruped import clip
from tools.authoring.modelling.shapes import Vector, rgb
from tools.authoring.robot.angry import angry
from tools.authoring.robot.body import body, sockets
from tools.authoring.robot.body import lenses as body_lenses
from tools.authoring.robot.expressions import names, with_expressions
from tools.authoring.robot.happy import happy
from tools.authoring.robot.head import eyes, head
from tools.authoring.robot.head import lenses as head_lenses
from tools.authoring.robot.motion import LEVELS
from tools.authoring.robot.neutral import neutral
from tools.authoring.robot.rig import FEET, MOODS, grown, resting, skeleton

IDLE_SECONDS = 6.0
GLOW = 0.55
"""Light that the lamps give off, over their colour."""
LIGHTS: dict[str, Vector] = {
    "happy": rgb("#35d06c"),
    "neutral": rgb("#ffb52e"),
    "angry": rgb("#ff3a2a"),
}
"""Linear RGB of the lamps: the colours that the screen gives the moods, brighter."""


def build_robot() -> Character:
    """Return the robot as it is shipped."""
    bound = skeleton()
    shipped = resting(bound)
    made = meshes(bound)
    return Character("robot", shipped, clips(shipped), made, names(made))


def clips(shipped: Skeleton) -> dict[str, Clip]:
    """Return all clips by name: idle, and every mood at three intensities."""
    acts = {"idle": neutral(1, IDLE_SECONDS)}
    for level, name in enumerate(LEVELS):
        acts[f"neutral_{name}"] = neutral(level)
        acts[f"happy_{name}"] = happy(level)
        acts[f"angry_{name}"] = angry(level)
    return {name: clip(name, act, shipped, FEET) for name, act in acts.items()}


def meshes(bound: Skeleton) -> tuple[Mesh, ...]:
    """Return the casing, the eyes and the lamps of every colour, bound to the skeleton's pose."""
    small = skeleton(1.0)
    faces = [grown(piece, bound) for piece in head(small)]
    casing = join("casing", [*body(bound), *sockets(bound), *faces], Material(roughness=0.42))
    balls = [grown(piece, bound) for piece in eyes(small)]
    glass = join("eyes", balls, Material(roughness=0.12))
    lamps = (_lamps(mood, small, bound) for mood in MOODS)
    return with_expressions(casing, bound), glass, *lamps


def _lamps(mood: str, small: Skeleton, bound: Skeleton) -> Mesh:
    color = LIGHTS[mood]
    r, g, b = (GLOW * level for level in color)
    pieces = [grown(piece, bound) for piece in head_lenses(mood, color, small)]
    pieces += body_lenses(mood, color, bound)
    return join(f"{mood} lamps", pieces, Material(roughness=0.3, emissive=(r, g, b)))

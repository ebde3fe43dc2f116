"""Figure 8.13 of Huang 2013: one gesture with two settings of its expressivity (S24)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import cv2
import numpy as np

from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.voice import SilentSource
from cubeling.app.show.blocks import BehaviourOptions
from cubeling.app.workshop.moods.colors import CURVE_STYLES
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.characters import Character, Pose
from cubeling.characters.behaviour import GestureCollection, GestureExpressivity, natural_times
from cubeling.characters.motion import Array
from cubeling.characters.rendering import PortraitRenderer, create_context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GESTURE = "OPEN_ARMS"

SETTINGS: Mapping[str, GestureExpressivity] = {
    "small and weak": GestureExpressivity(spatial=-0.6, power=0.0),
    "large, as weak": GestureExpressivity(spatial=0.6, power=0.0),
    "small, powerful": GestureExpressivity(spatial=-0.6, power=1.0),
    "large and powerful": GestureExpressivity(spatial=0.6, power=1.0),
}
"""The first and the last are the two of the figure; those between change one parameter each."""

PRINTED_ORDERS = (
    ("wrists: width of what they sweep [cm]", "larger with spatial", "large, as weak"),
    ("trunk: greatest turn from rest [°]", "larger with power", "small, powerful"),
    ("wrists: greatest speed [m/s]", "larger with power", "small, powerful"),
)
"""What is measured, what is said of it, and the setting that shows it beside the first one."""

PERSON_M, RATE_HZ, SETTLE_S = 1.75, 60.0, 0.3
"""Height of a person, for ways and speeds; frames a second; time before and after [s]."""

MOMENTS, PORTRAIT_PX = 5, (150, 220)


@dataclass(frozen=True)
class PlayedGesture:
    """How a gesture was performed."""

    poses: tuple[Pose, ...]
    wrists: Array
    """Places of both, (frames, 2, 3), of a person of `PERSON_M` [m]."""

    trunk_deg: Array
    """How far the chest is turned from where it begins, (frames,) [degrees]."""

    @property
    def figures(self) -> tuple[float, float, float]:
        """Width of what the wrists sweep [cm], greatest turn of the trunk [°] and speed [m/s]."""
        spread = np.ptp(self.wrists.reshape(-1, 3), axis=0)
        speeds = np.linalg.norm(np.diff(self.wrists, axis=0), axis=-1) * RATE_HZ
        return 100.0 * float(spread[0]), float(self.trunk_deg.max()), float(speeds.max())


def play(body: Character, how: GestureExpressivity, rate: float = RATE_HZ) -> PlayedGesture:
    """Return how the gesture is performed, by all layers of the body."""
    player = BehaviourPlayer(body, SilentSource("no voice"), BehaviourOptions(expressivity=how))
    player.settle(SETTLE_S, rate)
    player.director.accept(
        '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">'
        f'<gesture id="g" lexeme="{GESTURE}"/></bml>'
    )
    gesture = next(each for each in GestureCollection.load_bundled() if each.name == GESTURE)
    end = (natural_times(gesture).end or 0.0) + SETTLE_S
    hands = [body.anatomy.joint(name) for name in ("leftHand", "rightHand")]
    chest = body.anatomy.joint("chest")
    poses = [player.update(number / rate).posed.pose for number in range(int(end * rate))]
    placed = np.stack([pose.globals(body.skeleton) for pose in poses])
    wrists = placed[:, np.array(hands)][..., :3, 3] * PERSON_M / body.height
    turned = placed[:, chest, :3, :3] @ placed[0, chest, :3, :3].T
    cosines = (np.trace(turned, axis1=1, axis2=2) - 1.0) / 2.0
    return PlayedGesture(tuple(poses), wrists, np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))))


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return what spatial and power change, beside what the thesis says of them."""
    body = Character.load("human")
    played = {}
    for name, how in SETTINGS.items():
        request.progress(name)
        played[name] = play(body, how)
    names = list(SETTINGS)
    rows = []
    for number, (what, printed, shows) in enumerate(PRINTED_ORDERS):
        values = {name: each.figures[number] for name, each in played.items()}
        ratio = values[shows] / values[names[0]]
        rows.append((what, printed, *(f"{values[name]:.2f}" for name in names), f"{ratio:.2f}"))
    columns = ("", "printed", *names, "with that parameter ÷ first")
    shown = {name: played[name] for name in (names[0], names[-1])}
    return Reproduction(
        (ReportTable(f"The gesture '{GESTURE}'", columns, tuple(rows)),),
        "the bundled human, its gesture performed as cubeling behave does; for a person of "
        f"{PERSON_M:g} m",
        "The figure is lost and has no numbers, nor was it judged by anybody; which gesture and "
        "which settings it shows is not known. Openness, fluidity, bias and tension are as written "
        "here: python -m tests.bench.expressivity has what each slider moves.",
        (
            DrawnFigure(
                "Figure 8.13, ours: small and weak above, large and powerful below",
                partial(_draw_strips, body, shown),
                (8.8, 5.2),
            ),
            DrawnFigure(
                "Paths of the wrists from the front, and speed of the right one",
                partial(_draw_paths, shown),
                (8.8, 3.2),
            ),
        ),
    )


def _draw_strips(body: Character, shown: Mapping[str, PlayedGesture], sheet: "Figure") -> None:
    context = create_context()
    renderer = PortraitRenderer(context, PORTRAIT_PX)
    chosen = [
        each.poses[number]
        for each in shown.values()
        for number in np.linspace(0, len(each.poses) - 1, MOMENTS + 2).astype(int)[1:-1]
    ]
    try:
        pictures = renderer.portraits(body, chosen, azimuth=0.0)
    finally:
        renderer.release()
        context.release()
    for row, (axes, name) in enumerate(zip(sheet.subplots(len(shown), 1), shown, strict=True)):
        strip = np.concatenate(pictures[row * MOMENTS : (row + 1) * MOMENTS], axis=1)
        axes.imshow(cv2.cvtColor(strip, cv2.COLOR_BGR2RGB))
        axes.set_axis_off()
        axes.set_title(name, loc="left")


def _draw_paths(shown: Mapping[str, PlayedGesture], sheet: "Figure") -> None:
    paths, speeds = sheet.subplots(1, 2)
    for (name, each), (color, dashes) in zip(shown.items(), CURVE_STYLES, strict=False):
        style = {"color": color, "linestyle": (0, dashes or None)}
        for wrist in (0, 1):
            x, y = each.wrists[:, wrist, 0], each.wrists[:, wrist, 1]
            paths.plot(-x, y, label=name if not wrist else None, **style)
        steps = np.linalg.norm(np.diff(each.wrists[:, 1], axis=0), axis=-1) * RATE_HZ
        speeds.plot(np.arange(len(steps)) / RATE_HZ, steps, **style)
    paths.set_aspect("equal")
    paths.set_xlabel("across [m]")
    paths.set_ylabel("height [m]")
    paths.legend(fontsize=8)
    speeds.set_xlabel("time [s]")
    speeds.set_ylabel("speed of the right wrist [m/s]")

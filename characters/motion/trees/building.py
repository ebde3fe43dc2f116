"""Builds motions from plans."""

import math
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.blend import Blend, BlendSpace1D, BlendSpace2D, TimeScaled, shares
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.crossfade import CrossFade
from cubeling.characters.motion.curves import FadeCurve, Product, Weight
from cubeling.characters.motion.layers import AdditiveLayer, MaskedLayer
from cubeling.characters.motion.mirror import Mirror, Mirrored
from cubeling.characters.motion.modifiers import (
    Loop,
    RootOffset,
    Stretch,
    TimeCurve,
    TimeWindow,
    Warped,
)
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.phase import StaticPose, as_cyclic, with_phase
from cubeling.characters.motion.schedule import Action, Schedule
from cubeling.characters.motion.trees.parametric import (
    ParameterBindings,
    ParametricMotion,
    ParametricWeight,
    Values,
)
from cubeling.characters.motion.trees.plan import Node, Plan
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.masks import Mask, mask_of
from cubeling.characters.skeleton.pose import Skeleton


class Builder:
    """Builds the motions of a plan for one character.

    `mirror` returns its mirror; it is called only if the plan contains a mirrored motion.
    """

    def __init__(
        self,
        plan: Plan,
        skeleton: Skeleton,
        clips: Mapping[str, Clip],
        anatomy: Anatomy,
        mirror: Callable[[], Mirror],
    ) -> None:
        self._plan = plan
        self._skeleton = skeleton
        self._anatomy = anatomy
        self._mirror = mirror
        self._clips = {name: with_phase(clip, skeleton) for name, clip in clips.items()}
        self._constant: dict[int, Motion] = {}

    def build(self, node: Node, values: Values) -> tuple[Motion, ParameterBindings]:
        """Return the motion of a node, and the bindings that set its parameters.

        Raises
        ------
        CharacterError
            If a part of the plan cannot be played; the message names its place in the file.
        """
        bindings = ParameterBindings()
        motion = self._bind(node, values, bindings)
        bindings.restart_with(values)
        return motion, bindings

    def _bind(self, node: Node, values: Values, bindings: ParameterBindings) -> Motion:
        """Return a motion that remains the same object while its parameters change."""
        if not node.parametric:
            return self._build_fixed(node, values)
        if node.group == "layer":
            base, over = (
                self._bind(node.motions[key], values, bindings) for key in ("base", "over")
            )
            weight = node.fields["weight"]
            if isinstance(weight, str):
                weight = ParametricWeight(weight, 0.0 if node.kind == "layer" else -1.0)
                bindings.weights.append(weight)
            return self._layer_over(node, base, over, weight)
        self._refuse_layers(node, node)
        parametric = ParametricMotion(lambda now: self._build_fixed(node, now), values)
        bindings.motions.append(parametric)
        return parametric

    def _refuse_layers(self, node: Node, inside: Node) -> None:
        """Refuse parametric layers in a node that is not a layer: their times would differ."""
        for child in inside.children:
            if child.parametric and child.group == "layer":
                self._refuse(
                    child,
                    f"a layer that parameters change cannot be inside the {node.kind} at "
                    f"{node.path}; put the {node.kind} inside the layer",
                )
            self._refuse_layers(node, child)

    def _build_fixed(self, node: Node, values: Values) -> Motion:
        """Return the motion of a node for fixed parameters; without parameters it is built once."""
        if id(node) in self._constant:
            return self._constant[id(node)]
        try:
            if node.kind in _MODIFIER_BUILDERS:
                motion = _MODIFIER_BUILDERS[node.kind](self._of(node, values), node.fields)
            else:
                motion = _NODE_BUILDERS[node.kind](self, node, values)
            if not node.parametric:
                self._constant[id(node)] = motion
            return motion
        except CharacterError as error:
            if str(error).startswith(self._plan.source):
                raise
            self._refuse(node, str(error))

    def _of(self, node: Node, values: Values, key: str = "of") -> Motion:
        return self._build_fixed(node.motions[key], values)

    def _clip(self, node: Node, values: Values) -> Motion:
        return self._clips[node.fields["clip"]]

    def _build_mirrored(self, node: Node, values: Values) -> Motion:
        return Mirrored(self._of(node, values), self._mirror())

    def _root_offset(self, node: Node, values: Values) -> Motion:
        yaw = math.radians(node.fields["yaw_deg"])
        roots = tuple(j for j, parent in enumerate(self._skeleton.parents) if parent < 0)
        offset = RootDelta(node.fields["x"], node.fields["z"], yaw)
        return RootOffset(self._of(node, values), offset, roots)

    def _scale_time(self, node: Node, values: Values) -> Motion:
        rate, stride = node.fields["rate"], node.fields["stride"]
        if rate <= 0.0:
            self._refuse(node, f"a rate of {rate}; give more than 0")
        return TimeScaled(as_cyclic(self._of(node, values)), rate, stride)

    def _blend(self, node: Node, values: Values) -> Motion:
        weights = shares([row.fields["weight"] for row in node.rows])
        return Blend(self._rows(node, values), weights)

    def _space(self, node: Node, values: Values) -> Motion:
        knots = [row.fields["value"] for row in node.rows]
        order = np.argsort(knots, kind="stable")
        motions = self._rows(node, values)
        space = BlendSpace1D(
            tuple(knots[number] for number in order), tuple(motions[number] for number in order)
        )
        return space.at(values[node.fields["by"]])

    def _plane(self, node: Node, values: Values) -> Motion:
        rows = [row.fields["value"] for row in node.rows]
        if any(len(value) != 2 for value in rows):
            self._refuse(node, "each value must be two numbers, one for each parameter")
        points = np.array(rows, float)
        along, across = node.fields["by"]
        space = BlendSpace2D(points, self._rows(node, values))
        return space.at([values[along], values[across]])

    def _layer(self, node: Node, values: Values) -> Motion:
        base, over = (self._of(node, values, key) for key in ("base", "over"))
        return self._layer_over(node, base, over, node.fields["weight"])

    def _crossfade(self, node: Node, values: Values) -> Motion:
        return CrossFade(
            self._of(node, values, "first"),
            self._of(node, values, "second"),
            node.fields["start"],
            node.fields["seconds"],
            node.fields["shape"],
        )

    def _schedule(self, node: Node, values: Values) -> Motion:
        actions = []
        for row in node.rows:
            fields = row.fields
            fade = FadeCurve(fields["fade_in"], fields["fade_out"], fields["shape"])
            actions.append(
                Action(
                    self._build_fixed(row.motion, values),
                    fields["start"],
                    Product((fields["weight"], fade)),
                    self._mask(fields["mask"]),
                    always=fields["always"],
                )
            )
        return Schedule(tuple(actions), self._skeleton.rest)

    def _layer_over(self, node: Node, base: Motion, over: Motion, weight: Weight) -> Motion:
        mask = self._mask(node.fields["mask"])
        try:
            if node.kind == "layer":
                return MaskedLayer(base, over, mask, weight)
            return AdditiveLayer(base, over, None, weight, mask)
        except CharacterError as error:
            self._refuse(node, str(error))

    def _rows(self, node: Node, values: Values) -> tuple[Motion, ...]:
        return tuple(self._build_fixed(row.motion, values) for row in node.rows)

    def _mask(self, name: str) -> Mask | None:
        if not name:
            return None
        mask = self._plan.masks[name]
        try:
            return mask_of(
                self._skeleton, mask.subtrees, mask.joints, mask.default, self._anatomy.joints
            )
        except CharacterError as error:
            raise CharacterError(f"{self._plan.source}: masks.{name}: {error}") from None

    def _refuse(self, node: Node, what: str) -> NoReturn:
        raise CharacterError(f"{self._plan.source}: {node.path}: {what}")


_MODIFIER_BUILDERS: Mapping[str, Callable[[Motion, Mapping[str, Any]], Motion]] = {
    "hold": lambda motion, fields: StaticPose(motion.sample(fields["at"]), 1.0),
    "stretch": lambda motion, fields: Stretch(motion, fields["seconds"]),
    "window": lambda motion, fields: TimeWindow(motion, fields["start"], fields["end"]),
    "loop": lambda motion, _: Loop(motion),
    "warp": lambda motion, fields: Warped(motion, TimeCurve(fields["times"], fields["sources"])),
}
"""Builders of the kinds that depend on one motion and their own fields only."""

_NODE_BUILDERS: Mapping[str, Callable[[Builder, Node, Values], Motion]] = {
    "clip": Builder._clip,
    "mirror": Builder._build_mirrored,
    "displace": Builder._root_offset,
    "pace": Builder._scale_time,
    "blend": Builder._blend,
    "space": Builder._space,
    "plane": Builder._plane,
    "layer": Builder._layer,
    "add": Builder._layer,
    "crossfade": Builder._crossfade,
    "schedule": Builder._schedule,
}

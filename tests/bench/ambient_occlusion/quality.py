"""How far ambient occlusion is from the ray-traced truth, and the separable form from the full."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.deferred.ambient_occlusion import (
    ESTIMATORS,
    AmbientOcclusionSettings,
)
from cubeling.characters.rendering.deferred.sample_patterns import PATTERNS
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.scenes import load
from tests.bench.ambient_occlusion.scoring import (
    THESIS,
    Floats,
    Score,
    TracedScene,
    buffer_of,
    drawn,
    gain_between,
    score,
)

SAMPLES = (5, 11, 21)
"""k of Table 3.1."""

DENSE_SAMPLES, DENSE_LINES = 81, 8
"""Samples and lines of a drawing that is as good as the estimator gets."""


@dataclass(frozen=True)
class SceneQuality:
    """The default settings on one scene."""

    name: str
    """The scene."""

    occluded: float
    """RMSE of drawing no occlusion at all: what there is to find."""

    noise: float
    """RMSE of the truth itself, from two sets of rays."""

    all_pixels: Score
    """Against the truth, over all surfaces."""

    character: Score | None
    """The same over the pixels of a character alone; None in scenes without one."""

    dense: Score
    """With 30 times the samples: what the picture does not show, no sampling finds."""


def scene_quality(
    context: moderngl.Context, programs: ShaderPrograms, traced: TracedScene, has_character: bool
) -> SceneQuality:
    """Score the default settings on a scene."""
    buffer = buffer_of(context, traced)
    seen, truth = traced.surfaces.seen, traced.truth
    settings = AmbientOcclusionSettings(radius_m=traced.scene.radius_m)
    found = drawn(context, programs, buffer, settings)
    dense = replace(settings, samples=DENSE_SAMPLES, lines=DENSE_LINES, blur_size=0)
    densely = drawn(context, programs, buffer, dense)
    gain = gain_between(densely, truth, seen)
    densely = np.clip(1.0 - gain * (1.0 - densely), 0.0, 1.0).astype(np.float32)
    buffer.release()
    body = traced.surfaces.normal_id[..., 3] == 2
    return SceneQuality(
        traced.scene.name,
        score(np.ones_like(truth), truth, seen).rmse,
        score(traced.trace(1), truth, seen).rmse / np.sqrt(2.0),
        score(found, truth, seen),
        score(found, truth, body) if has_character else None,
        score(densely, truth, seen),
    )


@dataclass(frozen=True)
class VariantQuality:
    """One variant, over several scenes."""

    estimator: str
    """Its name in `ESTIMATORS`."""

    samples: int
    """k."""

    separable: bool
    """Whether it has two lines, or k."""

    pattern: str
    """Its name in `PATTERNS`."""

    truth: Score
    """Against the rays, with the constants of `ESTIMATORS`."""

    full: Score
    """Against the full form of the same estimator, k and pattern, after the gain was matched."""


def variant_qualities(
    context: moderngl.Context,
    programs: ShaderPrograms,
    names: Sequence[str],
    size: tuple[int, int],
    rays: int,
) -> list[VariantQuality]:
    """Draw all estimators × k × patterns in both forms, and score them over all scenes at once."""
    scenes = [TracedScene(load(name), size, rays) for name in names]
    buffers = [buffer_of(context, scene) for scene in scenes]
    seen = np.concatenate([scene.surfaces.seen for scene in scenes])
    truth = np.concatenate([scene.truth for scene in scenes])
    results = []
    for estimator in ESTIMATORS:
        for samples in SAMPLES:
            for pattern in PATTERNS:
                full, separable = (
                    np.concatenate(
                        [
                            drawn(
                                context,
                                programs,
                                buffer,
                                replace(
                                    THESIS,
                                    estimator=estimator,
                                    samples=samples,
                                    lines=lines,
                                    pattern=pattern,
                                    radius_m=scene.scene.radius_m,
                                ),
                            )
                            for scene, buffer in zip(scenes, buffers, strict=True)
                        ]
                    )
                    for lines in (None, 2)
                )
                for form, is_separable in ((full, False), (separable, True)):
                    results.append(
                        VariantQuality(
                            estimator,
                            samples,
                            is_separable,
                            pattern,
                            score(form, truth, seen),
                            matched_score(form, full, seen),
                        )
                    )
    for buffer in buffers:
        buffer.release()
    return results


def matched_score(found: Floats, target: Floats, pixels: NDArray[np.bool_]) -> Score:
    """Score a picture after its gain was matched to the target's (spec S3 d)."""
    gain = gain_between(found, target, pixels)
    matched = np.clip(1.0 - gain * (1.0 - found), 0.0, 1.0).astype(np.float32)
    return score(matched, target, pixels)

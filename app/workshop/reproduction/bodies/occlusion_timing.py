"""Time of ambient occlusion on this machine's driver, and how it grows with the samples."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import moderngl
import numpy as np

from cubeling.app.workshop.reproduction.bodies.occlusion_buffer import GBuffer
from cubeling.characters.rendering import (
    AmbientOcclusion,
    AmbientOcclusionSettings,
    ShaderPrograms,
)

TIMED_ROUNDS = 7
"""How often every variant is drawn; the least time counts, as other work only adds to it."""

THESIS_MS = {
    "crytek": {5: (3.2, 3.4), 11: (13.9, 5.8), 21: (49.7, 9.9)},
    "volumetric": {5: (3.5, 3.6), 11: (14.8, 5.9), 21: (51.9, 9.9)},
    "hbao": {5: (3.6, 3.5), 11: (15.0, 6.0), 21: (51.9, 10.2)},
}
"""Table 3.1: by estimator and k, time of the full and the separable form [ms]. GeForce GTX 480,
1024×768, 50,000 triangles."""


Variant = tuple[str, int, bool]
"""Estimator, k, and whether it is the separable form."""


@dataclass(frozen=True)
class OcclusionTiming:
    """Time of one variant, blur included."""

    cpu_ms: float
    """Of all threads of the process, until the driver has finished [ms]."""

    wall_ms: float
    """On the clock [ms]."""

    query_ms: float
    """By the driver's timer query [ms]."""

    def main_ms(self, software: bool) -> float:
        """Return the time that says how much work it is [ms]."""
        return self.cpu_ms if software else self.query_ms


def measure(
    context: moderngl.Context,
    programs: ShaderPrograms,
    buffer: GBuffer,
    variants: Mapping[Variant, AmbientOcclusionSettings],
    rounds: int = TIMED_ROUNDS,
) -> dict[Variant, OcclusionTiming]:
    """Draw all variants in turn, round by round, and return the least times of each."""
    effects = {key: AmbientOcclusion(context, programs, each) for key, each in variants.items()}
    query = context.query(time=True)
    least: dict[Variant, tuple[float, ...]] = {}
    for count in range(rounds + 1):
        for key, effect in effects.items():
            context.finish()
            wall, cpu = time.perf_counter(), time.process_time()
            with query:
                buffer.occlusion(effect)
            context.finish()
            cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
            taken = 1e3 * cpu, 1e3 * wall, 1e-6 * query.elapsed
            if count:  # the first drawing compiles the shader
                least[key] = tuple(map(min, taken, least.get(key, taken)))
    for effect in effects.values():
        effect.release()
    return {key: OcclusionTiming(*times) for key, times in least.items()}


@dataclass(frozen=True)
class Fit:
    """A straight line through times: t = constant + slope · samples."""

    constant_ms: float
    """Time without samples [ms]."""

    slope_us: float
    """Time of one sample for each pixel [µs]."""

    r_squared: float
    """Share of the variance that the line explains."""


def fit_line(samples: list[int], times_ms: list[float]) -> Fit:
    """Fit a line by least squares.

    Examples
    --------
    >>> fit = fit_line([25, 121, 441], [3.2, 13.9, 49.7])
    >>> round(fit.constant_ms, 2), round(fit.slope_us, 1), round(fit.r_squared, 4)
    (0.39, 111.8, 1.0)
    """
    slope, constant = np.polyfit(samples, times_ms, 1)
    residual = np.asarray(times_ms) - (constant + slope * np.asarray(samples))
    r_squared = 1.0 - residual.var() / np.var(times_ms)
    return Fit(float(constant), 1e3 * float(slope), float(r_squared))

"""Ambient occlusion from what the camera sees: how much light from all around reaches a surface."""

from dataclasses import dataclass

import moderngl
import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.deferred.buffers import GrowingBuffer, OcclusionBuffer
from cubeling.characters.rendering.deferred.cells import cell_count, cell_uniforms
from cubeling.characters.rendering.deferred.sample_patterns import PATTERNS, sample_pattern
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class Estimator:
    """What the samples around a pixel say about its occlusion, and the constants that suit it.

    The constants are those with the least squared error against ray-traced pictures, for 2 lines of
    11 samples: `python -m tests.bench.ambient_occlusion.tuning`. Those of the bitmask were tried by
    hand, for 29 samples, on the same scenes and on bundled characters.
    """

    darkness: float
    """Gain of the occlusion."""

    bias: float
    """Sine of the elevation above the surface from which on a sample counts: below it, triangles
    of a round body would shade each other."""

    crowding: float
    """Where the samples of a line are: 0 evenly spread, 1 and 2 at the squares and cubes of even
    distances, crowded around the pixel."""

    reach: float
    """How far it looks, as a share of the radius."""

    by_area: float = 0.0
    """What a sample's weight is: 0 the same for all, 1 the area of the disc that it stands for.
    Estimators that look for a horizon have no weights, nor has the bitmask."""

    fill: float = 0.0
    """Where between the last sample and this one what hides the light is taken to begin: 0 at this,
    1 at the last."""

    span: float = 1.0
    """Share of what it looks at in which samples are: what is further away counts little."""

    apart: float = 0.0
    """Distance from one sample to the next, at least [cells]."""


ESTIMATORS = {
    "angular": Estimator(darkness=6.3, bias=0.1, crowding=0.75, reach=1.0),
    "crytek": Estimator(darkness=1.11, bias=0.05, crowding=0.75, reach=0.7),
    "volumetric": Estimator(darkness=1.11, bias=0.02, crowding=0.0, reach=0.3, by_area=1.0),
    "hbao": Estimator(darkness=1.04, bias=0.1, crowding=0.75, reach=1.0, fill=0.4),
    "gtao": Estimator(darkness=1.21, bias=0.02, crowding=0.75, reach=1.0, fill=0.4),
    "bitmask": Estimator(
        darkness=1.0, bias=0.02, crowding=2.0, reach=1.0, fill=0.5, span=0.7, apart=1.0
    ),
}
"""The estimators by name. Each has a shader `ambient_occlusion_NAME.frag` that defines it."""

NOTHING_M = 1e3
"""Depth that stands for nothing [m]; the shaders have it too."""


EDGE_SHARE = 0.01
"""Distance from a pixel's tangent plane from which on the blur takes a neighbour for another
surface, as a share of the radius; it is no more than a cell is wide."""


@dataclass(frozen=True)
class AmbientOcclusionSettings:
    """How ambient occlusion is sampled."""

    estimator: str = "bitmask"
    """One of `ESTIMATORS`."""

    samples: int = 29
    """Samples on each line, the pixel itself included: k of Huang 2013, ch. 3.4."""

    lines: int | None = 2
    """Lines through each pixel: 2 is the separable form, with 2k samples; None stands for k lines,
    the full form, with k²."""

    pattern: str = "hammersley"
    """How the lines turn from pixel to pixel, one of `PATTERNS`."""

    pattern_size: int = 2
    """Pixels along a side of the tile in which the pattern repeats. With 4, as Huang 2013 has it,
    more lines meet, but the mean over the tile takes narrow folds away."""

    blur_size: int = 2
    """Pixels along a side of the blur: that of the tile takes its noise away; 0 for no blur."""

    radius_m: float = 0.08
    """Occluders farther away do not count [m]. For characters of 0.2 m it is the same share of
    their height as 0.7 m is for people in a room."""

    constants: Estimator | None = None
    """Gain and others; None for the estimator's own."""

    def __post_init__(self) -> None:
        for name, known in (("estimator", ESTIMATORS), ("pattern", PATTERNS)):
            if getattr(self, name) not in known:
                raise CharacterError(
                    f"unknown {name} of ambient occlusion '{getattr(self, name)}': choose one of "
                    f"{', '.join(known)}"
                )
        if self.samples < 2 or (self.lines is not None and self.lines < 1):
            raise CharacterError(
                f"ambient occlusion needs 2 samples on 1 line at least, not {self.samples} on "
                f"{self.lines}"
            )
        if self.pattern_size < 1 or self.blur_size < 0 or not self.radius_m > 0.0:
            raise CharacterError(
                "ambient occlusion needs a pattern of 1 pixel, a blur of 0 and a radius above 0 m "
                f"at least, not {self.pattern_size}, {self.blur_size} and {self.radius_m}"
            )

    @property
    def line_count(self) -> int:
        """Lines through each pixel."""
        return self.samples if self.lines is None else self.lines

    @property
    def samples_per_pixel(self) -> int:
        """How many samples a pixel costs."""
        return self.line_count * self.samples


class AmbientOcclusion:
    """Computes ambient occlusion from a G-buffer.

    The separable form (Huang 2013, ch. 3.4) looks along two orthogonal lines through each pixel,
    not at all of the disc around it. The lines turn from pixel to pixel, in a pattern that repeats
    in small tiles; a blur of a tile's size, which does not cross edges, then gives every pixel the
    mean of the directions of a whole tile. The full form has as many lines as samples on each.

    It may be found for cells of several texels only, which are then taken for the pixels here;
    texels take theirs from the cells around them, again without crossing edges.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        settings: AmbientOcclusionSettings | None = None,
    ) -> None:
        self.settings = settings = settings or AmbientOcclusionSettings()
        """How it samples."""
        self._context = context
        defines = f"LINES {settings.line_count}", f"SAMPLES {settings.samples}"
        fragment = f"ambient_occlusion_{settings.estimator}"
        blur = "ambient_occlusion_blur", f"TILE {settings.blur_size}"
        self._march = context.vertex_array(programs.load("full_screen", fragment, *defines), [])
        spread = "ambient_occlusion_spread"
        self._blur = context.vertex_array(programs.load("full_screen", *blur), [])
        self._spread = context.vertex_array(programs.load("full_screen", spread), [])
        pattern = sample_pattern(settings.pattern, settings.pattern_size)
        side = settings.pattern_size, settings.pattern_size
        self._pattern = context.texture(side, 2, pattern.tobytes(), dtype="f4")
        self._cells = [GrowingBuffer(context, OcclusionBuffer) for _ in range(2)]
        self._texels = GrowingBuffer(context, OcclusionBuffer)

    def draw(
        self,
        normal_id: moderngl.Texture,
        position: moderngl.Texture,
        depths: moderngl.Texture,
        size: tuple[int, int],
        focal_px: float,
        ground: Array | None = None,
        stride: int = 1,
    ) -> moderngl.Texture:
        """Return the share of the ambient light that reaches each texel, in the red channel.

        It is 1 where nothing is near, and in the background. The second channel is depth
        [m]. The texture is as large as `size` or larger, and stays valid until the next call.

        Parameters
        ----------
        normal_id
            Unit normals in the camera frame (x right, y down, z forward), and in w the number of
            the object; below 0.5 is background.
        position
            Positions in the camera frame [m]; z is 0 in the background. In w is the normal of the
            triangle, see `flat_normal.glsl`.
        depths
            Of each cell: where what is seen ends, where the next thing behind it begins and ends,
            and where what is seen begins [m]; `NOTHING_M` for never. The estimator `bitmask` looks
            at nothing else around a cell.
        size
            Width and height of the part of `normal_id` and `position` that is used, from the first
            texel on.
        focal_px
            Focal length: texels that one metre covers at a distance of one metre.
        ground
            A plane that is seen in the background and outside of the textures: a point (3,) of
            the camera frame is on it if its product with this is 1 [1/m]. None for nothing there.
        stride
            Texels along a side of the cells for which it is found, see `cell_count`.
        """
        settings = self.settings
        constants = settings.constants or ESTIMATORS[settings.estimator]
        cells = cell_count(size, stride)
        first, second = (buffer.at_least(cells) for buffer in self._cells)
        self._context.enable_only(moderngl.NOTHING)
        normal_id.use(0)
        position.use(1)
        self._pattern.use(2)
        depths.use(3)
        common = {"normal_id": 0, "place": 1, "focal": focal_px, **cell_uniforms(size, stride)}
        set_uniforms(
            self._march.program,
            **common,
            pattern=2,
            depths=3,
            radius=constants.reach * settings.radius_m,
            ground=np.zeros(3) if ground is None else ground,
            darkness=constants.darkness,
            bias=constants.bias,
            crowding=constants.crowding,
            by_area=constants.by_area,
            fill=constants.fill,
            span=constants.span,
            apart=constants.apart,
        )
        first.draw(self._march, cells)
        common |= {"source": 2, "tolerance": EDGE_SHARE * settings.radius_m}
        for source, target, direction in ((first, second, (1, 0)), (second, first, (0, 1))):
            source.texture.use(2)
            is_last = target is first
            set_uniforms(self._blur.program, **common, direction=direction, last=is_last)
            target.draw(self._blur, cells)
        if stride == 1:
            return first.texture
        first.texture.use(2)
        set_uniforms(self._spread.program, **common)
        texels = self._texels.at_least(size)
        texels.draw(self._spread, size)
        return texels.texture

    def release(self) -> None:
        """Release everything of the graphics card; a second call does nothing."""
        for buffer in (*self._cells, self._texels):
            buffer.release()
        for each in (self._march, self._blur, self._spread, self._pattern):
            each.release()

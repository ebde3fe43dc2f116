"""Edges say where the cube is to a hundredth of a pixel, and say nothing where there are none."""

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.edges import EdgeModel
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.edges import edge_refinement
from cubeling.tracking.refinement.edges.edge_fit import fit_edges
from cubeling.tracking.refinement.edges.edge_refinement import EdgeRefiner
from cubeling.tracking.refinement.edges.profiles import EdgeProfiles, measure_profiles
from cubeling.tracking.synthetic import open_synthetic
from tests.examples import some

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def scene() -> tuple[EdgeRefiner, Patch, Array]:
    """A refiner, a picture of a cube at rest, and the truth."""
    source = open_synthetic("static?frames=1")
    assert source.intrinsics is not None
    refiner = EdgeRefiner(source.cube, Projection(source.intrinsics))
    return refiner, Patch.crop(source.frame(0).image), source.truth(0)


def test_edges_lie_between_black_and_white() -> None:
    cube = CubeModel.load("companion")
    model = EdgeModel.of(cube)
    for number, face in enumerate(cube.faces):
        cells = np.pad(~marker_cells(cube.dictionary, face.marker_id), 1, constant_values=True)
        side = len(cells) - 2
        axes = np.stack([face.corners[1] - face.corners[0], face.corners[3] - face.corners[0]])
        of_face = model.face == number
        for sign, white in ((0.5, True), (-0.5, False)):
            points = model.points[of_face] + sign * model.across[of_face] - face.corners[0]
            places = points @ axes.T / (cube.marker_size**2) * side
            column, row = np.floor(places).astype(int).T + 1
            assert (cells[row, column] == white).all()


@pytest.mark.parametrize("seed", some(range(6), 2))
def test_a_rough_start_converges_to_the_truth(
    scene: tuple[EdgeRefiner, Patch, Array], seed: int
) -> None:
    refiner, patch, truth = scene
    offset = np.random.default_rng(seed).uniform(-1, 1, 6) * ([1e-3] * 3 + [0.015] * 3)
    result = refiner.refine(patch, se3.apply_delta(truth, offset))
    assert result is not None
    step = se3.delta(result.camera_from_cube, truth)
    assert np.linalg.norm(step[:3]) < 1e-4
    assert np.linalg.norm(step[3:]) < np.deg2rad(0.05)
    assert result.support > 0.8


def test_other_markers_are_not_taken_for_the_cube(
    scene: tuple[EdgeRefiner, Patch, Array],
) -> None:
    """A cube of the same shape whose markers differ: outlines fit, insides do not."""
    _, patch, truth = scene
    source = open_synthetic("static?frames=1")
    assert source.intrinsics is not None
    other = EdgeRefiner(CubeModel.load("companion"), Projection(source.intrinsics))
    result = other.refine(patch, truth)
    assert result is None or result.inner_support < 0.6


def test_an_image_without_edges_gives_no_pose(
    scene: tuple[EdgeRefiner, Patch, Array],
) -> None:
    refiner, patch, truth = scene
    assert refiner.refine(Patch(np.full_like(patch.grey, 120), 0, 0), truth) is None
    behind = se3.pose(truth[:3, :3], -truth[:3, 3])
    assert refiner.refine(patch, behind) is None


def upright_profiles(reach: float) -> EdgeProfiles:
    """Profiles across an upright line through x = 20, black to its left."""
    count = 10
    rows = np.arange(5.0, 5.0 + count)
    return EdgeProfiles(
        model=EdgeModel.of(CubeModel.load("locomotion")),
        numbers=np.arange(count),
        pixels=np.stack([np.full(count, 20.0), rows], axis=1),
        normals=np.tile([1.0, 0.0], (count, 1)),
        slopes=np.zeros((count, 6)),
        bends=None,
        k1=0.0,
        reach=np.full(count, reach),
        blur_motion=np.zeros(6),
        blur=np.zeros(count),
    )


@pytest.mark.parametrize("reach", [1.4, 2.0, 3.5])
@pytest.mark.parametrize("width_px", [edge_refinement.NARROW_PX, edge_refinement.WIDE_PX])
@pytest.mark.parametrize("offset", [-0.3, 0.1, 0.6])
def test_an_edge_is_as_far_off_as_it_is_in_small_cells_and_with_wide_steps(
    reach: float, width_px: float, offset: float
) -> None:
    across = np.tanh((np.arange(40.0) - 20.0 - offset) / 0.87)
    image = np.tile(120.0 + 80.0 * across, (20, 1)).astype(np.float32)
    found = measure_profiles(Patch(image, 0, 0), upright_profiles(reach), np.zeros(10), width_px)
    assert found.offset == pytest.approx(np.full(10, offset), rel=0.12)


def test_a_cube_at_rest_is_measured_once(
    scene: tuple[EdgeRefiner, Patch, Array], monkeypatch: pytest.MonkeyPatch
) -> None:
    refiner, patch, truth = scene
    widths = []

    def counted(patch, profiles, shifts, width_px, steps=3):
        widths.append(width_px)
        return fit_edges(patch, profiles, shifts, width_px, steps)

    monkeypatch.setattr(edge_refinement, "fit_edges", counted)
    assert refiner.refine(patch, truth) is not None
    assert widths == [edge_refinement.NARROW_PX]

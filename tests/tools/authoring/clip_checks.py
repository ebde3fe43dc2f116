"""What the tests of the quadrupeds have in common: measures and checks of their clips."""

import numpy as np

from cubeling.characters.model.character import Character
from cubeling.characters.motion.blend import mix
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations


def moving(character: Character, name: str, joint: str) -> float:
    """Return how far a joint gets from where it is in the first frame of a clip [m]."""
    skeleton = character.skeleton
    places = character.clips[name].poses.globals(skeleton)[:, skeleton.index(joint), :3, 3]
    return float(np.ptp(places, axis=0).max())


def blend_slide(
    character: Character, clips: list[Clip], joint: str, times: np.ndarray
) -> np.ndarray:
    """Return how far a joint gets in an equal mix of two clips, along x, y and z [m]."""
    index = character.skeleton.index(joint)
    half = [mix([clip.sample(time) for clip in clips], [0.5, 0.5]) for time in times]
    places = np.array([pose.globals(character.skeleton)[index, :3, 3] for pose in half])
    return np.asarray(np.ptp(places, axis=0))


def check_same_clips(bundled: Character, made: Character) -> None:
    """Check that the clips of a bundled character are those that its code makes."""
    assert sorted(bundled.clips) == sorted(made.clips)
    for name, clip in made.clips.items():
        shipped = bundled.clips[name].poses
        assert np.allclose(shipped.translations, clip.poses.translations, atol=1e-5), name
        same = rotations.align(shipped.rotations, clip.poses.rotations)
        assert np.allclose(same, clip.poses.rotations, atol=1e-4), name
        assert (shipped.scales is None) == (clip.poses.scales is None), name
        if shipped.scales is not None and clip.poses.scales is not None:
            assert np.allclose(shipped.scales, clip.poses.scales, atol=1e-5), name


def check_vertices(character: Character) -> None:
    """Check that the weights of every vertex sum to one, and that its normal has unit length."""
    for mesh in character.meshes:
        assert np.allclose(mesh.weights.sum(axis=1), 1.0, atol=1e-5)
        assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-3)


def check_ends_meet(character: Character, name: str) -> None:
    """Check that a clip ends as it begins, at the same speed."""
    poses = character.clips[name].poses
    assert np.allclose(poses.translations[0], poses.translations[-1], atol=1e-6)
    assert np.allclose(rotations.align(poses.rotations[-1], poses.rotations[0]), poses.rotations[0])
    head = poses.globals(character.skeleton)[:, character.skeleton.index("head"), :3, 3]
    steps = np.linalg.norm(np.diff(head, axis=0), axis=1)
    assert abs(steps[0] - steps[-1]) < 0.4 * steps.max()


def check_leg_stretch(character: Character, name: str, feet: tuple[str, ...]) -> None:
    """Check that the bones above the feet keep nearly the same length during a clip."""
    for foot in feet:
        joint = character.skeleton.index(foot)
        lengths = np.linalg.norm(character.clips[name].poses.translations[:, joint], axis=1)
        assert lengths.max() < 1.2 * lengths.min()


def planted_slide(character: Character, name: str, feet: tuple[str, ...]) -> float:
    """Return the greatest speed along the ground of soles on the ground in a clip [m/s].

    It samples between the frames too, where legs are interpolated. Soles are on the ground up to
    1 mm; toes and heel count each.
    """
    skeleton, clip = character.skeleton, character.clips[name]
    rate = 120.0
    times = np.arange(0, clip.duration, 1 / rate)
    posed = np.array([clip.sample(time).globals(skeleton) for time in times])
    rest, fastest = skeleton.rest.globals(skeleton), 0.0
    for foot in map(skeleton.index, feet):
        for ahead in (-0.012, 0.0, 0.02):
            sole = [*(rest[foot, :3, :3].T @ [0.0, -rest[foot, 1, 3], ahead]), 1.0]
            places = (posed[:, foot] @ sole)[:, :3]
            speed = np.linalg.norm(np.diff(places[:, [0, 2]], axis=0), axis=1) * rate
            down = places[:, 1] < 0.001
            fastest = max(fastest, float((speed * (down[1:] & down[:-1])).max()))
    return fastest

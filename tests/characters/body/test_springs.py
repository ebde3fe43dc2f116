"""Spring bones: against the algorithm of VRM's specification, and what must hold of any."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.body.springs import SETTLING_STEPS, SpringBody
from cubeling.characters.model.springs import SpringBone, SpringCollider
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton

BALL = SpringCollider("j0", (0.13, -0.34, 0.02), (0.13, -0.34, 0.02), 0.1)
BESIDE = SpringCollider("j0", (0.05, -0.31, -0.08), (0.05, -0.31, -0.08), 0.08)
CAPSULE = SpringCollider("j1", (-0.2, -0.1, -0.1), (0.2, -0.2, -0.1), 0.05)


COLLIDERS = {2: (BALL, CAPSULE), 3: (BALL, BESIDE, CAPSULE), 6: (BESIDE, BALL), 7: (CAPSULE, BALL)}
"""Colliders by number of the joint."""


def head_with_hair(seed=3):
    """A body, a head, two locks of three joints, one of them forked; and its spring bones."""
    random = np.random.default_rng(seed)
    parents = (-1, 0, 1, 2, 3, 1, 5, 6, 5)
    translations = random.uniform(-0.05, 0.05, (9, 3)) + [0, -0.1, 0]
    turns = rotations.normalize(random.normal(size=(9, 4)) * 0.3 + rotations.IDENTITY)
    skeleton = Skeleton(tuple(f"j{n}" for n in range(9)), parents, Pose(translations, turns))
    tails = {2: 3, 3: 4, 5: 6, 6: 7}
    bones = tuple(
        SpringBone(
            f"j{joint}",
            tuple(translations[tails[joint]]) if joint in tails else (0.0, -0.06, 0.02),
            stiffness=random.uniform(0.2, 2.0),
            drag=random.uniform(0.1, 0.6),
            gravity=(0.0, -random.uniform(0.0, 0.5), 0.0),
            radius=0.01,
            colliders=COLLIDERS.get(joint, ()),
        )
        for joint in (8, 2, 3, 4, 5, 6, 7)
    )
    return skeleton, bones


def free_hair():
    """The same without colliders."""
    skeleton, bones = head_with_hair()
    return skeleton, [replace(bone, colliders=()) for bone in bones]


def walking(skeleton, frame):
    """A pose with a nodding head, and where the body stands, at a frame of 1/60 s."""
    turns = skeleton.rest.rotations.copy()
    turns[1] = rotations.multiply(rotations.about("x", 0.5 * math.sin(frame / 9)), turns[1])
    world = np.eye(4)
    world[:3, :3] = rotations.to_matrix(rotations.about("y", 0.02 * frame))
    world[:3, 3] = [0.02 * frame, 0.03 * math.sin(frame / 4), 0.01 * frame]
    return Pose(skeleton.rest.translations, turns, skeleton.rest.scales), world


class Specified:
    """The algorithm of VRMC_springBone 1.0 as it is written: a joint at a time, 60 Hz."""

    def __init__(self, skeleton, bones):
        self.skeleton, self.bones = skeleton, sorted(bones, key=lambda bone: bone.joint)
        self.number = skeleton.index
        self.now, self.before = {}, {}
        self.pushed_twice = 0

    def update(self, pose, world):
        local = pose.rotations.copy()
        for bone in self.bones:
            placed = world @ Pose(pose.translations, local).globals(self.skeleton)
            own = placed[self.number(bone.joint)]
            head, rest = own[:3, 3], own[:3, :3] @ bone.tail
            now = self.now.get(bone.joint, head + rest)
            before = self.before.get(bone.joint, now)
            tail = now + (now - before) * (1 - bone.drag)
            tail = tail + bone.stiffness / 60 * rest / np.linalg.norm(rest)
            tail = tail + np.array(bone.gravity) / 60
            tail = self.kept(tail, head, rest)
            pushes = 0
            for shape in bone.colliders:
                start, end = (
                    placed[self.number(shape.joint)][:3, :3] @ end
                    + placed[self.number(shape.joint)][:3, 3]
                    for end in (shape.start, shape.end)
                )
                along = end - start
                share = np.dot(tail - start, along) / max(np.dot(along, along), 1e-12)
                away = tail - (start + along * min(max(share, 0.0), 1.0))
                distance = np.linalg.norm(away) - bone.radius - shape.radius
                if distance < 0:
                    pushes += 1
                    tail = self.kept(tail - away / np.linalg.norm(away) * distance, head, rest)
            self.pushed_twice += pushes > 1
            self.before[bone.joint], self.now[bone.joint] = now, tail
            inner = own[:3, :3].T @ (tail - head)
            turn = rotations.between(bone.tail, inner)
            joint = self.number(bone.joint)
            local[joint] = rotations.multiply(local[joint], turn)
        return local

    @staticmethod
    def kept(tail, head, rest):
        return head + (tail - head) / np.linalg.norm(tail - head) * np.linalg.norm(rest)


def tails(skeleton, bones, pose, world):
    placed = world @ pose.globals(skeleton)
    own = [placed[skeleton.index(bone.joint)] for bone in bones]
    return np.array([m[:3, :3] @ b.tail + m[:3, 3] for m, b in zip(own, bones, strict=True)])


def angles(one, other):
    turns = rotations.multiply(rotations.conjugate(one), other)
    return np.degrees(np.linalg.norm(rotations.to_rotation_vector(turns), axis=-1))


def test_at_60_hz_bones_swing_as_the_specification_says():
    skeleton, bones = head_with_hair()
    body, specified = SpringBody(skeleton, bones), Specified(skeleton, bones)
    pose, world = walking(skeleton, 0)
    for _ in range(SETTLING_STEPS):
        expected = specified.update(pose, world)
    free = Specified(*free_hair())
    hits, most = 0, 0.0
    for frame in range(200):
        pose, world = walking(skeleton, frame)
        if frame:
            expected = specified.update(pose, world)
        found = body.update(pose, world, frame and 1 / 60).rotations
        assert angles(found, expected).max() < 1e-4
        most = max(most, angles(found, pose.rotations).max())
        hits += angles(free.update(pose, world), expected).max() > 1.0
    assert most > 20.0  # they do swing
    assert hits > 50  # and hit colliders,
    assert specified.pushed_twice > 50  # also one after the other


def swung(rate, time=1.5):
    """Tails after walking for a time [s] at a frame rate [1/s]."""
    skeleton, bones = free_hair()
    body = SpringBody(skeleton, bones)
    for frame in range(round(time * rate) + 1):
        pose, world = walking(skeleton, frame * 60 / rate)
        shown = body.update(pose, world, frame and 1 / rate)
    return tails(skeleton, bones, shown, world)


def test_bones_swing_alike_at_any_frame_rate():
    at_60 = swung(60)
    skeleton, bones = free_hair()
    pose, world = walking(skeleton, 90)
    swing = np.linalg.norm(at_60 - tails(skeleton, bones, pose, world), axis=1).max()
    for rate in (24, 30, 50, 90, 120):
        assert np.linalg.norm(swung(rate) - at_60, axis=1).max() < 0.07 * swing, rate


def test_the_same_frames_give_the_same_bytes():
    assert swung(30).tobytes() == swung(30).tobytes()


def test_two_frames_at_one_time_but_for_rounding_are_one():
    skeleton, bones = free_hair()
    shown = []
    for rounding in (0.0, 4e-16):
        body = SpringBody(skeleton, bones)
        for frame in range(20):
            pose, world = walking(skeleton, frame)
            body.update(pose, world, frame and 1 / 60)
        body.update(pose, world, rounding)
        pose, world = walking(skeleton, 20)
        shown.append(body.update(pose, world, 1 / 60).rotations)
    assert angles(*shown).max() < 1e-6


def test_a_saved_state_goes_on_with_the_same_bytes():
    skeleton, bones = head_with_hair()
    body = SpringBody(skeleton, bones)
    for frame in range(20):
        pose, world = walking(skeleton, frame)
        body.update(pose, world, frame and 1 / 30)
    saved = pickle.loads(pickle.dumps(body))
    for frame in range(20, 40):
        pose, world = walking(skeleton, frame)
        one, other = (each.update(pose, world, 1 / 30) for each in (body, saved))
        assert one.rotations.tobytes() == other.rotations.tobytes()


def test_bones_keep_their_length_and_stay_finite_whatever_happens():
    skeleton, bones = head_with_hair()
    body, random = SpringBody(skeleton, bones), np.random.default_rng(1)
    lengths = [np.linalg.norm(bone.tail) for bone in bones]
    for elapsed in (0.0, 1 / 30, 0.0, 1e-7, 0.25, 1 / 60, 1e-3, 0.25):
        turns = rotations.normalize(random.normal(size=(9, 4)))
        world = np.eye(4)
        world[:3, 3] = random.normal(size=3) * 100
        pose = Pose(skeleton.rest.translations, turns)
        shown = body.update(pose, world, elapsed)
        placed = world @ shown.globals(skeleton)
        heads = [placed[skeleton.index(bone.joint), :3, 3] for bone in bones]
        found = tails(skeleton, bones, shown, world) - heads
        assert np.allclose(np.linalg.norm(found, axis=1), lengths)
        assert np.allclose(np.linalg.norm(shown.rotations, axis=1), 1.0)


def test_a_character_that_is_put_elsewhere_takes_its_swing_along():
    skeleton, bones = head_with_hair()
    body = SpringBody(skeleton, bones)
    for frame in range(60):
        pose, world = walking(skeleton, frame)
        before = body.update(pose, world, 1 / 60)
    away = np.eye(4)
    away[:3, :3] = rotations.to_matrix(rotations.about("y", 2.0))
    away[:3, 3] = [5.0, 0.0, -3.0]
    after = body.update(pose, away @ world, 1 / 60)
    swing = angles(before.rotations, pose.rotations).max()
    assert swing > 10.0
    assert angles(before.rotations, after.rotations).max() < 0.5 * swing
    still = [body.update(pose, away @ world, 0.0).rotations for _ in range(3)]
    assert np.allclose(still[0], after.rotations)
    assert np.allclose(still[0], still[2])


def test_hair_hangs_at_rest_in_the_first_frame():
    skeleton, bones = head_with_hair()
    body = SpringBody(skeleton, [replace(bone, gravity=(0.0, -2.0, 0.0)) for bone in bones])
    pose, world = walking(skeleton, 0)
    first = body.update(pose, world, 0.0).rotations
    assert angles(first, pose.rotations).max() > 10.0
    for _ in range(60):
        later = body.update(pose, world, 1 / 60).rotations
        assert angles(first, later).max() < 1.0


def test_bones_with_a_center_do_not_feel_how_it_moves():
    skeleton, bones = free_hair()
    bones = [replace(bone, center="j1", gravity=(0.0, 0.0, 0.0)) for bone in bones]
    body = SpringBody(skeleton, bones)
    for frame in range(30):
        pose, world = walking(skeleton, frame)
        shown = body.update(pose, world, frame and 1 / 60)
        assert angles(shown.rotations, pose.rotations).max() < 1e-3


@pytest.mark.parametrize(("wind", "least", "most"), [(1.0, 15.0, 180.0), (0.0, 0.0, 0.1)])
def test_steady_speed_over_the_table_blows_hair_back_as_far_as_there_is_wind(wind, least, most):
    skeleton, bones = free_hair()
    bones = [replace(bone, wind=wind, gravity=(0.0, 0.0, 0.0)) for bone in bones]
    body, world = SpringBody(skeleton, bones), np.eye(4)
    for frame in range(240):
        world[0, 3] = 1.0 * frame / 60
        shown = body.update(skeleton.rest, world, frame and 1 / 60)
    assert least <= angles(shown.rotations, skeleton.rest.rotations).max() <= most


def test_bones_of_scaled_joints_swing_in_their_real_size():
    skeleton, bones = free_hair()
    scales = np.ones((9, 3))
    scales[0] = 0.01
    offsets = skeleton.rest.translations * 100
    offsets[0] /= 100
    scaled = Skeleton(
        skeleton.names, skeleton.parents, Pose(offsets, skeleton.rest.rotations, scales)
    )
    longer = [replace(bone, tail=tuple(np.array(bone.tail) * 100)) for bone in bones]
    body, large = SpringBody(skeleton, bones), SpringBody(scaled, longer)
    for frame in range(60):
        pose, world = walking(skeleton, frame)
        shown = body.update(pose, world, frame and 1 / 60)
        other = large.update(Pose(offsets, pose.rotations, scales), world, frame and 1 / 60)
        assert angles(shown.rotations, other.rotations).max() < 1e-6

"""Spring bones, constraints and how eyes follow, in files of our own."""

import json
from dataclasses import replace

import pytest

from cubeling.characters import Character, CharacterError
from cubeling.characters.model.constraints import JointConstraint
from cubeling.characters.model.look_at import LookAt, RangeMap
from cubeling.characters.model.springs import SpringBone, SpringCollider
from cubeling.characters.retargeting.root import with_root_joint
from tests.characters.formats.built_gltf import build_arm, glb

BALL = SpringCollider("upper", (0.0, 0.1, 0.0), (0.0, 0.2, 0.0), 0.05)
SPRINGS = (
    SpringBone("lower", (0.0, 0.1, 0.0), 0.5, 0.3, (0.0, -0.2, 0.0), 0.01, (BALL,), "upper"),
    SpringBone("upper", (0.0, 0.3, 0.0)),
)
CONSTRAINTS = (JointConstraint("roll", "lower", "upper", (0.0, 1.0, 0.0), 0.5),)
LOOK_AT = LookAt(
    "expression",
    RangeMap(0.1, 1.0),
    RangeMap(0.2, 1.0),
    RangeMap(0.3, 0.5),
    RangeMap(0.4, 1.0),
    (0.0, 0.1, 0.0),
)


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.glb").write_bytes(build_arm().bytes())
    return replace(
        Character.load(tmp_path / "arm.glb"),
        springs=SPRINGS,
        constraints=CONSTRAINTS,
        look_at=LOOK_AT,
    )


def test_what_follows_the_body_survives_saving(arm, tmp_path):
    arm.save(tmp_path / "saved.glb")
    again = Character.load(tmp_path / "saved.glb")
    assert again.springs == SPRINGS
    assert again.constraints == CONSTRAINTS
    assert again.look_at == LOOK_AT


def test_a_body_that_nothing_follows_is_saved_without_it(arm, tmp_path):
    replace(arm, springs=(), constraints=(), look_at=None).save(tmp_path / "saved.glb")
    assert b"cubelingFollowers" not in (tmp_path / "saved.glb").read_bytes()


def test_it_follows_the_same_joints_of_a_body_with_a_new_root(arm):
    renamed = replace(arm, skeleton=replace(arm.skeleton, names=("root", *arm.skeleton.names[1:])))
    ball = replace(BALL, joint="root")
    renamed = replace(renamed, springs=(replace(arm.springs[0], colliders=(ball,)),))
    rooted = with_root_joint(replace(renamed, semantics={"hips": "root"}))
    assert rooted.skeleton.names[:2] == ("root", "root_")
    assert rooted.springs[0].colliders[0].joint == "root_"
    assert rooted.springs[0].joint == "lower"
    assert rooted.constraints == arm.constraints


def changed(key, **changes):
    def change(extra):
        part = extra[key][0] if isinstance(extra[key], list) else extra[key]
        part.update(changes)

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (changed("springs", joint="tail"), "has no joint 'tail'"),
        (changed("springs", joint="upper"), "a joint has two spring bones"),
        (changed("springs", tail=[0, 0, 0]), "the spring bone 'lower' has no length"),
        (changed("springs", drag=1.5), "the spring bone 'lower' has no length, or gains speed"),
        (changed("springs", drag=None), r"springs\[0\]\.drag is None, not a number"),
        (changed("springs", colour=1), "unexpected keyword argument 'colour'"),
        (changed("constraints", kind="bend"), "'bend' is no constraint"),
        (changed("constraints", source="lower"), "constraints of lower follow each other"),
        (changed("look_at", by="magic"), "look_at is by neither bone nor expression"),
        (changed("look_at", up={"greatest": 0, "output": 1}), "or has no range"),
        (lambda extra: extra.update(springs=3), "springs is not a list"),
    ],
)
def test_what_follows_the_body_is_refused_if_it_is_invalid(arm, tmp_path, change, reason):
    arm.save(tmp_path / "saved.glb")
    data = (tmp_path / "saved.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document, blob = json.loads(data[20 : 20 + length]), data[28 + length :]
    change(document["scenes"][0]["extras"]["cubelingFollowers"])
    (tmp_path / "saved.glb").write_bytes(glb(document, blob))
    with pytest.raises(CharacterError, match=reason):
        Character.load(tmp_path / "saved.glb")

"""Schedules in XML: shares, spellings, and what is wrong at which line."""

from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Clip, Pose
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.schedule import Schedule
from cubeling.characters.motion.schedule_file import ScheduleReader
from cubeling.characters.skeleton import rotations

EXAMPLES = Path(__file__).parents[3] / "docs" / "schedules"
RATE = 25.0


class Nod:
    """Idle motion without an end: the whole body leans the more, the later it is."""

    def __init__(self, human: Character) -> None:
        self.human = human

    duration = float("inf")

    def sample(self, time: float) -> Pose:
        """Return the rest pose turned about x."""
        return leaning(self.human, 0.01 * time)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement."""
        return RootDelta()


def leaning(human: Character, angle: float) -> Pose:
    rest = human.skeleton.rest
    return Pose(rest.translations, rotations.multiply(rest.rotations, rotations.about("x", angle)))


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module")
def reader(human: Character) -> ScheduleReader:
    """Reads schedules whose idle clip leans by 0, and whose gesture leans by 1 rad."""

    def motion(name: str) -> Clip:
        if name not in ("human#idle", "human#wave"):
            raise CharacterError(f"no motion {name!r}")
        pose = leaning(human, float(name.endswith("wave")))
        frames = 226 if name.endswith("idle") else 51
        still = Pose(*(np.repeat(p[None], frames, 0) for p in (pose.translations, pose.rotations)))
        return Clip(name, RATE, still, loop=False)

    filters = {"upright": lambda: lambda pose: leaning(human, 0.0)}
    return ScheduleReader(
        human.skeleton, human.anatomy, motion, lambda name: lambda: Nod(human), filters
    )


def example(reader: ScheduleReader, name: str) -> Schedule:
    return reader.read((EXAMPLES / f"{name}.xml").read_bytes(), name)


def share(human: Character, pose: Pose, part: str) -> float:
    """Return how much of the lean of the gesture a body part shows, by its quaternion."""
    joint = human.anatomy.joints[part]
    rest = human.skeleton.rest.rotations[joint]
    x, _, _, w = rotations.multiply(rotations.conjugate(rest), pose.rotations[joint])
    # The weighted mean of quaternions (0, 0, 0, 1) and (sin ½, 0, 0, cos ½), normalized.
    sine, cosine = np.sin(0.5), np.cos(0.5)
    return float(x / (sine * w + x * (1.0 - cosine)))


def test_a_copy_is_the_motion_itself(human, reader) -> None:
    copy = example(reader, "copy")
    assert copy.duration == 9.0
    for time in (0.0, 3.3, 9.0):
        assert np.array_equal(copy.sample(time).rotations, leaning(human, 0.0).rotations)


def test_a_stretched_motion_has_the_length_asked_for(reader) -> None:
    assert example(reader, "stretch").duration == 5.0


@pytest.mark.parametrize("name", ["gesture", "fade", "endless"])
def test_shares_of_the_gesture_are_those_of_the_documents(human, reader, name) -> None:
    mixed = example(reader, name)
    assert share(human, mixed.sample(0.9), "chest") == pytest.approx(0.0, abs=0.01)
    middle = mixed.sample(2.0)
    for part in ("chest", "head", "leftHand"):
        assert share(human, middle, part) == pytest.approx(1.0 / 1.1, abs=0.01)
        if name != "endless":
            assert share(human, middle, part) == pytest.approx(0.9091, abs=1e-4)
    for part in ("hips", "leftFoot"):
        assert share(human, middle, part) == pytest.approx(0.0, abs=0.03)
    if name == "fade":  # half of a fade of 20 % of 2 s
        assert share(human, mixed.sample(1.2), "chest") == pytest.approx(0.8333, abs=1e-4)


def test_idle_motion_goes_on_after_the_end(human, reader) -> None:
    later = example(reader, "endless").sample(50.0)
    assert np.allclose(later.rotations, Nod(human).sample(50.0).rotations)


def document(action: str = "", rest: str = "", params: str = "") -> bytes:
    return f"""<blendingschedule>
<actionpool>
<blendingaction id="a">
{params}
<blendableobject type="keyframebodyanimation">human#wave</blendableobject>
{action}
</blendingaction>
</actionpool>
<activate id="a" offset="0.5f"/>
{rest}
</blendingschedule>""".encode()


def test_two_actions_do_not_share_one_idle_motion(reader) -> None:
    pool = "".join(
        f'<blendingaction id="{name}"><blendableobject type="idlemotion">'
        "<balance>human</balance></blendableobject></blendingaction>"
        for name in "ab"
    )
    text = (
        f"<blendingschedule><actionpool>{pool}</actionpool>"
        '<activate id="a" offset="0"/><activate id="b" offset="5"/></blendingschedule>'
    )
    one, other = reader.read(text.encode(), "idle.xml").actions
    assert one.motion is not other.motion


def test_joints_scopes_and_scales_override_each_other(human, reader) -> None:
    joints = """<blendingparams type="joints"><default weight="2" scaling="0.5"/>
        <rotation id="skullbase" weight="1" scaling="1"/><rotation id="LeftArm" weight="0"/>
        <scope id="torso" weight="4"/></blendingparams>"""
    (action,) = reader.read(document(params=joints), "x").actions
    assert action.weight == 4.0
    head, arm, leg = (human.anatomy.joints[p] for p in ("head", "leftUpperArm", "leftUpperLeg"))
    assert action.mask[[head, arm, leg]].tolist() == [0.25, 0.0, 0.5]
    assert action.scales[[head, arm, leg]].tolist() == [1.0, 0.5, 0.5]
    assert action.start == 0.5


def test_an_action_may_be_activated_twice(reader) -> None:
    twice = reader.read(document(rest='<activate id="a" offset="3"/>'), "x")
    assert [action.name for action in twice.actions] == ["a", "a #2"]
    assert twice.duration == 5.0


@pytest.mark.parametrize("kind", ["adsr", "cubicadsr", "gonioadsr"])
def test_envelopes_are_read(reader, kind) -> None:
    shape = f"""<blendingparams type="curve"><curveshape type="{kind}"><attack>10</attack>
        <decay>20</decay><sustain>40</sustain><release>10</release></curveshape></blendingparams>"""
    (action,) = reader.read(document(params=shape), "x").actions
    values = [action.weight_at(0.5 + time) for time in (0.0, 0.2, 1.0, 2.0)]
    assert values == pytest.approx([0.0, 1.0, 0.4, 0.0])


def test_a_modifier_filters_poses(human, reader) -> None:
    own = b'<blendableobject type="keyframebodyanimation">human#wave</blendableobject>'
    filtered = b'<blendableobject type="modifier"><modifier type="upright"/>' + own
    text = document().replace(own, filtered + b"</blendableobject>")
    plain, upright = (reader.read(each, "x").sample(1.0) for each in (document(), text))
    assert upright.rotations == pytest.approx(leaning(human, 0.0).rotations)
    assert not np.allclose(plain.rotations, upright.rotations)
    with pytest.raises(CharacterError, match='"flip" is not known here; there are stretch, window'):
        reader.read(text.replace(b"upright", b"flip"), "x")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (document(rest="<speed/>"), "x:10: <speed> is not known in <blendingschedule>"),
        (document(action="<loop/>"), "x:6: <loop> is not known in <blendingaction>"),
        (document(rest='<activate id="b"/>'), "x:10: no action 'b'; there are a"),
        (document(rest='<activate id="a" offset="soon"/>'), 'x:10: offset="soon" is not a number'),
        (document(params='<blendingparams type="sine"/>'), 'x:4: type="sine" is not known here'),
        (
            document(params='<blendingparams type="joints"><scope id="tail"/></blendingparams>'),
            "x:4: no scope 'tail'; there are all, torso",
        ),
        (
            document(
                params='<blendingparams type="joints"><default weight="-1"/></blendingparams>'
            ),
            "x:4: a weight below 0",
        ),
        (document().replace(b"human#wave", b"gone.bvh"), "x:5: no motion 'gone.bvh'"),
        (document().replace(b"human#wave", b" "), "x:5: <blendableobject> names no file"),
        (document().replace(b"</actionpool>", b""), "x:11: not XML (mismatched tag)"),
        (
            document(params='<blendingparams type="fade"><fadein>-5</fadein></blendingparams>'),
            "x:4: fadein is -5 percent; give 0 to 100",
        ),
        (document(action='</blendingaction><blendingaction id="a">'), "x:6: a second action 'a'"),
        (b"<a>" * 100, "x:1: more than 60 nested elements"),
        (
            b"<a " + b" ".join(b"a%d='1'" % number for number in range(101)) + b"/>",
            "x:1: an element of more than 100 attributes",
        ),
        (b"<blendingschedule/>", "x:1: no action is activated; add <activate>"),
        (b"<schedule/>", "x:1: <schedule> is not a <blendingschedule>"),
        (b"", "x:1: not XML (no element found)"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "x:1: DTDs and entities are not read"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(reader, text, message) -> None:
    with pytest.raises(CharacterError) as error:
        reader.read(text, "x")
    assert str(error.value).startswith(message)


def test_a_fade_of_an_endless_motion_has_no_length(reader) -> None:
    text = (EXAMPLES / "endless.xml").read_bytes()
    params = b'<blendingparams type="fade"><fadein>20</fadein></blendingparams>'
    start, end = text.index(b"<blendingparams"), text.index(b"</blendingparams>") + 17
    with pytest.raises(CharacterError, match="x:5: a fade in percent of a motion without an end"):
        reader.read(text[:start] + params + text[end:], "x")

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
)
from cubeling.characters.control.builtin_tree import built_in_trees
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.model.sidecar import read_sidecar
from cubeling.characters.motion.trees.building import Builder
from cubeling.characters.motion.trees.conditions import Condition, ConditionError
from cubeling.characters.motion.trees.dot import to_dot
from cubeling.characters.motion.trees.plan import NODE_KINDS, PARAMETERS
from cubeling.characters.motion.trees.reading import read_plan
from cubeling.toml_file import TomlTable, parse
from tests.examples import examples

HUMAN_TOML = """
[parameters]
speed = { lag = 0.2 }

[masks.upper]
subtrees = { chest = 1.0 }

[motions.walking]
kind = "space"
by = "angular"
at = [
  { value = 60, motion = { kind = "mirror", of = "WalkLeftMedium" } },
  { value = 0, motion = "Walk" },
  { value = -60, motion = "WalkLeftMedium" },
]

[motions.going]
kind = "space"
by = "speed"
at = [{ value = 2.75, motion = "walking" }, { value = 3.25, motion = "Run" }]

[motions.lively]
kind = "add"
base = "going"
over = "idle"
mask = "upper"
weight = "weight"

[machine]
start = "rest"
states = { rest = "idle", move = "lively" }
changes = [
  { from = "rest", to = "move", when = "speed > 0.5", seconds = 0.3 },
  { from = "move", to = "rest", when = "speed < 0.3", crossfade = true },
]
"""

CLIPS = ("idle", "Walk", "Run", "WalkLeftMedium")


def plan(text, clips=CLIPS):
    return read_plan(TomlTable(parse(text, "x.toml"), "x.toml", error=CharacterError), clips)


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def builder(human, text):
    read = plan(text, human.clips)
    assert read is not None
    mirror = mirror_of(human)
    return read, Builder(read, human.skeleton, human.clips, human.anatomy, lambda: mirror)


def test_a_character_plays_the_plan_of_its_sidecar(human, tmp_path):
    human.save(tmp_path / "own.glb")
    (tmp_path / "own.toml").write_text(HUMAN_TOML)
    animator = Animator(Character.load(tmp_path / "own.glb"))
    target = np.array([0.2, 0.25])
    states = []
    for number in range(180):
        posed = animator.update(CharacterCommand(number / 30, LocomotionIntent(2.0, target)))
        states.append(posed.state)
    assert states[3] == "move"
    assert states[-1] == "rest"
    assert np.hypot(*(posed.table_from_character[[0, 2], 3] - target)) < 0.06


def test_no_joint_jumps_while_states_and_parameters_change(human):
    read, _ = builder(human, HUMAN_TOML)
    animator = Animator(replace(human, plan=read), layers=FOOT_LAYERS)
    rng = np.random.default_rng(5)
    turns = []
    for number in range(600):
        if number % 25 == 0:
            speed, target = rng.uniform(0.0, 4.5), rng.uniform(-0.6, 0.6, 2)
        command = CharacterCommand(number / 60, LocomotionIntent(float(speed), target))
        turns.append(animator.update(command).pose.rotations)
    dots = np.abs(np.einsum("fji,fji->fj", turns[1:], turns[:-1]))
    assert 2 * np.arccos(np.clip(dots, 0, 1)).max() < np.radians(25)


EVERY_KIND = """
play = "all"
[masks.top]
joints = { head = 1.0 }
[motions]
held = { kind = "hold", of = "Walk", at = 0.2 }
longer = { kind = "stretch", of = "Walk", seconds = 2.0 }
part = { kind = "window", of = "Walk", start = 0.1, end = 0.6 }
rounds = { kind = "loop", of = "part" }
other = { kind = "mirror", of = "Walk" }
away = { kind = "displace", of = "Walk", x = 0.1, yaw_deg = 20 }
bent = { kind = "warp", of = "Walk", times = [0, 1], sources = [0, 0.5] }
slow = { kind = "pace", of = "Walk", rate = 0.5 }
half = { kind = "blend", of = [{ motion = "Walk", weight = 1 }, { motion = "other", weight = 3 }] }
all = { kind = "schedule", actions = [
  { motion = "half", always = true },
  { motion = "held", start = 0.5, mask = "top", fade_in = 0.2 },
  { motion = "later", weight = 0.2 },
] }
later = { kind = "crossfade", first = "longer", second = "rounds", start = 0.5 }
flat = { kind = "plane", by = ["speed", "angular"], at = [
  { value = [0, 0], motion = "idle" },
  { value = [2, 0], motion = "slow" },
  { value = [2, 90], motion = "away" },
] }
topped = { kind = "layer", base = "flat", over = "bent", mask = "top", weight = 0.5 }
"""


def test_every_kind_of_motion_plays(human):
    read, made = builder(human, EVERY_KIND)
    assert read.root is not None
    motion, bindings = made.build(read.root, dict.fromkeys(PARAMETERS, 0.0))
    named = parse(EVERY_KIND, "x.toml")["motions"]
    assert {table["kind"] for table in named.values()} | {"clip", "add", "space"} == set(NODE_KINDS)
    for time in (0.0, 0.4, 0.9, 3.0):
        pose = motion.sample(time)
        assert np.allclose(np.linalg.norm(pose.rotations, axis=-1), 1.0)
        assert np.isfinite(motion.travel(0.0, time).z)
    assert not bindings.motions


def test_parametric_motions_follow_their_parameters_and_keep_their_phase(human):
    read, made = builder(human, EVERY_KIND.replace('play = "all"', 'play = "topped"'))
    assert read.root is not None
    values = dict.fromkeys(PARAMETERS, 0.0)
    motion, bindings = made.build(read.root, values)
    standing = motion.travel(0.0, 1.0)
    bindings.set_values({**values, "speed": 2.0}, 1.0)
    assert motion.travel(1.0, 2.0).z > standing.z + 0.3
    before = motion.sample(1.5)
    bindings.set_values({**values, "speed": 2.0}, 1.5)
    assert np.allclose(motion.sample(1.5).rotations, before.rotations, atol=1e-9)


MISTAKES = {
    "play = 3": "play must be a table, not 3",
    'play = "Wlk"': "play is 'Wlk', which is not known; did you mean 'Walk'",
    "[motions]\na = 'Walk'": "write either play",
    "play = 'a'\n[motions]\na = 'b'\nb = 'a'": "a -> b -> a: a motion cannot be made of itself",
    "play = {kind = 'strech', of = 'Walk'}": "play.kind is 'strech', .* did you mean 'stretch'",
    "play = {of = 'Walk'}": "play.kind is missing; it must be one of clip",
    "play = {kind = 'stretch', of = 'Walk'}": "play.seconds is missing; it must be a number",
    "play = {kind = 'loop', of = 'Walk', offf = 1}": "offf means nothing here; did you mean 'of'",
    "play = {kind = 'stretch', of = 'Walk', seconds = nan}": "seconds must be a number, not nan",
    "play = {kind = 'space', by = 'spede', at = []}": "play.by is 'spede', .* did you mean",
    "play = {kind = 'space', by = 'speed', at = []}": "play.at: give a list",
    "play = {kind = 'space', by = 'speed', at = [{value = 'a', motion = 'Walk'}]}": (
        r"play.at\[0\].value must be a number, not 'a'"
    ),
    "play = {kind = 'layer', base = 'Walk', over = 'idle', mask = 'up'}": "play.mask must be",
    "play = {kind = 'plane', by = ['speed', 'speed'], at = []}": "play.by must be two different",
    "play = 'Walk'\nmachine = {states = {a = 'Walk'}}": "write either play",
    "machine = {states = {}}": "machine.states: name at least one",
    "machine = {start = 'b', states = {a = 'Walk'}}": "machine.start must be one of a, not 'b'",
    "machine = {states = {a = 'Walk'}, changes = [{to = 'b', when = 'done'}]}": (
        r"machine.changes\[0\].to must be one of a, not 'b'"
    ),
    "machine = {states = {a = 'Walk'}, changes = [{to = 'a', when = 'speed >'}]}": "cannot be read",
    "machine = {states = {a = 'Walk'}, changes = [{to = 'a', when = 'sped > 1'}]}": "'sped'",
    "machine = {states = {a = 'Walk'}, changes = [{to = 'a', when = 'done', seconds = 0}]}": (
        "seconds must be more than 0 and at most 10, not 0"
    ),
    "play = 'Walk'\n[parameters]\nspeed = {lag = -1}": "speed.lag must be a number of at least 0",
    f"play = {{kind = 'stretch', of = 'Walk', seconds = 1{400 * '0'}}}": "play.seconds must be",
    "play = 'm0'\n[motions]\nm40 = 'Walk'\n"
    + "\n".join(f"m{n} = 'm{n + 1}'" for n in range(40)): "nest more than 30 deep",
    "play = 'm0'\n[motions]\nm20 = 'Walk'\n"
    + "\n".join(
        f"m{n} = {{kind = 'add', base = 'm{n + 1}', over = 'm{n + 1}'}}" for n in range(20)
    ): "made of more than 1000 motions",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_is_reported_with_its_place_in_the_file(text):
    with pytest.raises(CharacterError, match=MISTAKES[text]) as caught:
        plan(text)
    assert str(caught.value).startswith("x.toml: ")
    assert "\n" not in str(caught.value)


def test_an_unplayable_motion_is_reported_with_its_place_in_the_file(human):
    text = "play = {kind = 'window', of = 'Walk', start = 2, end = 1}"
    read, made = builder(human, text)
    assert read.root is not None
    with pytest.raises(CharacterError, match=r"x\.toml: play: window: 2\.0 s to 1\.0 s"):
        made.build(read.root, dict.fromkeys(PARAMETERS, 0.0))


def test_a_mask_of_an_unknown_joint_is_reported(human):
    text = "play = {kind = 'layer', base = 'Walk', over = 'idle', mask = 'm'}\n"
    read, made = builder(human, text + "[masks.m]\njoints = {hed = 1.0}")
    assert read.root is not None
    with pytest.raises(CharacterError, match=r"x\.toml: masks\.m: .*'hed'"):
        made.build(read.root, dict.fromkeys(PARAMETERS, 0.0))


@pytest.mark.parametrize(
    ("text", "values", "holds"),
    [
        ("speed > 0.5", {"speed": 1.0}, True),
        ("0 < speed <= 3 and not done", {"speed": 3.0, "done": False}, True),
        ("action == 'kiss' or weight >= -0.5", {"action": "idle", "weight": -0.6}, False),
        ("done", {"done": True}, True),
    ],
)
def test_conditions_are_evaluated(text, values, holds):
    numbers = frozenset({"speed", "weight", "done"})
    condition = Condition.read(text, frozenset({"action"}), numbers)
    assert condition.holds(values) is holds


@pytest.mark.parametrize(
    "text",
    ["speed + 1 > 2", "__import__('os')", "speed.real > 0", "[x for x in y]", "speed > 'a'", ""]
    + ["action < 'b'", "1", "speed if done else 0", "speed is 1", "(" * 300, "f'{speed}' == 'a'"],
)
def test_expressions_other_than_comparisons_are_refused(text):
    with pytest.raises(ConditionError):
        Condition.read(text, frozenset({"action"}), frozenset({"speed", "done"}))


@settings(max_examples=examples(60), deadline=None)
@given(st.data())
def test_any_document_is_read_or_refused_in_one_line(data):
    document = parse(HUMAN_TOML, "x.toml")
    words = st.sampled_from(["Walk", "idle", "going", "kind", "of", "speed", "machine", "at", "up"])
    junk = st.one_of(words, st.floats(), st.booleans(), st.lists(words, max_size=2), st.none())
    for _ in range(data.draw(st.integers(1, 4))):
        table = document
        while True:
            key = data.draw(st.sampled_from(sorted(table)))
            if not isinstance(table[key], dict) or data.draw(st.booleans()) or not table[key]:
                break
            table = table[key]
        table[key] = data.draw(junk)
    message = "x.toml: "
    try:
        read_plan(TomlTable(document, "x.toml", error=CharacterError), CLIPS)
    except CharacterError as error:
        message = str(error)
    assert message.startswith("x.toml: ")
    assert "\n" not in message


def test_a_sidecar_declares_body_parts(human, tmp_path):
    human.save(tmp_path / "own.glb")
    (tmp_path / "own.toml").write_text("[joints]\nhead = 'neck'\n")
    assert Character.load(tmp_path / "own.glb").semantics["head"] == "neck"
    (tmp_path / "own.toml").write_text("[joints]\nhead = 'hed'\n")
    with pytest.raises(CharacterError, match=r"own\.toml: joints\.head: no joint 'hed'"):
        Character.load(tmp_path / "own.glb")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = = 1", "not TOML"),
        ("[jonts]\nx = 1", "jonts means nothing here; did you mean 'joints'"),
        ("[joints]\nbeak = 'head'", "joints.beak means nothing here; there are hips"),
        ("[joints]\nhead = 3", "joints.head must be a text, not 3"),
        (
            "[body]\ncollision = true",
            "collision means nothing here; did you mean",
        ),
        ("[body]\nself_collision = 1", "body.self_collision must be true or false, not 1"),
        ("body = 1", "body must be a table of dependent_joints, self_collision, not 1"),
        ("\xff", "not UTF-8"),
    ],
)
def test_an_invalid_sidecar_is_refused(tmp_path, text, message):
    path = Path(tmp_path / "own.toml")
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(CharacterError, match=message):
        read_sidecar(path, CLIPS)


@pytest.mark.parametrize("name", Character.bundled_names())
def test_a_graph_shows_every_clip_that_a_character_plays(name):
    character = Character.load(name)
    shown = built_in_trees(character)
    graph = to_dot(shown, name)
    assert graph.startswith(f'digraph "{name}" {{')
    used = {row.motion.name for root in shown.roots for row in root.rows} | {"idle"}
    for each in used & set(character.clips):
        assert f'"{each}\\nclip"' in graph


def test_a_character_without_clips_has_no_graph():
    still = replace(Character.load("robot"), clips={})
    with pytest.raises(CharacterError, match="robot: has no clips"):
        built_in_trees(still)


def test_a_motion_that_is_used_twice_is_one_box_with_two_edges():
    text = "play = {kind = 'blend', of = [{motion = 'a', weight = 1}, {motion = 'a', weight = 1}]}"
    read = plan(text + "\n[motions]\na = {kind = 'loop', of = 'Walk'}")
    assert read is not None
    graph = to_dot(read)
    assert graph.count('"a\\nloop"') == 1
    assert graph.count("motion0 -> motion1") == 2


def test_a_graph_shows_states_transitions_and_fields(human):
    read, _ = builder(human, HUMAN_TOML)
    lines = to_dot(read).splitlines()
    assert '  state0 [label="rest\\nfirst state", fillcolor="#fde7c8"]' in lines
    assert '  state0 -> state1 [label="speed > 0.5", style=dashed, constraint=false]' in lines
    for text in ("over angular", "add mask upper weight weight", '"−60"', '"2.75"', '"base"'):
        assert any(text in line for line in lines)


def test_quotes_in_a_condition_are_escaped():
    text = "machine = {states = {a = 'Walk'}, changes = [{to = 'a', when = 'action == \"a\"'}]}"
    read = plan(text)
    assert read is not None
    assert '  any -> state0 [label="action == \\"a\\"", style=dashed' in to_dot(read)


def test_the_documented_example_is_a_valid_plan():
    page = (Path(__file__).parents[3] / "docs" / "motion-files.md").read_text(encoding="utf-8")
    example = page.split("```toml")[1].split("```")[0]
    read = plan(example, ["idle", "Walk", "WalkLeft", "Run", "Wave"])
    assert read is not None
    assert {kind for kind in NODE_KINDS if f"`{kind}`" in page} | {"clip"} == set(NODE_KINDS)
    assert all(f"`{name}`" in page for name in PARAMETERS)

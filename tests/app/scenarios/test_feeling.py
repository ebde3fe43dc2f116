"""Character, virtual robot and robot show the same emotion in every frame."""

import math

import moderngl
import numpy as np
import pytest

from cubeling.affect import LABEL_SETS, Emotion, Personality
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.words import closest_word
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import EmotionTarget, Inputs
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.running.robots import RobotLine
from cubeling.app.scenarios import SCENARIOS, make_scenario
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.session import session_info
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.characters import Animator, Character, CharacterError
from cubeling.characters.rendering import create_context
from cubeling.robot import Catalogue, Telemetry
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.tracking import CubeState, Frame, Intrinsics
from tests.examples import some

LAG = 0.15
"""How long after a frame a simulated robot may still tell of the mood before [s]."""

BLACK = Frame(np.zeros((360, 640, 3), np.uint8), 0.0, 0)
UNSEEN = CubeState(False, None, np.full(6, np.nan), np.eye(6), "predicted", (), 0.0, 0.0)


@pytest.fixture(scope="module")
def virtual_robot():
    try:
        context = create_context()
    except CharacterError as missing:
        pytest.skip(str(missing))
    assert isinstance(context, moderngl.Context)
    made = VirtualRobot(context, 64)
    yield made
    made.close()
    context.release()


def session(name, hand):
    """Yield the controls of a session in which a lot happens."""
    yield from hand.wait(0.5)
    if name == "companion":
        for face in ("front", "left", "top"):
            yield from hand.tip(face)
            yield from hand.turn(1.0, 1.0)
            yield from hand.wait(4)
    else:
        if name == "sketch":
            for angle in (0.0, 2.0, 4.0):
                place = 0.15 * np.array([math.cos(angle), math.sin(angle)])
                yield hand.frame(position=place, resting=True)
            yield hand.frame(lifted=True, resting=False)
            yield hand.frame(lifted=False, resting=True)
        for degrees, seconds in ((90, 1), (180, 4), (0, 1)):
            yield hand.heading(degrees)
            yield from hand.wait(seconds)
        if name == "follow":
            for _ in range(2):
                yield hand.frame(gestures=("shaken",))
                yield from hand.wait(3)
    yield hand.frame(visible=False)
    yield from hand.wait(3)


def outcomes(name, hand, personality=None):
    """Yield the outcome of every frame of a session."""
    scenario = make_scenario(name, personality=personality)
    playground = Playground(scenario, Intrinsics.guess((640, 360)))
    for controls in session(name, hand):
        recorded = ReplayInputs(state=UNSEEN, controls=controls)
        yield playground.step(BLACK, replay=recorded).outcome


class Pair:
    """A host and a simulated robot on one wire, in the time of the session."""

    def __init__(self) -> None:
        self.host, self.robot, self.now = HostLink(host=7), Simulator(1), -1.0
        self.host.port_opened(self.now)
        self.run(0.0)

    def run(self, until: float) -> None:
        while self.now < until:
            self.now += 0.01
            self.host.receive(self.robot.bytes_to_send(), self.now)
            self.host.tick(self.now)
            self.robot.receive(self.host.bytes_to_send(), self.now)


def test_the_robot_receives_the_emotion_with_its_word():
    class ExpressingRobot:
        def express(self, emotion):
            self.expressed = emotion

    robot = ExpressingRobot()
    target = EmotionTarget(Emotion(0.6, 0.7, "excited"), 0.0)
    RobotLine(robot).feel(target)  # type: ignore[arg-type]  # it only calls `express`
    assert robot.expressed == target.emotion


def test_the_label_of_a_robot_without_feedback_is_its_closest_mood():
    class RobotWithoutFeedback:
        telemetry = Telemetry("ready", acknowledged=Emotion(-0.6, -0.4, "sad"))
        catalogue = Catalogue("silent", "", (), (), (), ("neutral", "happy", "angry"))

        def express(self, emotion):
            pass

    line = RobotLine(RobotWithoutFeedback())  # type: ignore[arg-type]  # all that this needs
    line.feel(EmotionTarget(Emotion(-0.6, -0.4, "sad"), 0.0))
    line.feel(EmotionTarget(Emotion(-0.7, 0.4, "angry"), 0.1))
    assert line.view().label == "neutral"


@pytest.mark.slow(reason="a session of many seconds is played")
@pytest.mark.parametrize(
    ("name", "personality"),
    some([("companion", None), ("follow", "shy"), ("sketch", None), ("companion", "lively"),
          ("follow", None)]),
)  # fmt: skip
def test_character_likeness_and_robot_show_one_mood(name, personality, hand, virtual_robot):
    pair, words, labels, since = Pair(), list[str](), set[str](), -math.inf
    assert pair.host.catalogue is not None
    moods = pair.host.catalogue.moods
    compared = 0
    for outcome in outcomes(name, hand, personality):
        target, command = outcome.emotion, outcome.command
        pair.run(target.timestamp)
        if words and target.timestamp - since > LAG:
            assert pair.host.telemetry(pair.now).label == words[-1]
            compared += 1
        pair.host.express(target.emotion)
        labels.add(target.emotion.label)
        played = virtual_robot.command(target)
        for shown in (command, played):
            assert shown.emotion == target.emotion
        word = str(closest_word(moods, target.emotion))
        assert played.activity == word
        if not words or words[-1] != word:
            words.append(word)
            since = target.timestamp
    assert compared > 100
    who = Personality.load(personality or make_scenario(name).personality)
    assert labels <= LABEL_SETS[who.labels].places.keys()
    assert len(labels) > 1


def follow(hand, *parts):
    """Return what is felt at the end of each part: seconds, and what changes at its start."""
    scenario, posed = make_scenario("follow"), None
    animator = Animator(Character.load("human")) if any("gestures" in f for _, f in parts) else None
    actions = animator.actions if animator else ()
    felt = []
    for seconds, first in parts:
        for number in range(round(seconds * 10)):
            controls = hand.frame(**(first if number == 0 else {}))
            hand.frames += 2  # a camera of ten frames a second
            outcome = scenario.update(controls, Situation(posed, actions=actions), Inputs())
            posed = animator.update(outcome.command) if animator else None
        felt.append(outcome.emotion)
    return felt


def test_running_stirs_more_than_walking_and_standing_calms(hand):
    rest, walk, run, stand = follow(
        hand,
        (1, {}),
        (6, {"camera_angle": math.radians(90)}),
        (6, {"camera_angle": math.pi}),
        (20, {"camera_angle": 0.0}),
    )
    arousals = [target.emotion.arousal for target in (rest, walk, run)]
    assert arousals == sorted(arousals)
    assert arousals[2] > arousals[1] + 0.2
    assert abs(stand.emotion.arousal - rest.emotion.arousal) < 0.05
    assert run.emotion.label != rest.emotion.label == stand.emotion.label


def test_a_shaken_cube_pleases_and_a_lost_one_lets_it_fade(hand):
    shaken = (3, {"gestures": ("shaken",)})
    before, *_, after, lost = follow(hand, (1, {}), shaken, shaken, (40, {"visible": False}))
    assert after.emotion.valence > before.emotion.valence + 0.2
    assert after.emotion.label != before.emotion.label == lost.emotion.label
    assert lost.emotion.valence == pytest.approx(before.emotion.valence, abs=0.05)


def test_a_gesture_of_ones_own_has_the_effect_that_the_personality_gives_it(hand):
    proud = Personality("proud", events={"raised": AffectImpulse(valence=0.4)})
    for personality, gain in ((proud, 0.4), (Personality.load("lively"), 0.0)):
        mood = MoodController(personality)
        before = mood.update(hand.frame(), "idle")
        after = mood.update(hand.frame(gestures=("raised",)), "idle")
        assert after.emotion.valence == pytest.approx(before.emotion.valence + gain, abs=0.02)


def test_time_that_runs_backwards_moves_nothing(hand):
    mood = MoodController(Personality.load("lively"))
    controls = hand.wait(1.0)
    for each in controls:
        late = mood.update(each, "kiss")
    early = mood.update(controls[0], "kiss")
    assert early.emotion == late.emotion
    assert early.timestamp == 0.0


def test_the_cube_out_of_sight_takes_no_runner_along(hand):
    run = {"camera_angle": math.pi}
    seen, hidden = follow(hand, (4, run), (6, {"visible": False, **run}))
    assert hidden.emotion.arousal < seen.emotion.arousal


def test_starting_over_forgets_what_was_felt(hand):
    for name in SCENARIOS:
        scenario = make_scenario(name)
        home = scenario.update(hand.frame(), Situation(), Inputs()).emotion
        for controls in [hand.frame(gestures=("shaken",)), *hand.tip("front"), *hand.wait(3)]:
            target = scenario.update(controls, Situation(), Inputs()).emotion
        again = scenario.update(hand.frame(), Situation(), Inputs(clear=True)).emotion
        assert target.emotion != home.emotion
        assert again.emotion == home.emotion


@pytest.mark.slow(reason="a session is played and replayed three times")
def test_a_personality_is_recorded_and_taken_in_the_replay(cubeling, short_session, tmp_path):
    made, other = tmp_path / "made.mcap", tmp_path / "other.mcap"
    quiet = ("--no-pictures", "--robot", "none")
    who = ("--personality", "grumpy")
    assert (
        cubeling("play", "companion", "-s", short_session, *quiet, *who, "--record", made)[0] == 0
    )
    assert session_info(made).options.personality == "grumpy"
    assert cubeling("replay", made, "--check")[0] == 0
    assert cubeling("replay", made, "--check", "--personality", "shy")[0] == 1
    shy = ("--personality", "shy", "--record", other)
    assert cubeling("replay", made, "--from", "pose", *quiet, *shy)[0] == 0
    assert session_info(other).options.personality == "shy"


def test_a_personality_that_is_none_is_refused_in_one_line(cubeling, short_session, tmp_path):
    (tmp_path / "mine.toml").write_text('name = "mine"\ndescription = "x"\nbogus = 1\n')
    for command in (["play", "follow", "-s", short_session], ["demo", "follow"]):
        for who in ("nobody", "mine.toml", "absent.toml"):
            code, _, err = cubeling(*command, "--personality", who)
            assert code == 2, (command, who)
            assert "Traceback" not in err
            assert len(err.strip().splitlines()) <= 3

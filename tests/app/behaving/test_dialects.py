"""Files of others are performed: each behaviour can be seen, on against off."""

import numpy as np
import pytest

from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.voice import PatientSource
from cubeling.app.show.blocks import BehaviourOptions, read_document
from cubeling.characters import CharacterError
from cubeling.characters.behaviour import BmlWarning
from tests.app.behaving.players import HUMAN, speech_of

RATE = 25

ACT = """<act><participant id="ann"/><bml>
<speech id="s"><mark name="T0"/>take <mark name="T1"/>the <mark name="T2"/>box</speech>
<sbm:animation name="ChrAnn@Idle01_BeatMidBt01" stroke="s:T1"/>
<gaze target="stranger" sbm:joint-range="EYES NECK"/>
<saccade mode="talk"/>
<sbm:levitate height="3"/>
</bml></act>"""


def beat(*numbers):
    """Return where the right hand is during a beat with these parameters, (frames, 3)."""
    inside = "".join(f"<{name}.value>{value}</{name}.value>" for name, value in numbers)
    player = BehaviourPlayer(HUMAN, PatientSource(speech_of, "en"))
    player.director.accept(
        '<bml><gesture id="g" lexeme="Beat_Pos_B_Social" start="0.2">'
        f'<description type="gretabml">{inside}</description></gesture></bml>'
    )
    hand = HUMAN.anatomy.joint("rightHand")
    poses = [player.update(number / RATE).posed.pose for number in range(round(1.6 * RATE))]
    return np.stack([pose.globals(HUMAN.skeleton)[hand, :3, 3] for pose in poses])


def test_spatial_extent_and_tempo_of_greta_change_how_a_hand_goes():
    far = {spc: beat(("SPC", spc)) for spc in (-0.6, 0.6)}
    reach = [np.linalg.norm(way - way[0], axis=1).max() for way in far.values()]
    assert reach[1] > reach[0] + 0.05  # metres of a person
    fast = [beat(("TMP", tmp)) for tmp in (-0.6, 0.6)]
    speeds = [np.linalg.norm(np.diff(way, axis=0), axis=1).max() for way in fast]
    assert speeds[1] > 1.5 * speeds[0]


def test_an_act_is_performed_and_what_is_not_is_warned_about_by_its_line():
    player = BehaviourPlayer(HUMAN, PatientSource(speech_of, "en"))
    player.director.accept(ACT)
    frames = [player.update(number / RATE) for number in range(2 * RATE)]
    realized = [frame.realized for frame in frames]
    assert any(each.gestures and each.gestures[0].gesture.name == "BEAT_BOTH" for each in realized)
    assert any(each.gazes for each in realized)
    assert any(each.sayings for each in realized)
    warnings = [e for frame in frames for e in frame.feedback if isinstance(e, BmlWarning)]
    told = [each.description for each in warnings]
    for part in (
        'line 3: nothing declares the prefix "sbm:"',
        "line 3: gesture ChrAnn@Idle01_BeatMidBt01 is taken as BEAT_BOTH",
        'line 4: "stranger" is given a place',
        "line 5: <saccade> is left out",
        "line 6: <levitate> is not known here",
    ):
        assert any(part in each for each in told), (part, told)


def test_strictly_the_same_file_is_refused(tmp_path):
    path = tmp_path / "act.xml"
    path.write_text(ACT, "utf-8")
    assert read_document(path) == ACT.encode()
    with pytest.raises(CharacterError, match=r"act\.xml: BML, line \d: not XML"):
        read_document(path, strict=True)
    player = BehaviourPlayer(HUMAN, PatientSource(speech_of, "en"), BehaviourOptions(strict=True))
    player.director.accept(ACT)
    (warning,) = player.update(0.0).feedback
    assert isinstance(warning, BmlWarning)
    assert warning.type == "PARSING_FAILURE"

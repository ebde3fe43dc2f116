from cubeling.characters.behaviour.bml.dialects import parse_dialect as parse_dialect
from cubeling.characters.behaviour.bml.document import BML as BML, Block as Block
from cubeling.characters.behaviour.bml.feedback import (
    BlockProgress as BlockProgress,
    BmlWarning as BmlWarning,
    Feedback as Feedback,
    feedback_xml as feedback_xml,
)
from cubeling.characters.behaviour.bml.parser import parse as parse
from cubeling.characters.behaviour.bml.realizer import Realizer as Realizer
from cubeling.characters.behaviour.bml.timing import CannotRealize as CannotRealize
from cubeling.characters.behaviour.expressivity import (
    NEUTRAL as NEUTRAL,
    GestureExpressivity as GestureExpressivity,
)
from cubeling.characters.behaviour.fml.planner import (
    behaviours_of as behaviours_of,
    shown_by as shown_by,
)
from cubeling.characters.behaviour.gestures.collection import (
    GestureCollection as GestureCollection,
    gestures_in as gestures_in,
)
from cubeling.characters.behaviour.gestures.files import (
    GESTURE_SUFFIX as GESTURE_SUFFIX,
    load_gesture as load_gesture,
    save_gesture as save_gesture,
)
from cubeling.characters.behaviour.gestures.motion import GestureMotion as GestureMotion
from cubeling.characters.behaviour.gestures.place.contacts import CONTACTS as CONTACTS
from cubeling.characters.behaviour.gestures.place.directions import (
    DIRECTIONS as DIRECTIONS,
    across as across,
)
from cubeling.characters.behaviour.gestures.place.space import (
    CENTRES_X_CM as CENTRES_X_CM,
    CENTRES_Y_CM as CENTRES_Y_CM,
    CENTRES_Z_CM as CENTRES_Z_CM,
    CHEST_CM as CHEST_CM,
    REFERENCE_ARM_M as REFERENCE_ARM_M,
    GestureSpace as GestureSpace,
)
from cubeling.characters.behaviour.gestures.planning import GestureRealizer as GestureRealizer
from cubeling.characters.behaviour.gestures.recording import (
    gesture_from_recording as gesture_from_recording,
)
from cubeling.characters.behaviour.gestures.style.effect import without_effect as without_effect
from cubeling.characters.behaviour.gestures.timing import (
    Repeats as Repeats,
    apex_share as apex_share,
    natural_times as natural_times,
    stroke_length as stroke_length,
)
from cubeling.characters.behaviour.intents import (
    BehaviourIntent as BehaviourIntent,
    GazeIntent as GazeIntent,
    GestureIntent as GestureIntent,
    Hand as Hand,
    HeadIntent as HeadIntent,
    ReachIntent as ReachIntent,
    StrokeTimes as StrokeTimes,
    Times as Times,
)
from cubeling.characters.behaviour.realization.character_realizer import (
    CharacterRealizer as CharacterRealizer,
)
from cubeling.characters.behaviour.realization.frame import (
    Manner as Manner,
    RealizationContext as RealizationContext,
    RealizedFrame as RealizedFrame,
    Saying as Saying,
)
from cubeling.characters.behaviour.realization.speech_kind import (
    estimate as estimate,
    retime_speeches as retime_speeches,
)
from cubeling.characters.behaviour.realization.surroundings import (
    NamedPlaces as NamedPlaces,
    numbers_of as numbers_of,
)
from cubeling.characters.behaviour.symbolic_gesture import (
    SECTORS_X as SECTORS_X,
    SECTORS_Y as SECTORS_Y,
    SECTORS_Z as SECTORS_Z,
    BodyKey as BodyKey,
    HandKey as HandKey,
    Place as Place,
    SymbolicGesture as SymbolicGesture,
)
from cubeling.characters.dialogue.grammar import phrases_of as phrases_of
from cubeling.characters.dialogue.kernel import (
    Dialogue as Dialogue,
    DialogueTurn as DialogueTurn,
    heard_of as heard_of,
)
from cubeling.characters.dialogue.reading import (
    SCRIPT_FILE as SCRIPT_FILE,
    read_script as read_script,
)
from cubeling.characters.dialogue.script import DialogueScript as DialogueScript
from cubeling.characters.dialogue.vocabulary import (
    CORE_VOCABULARY as CORE_VOCABULARY,
    MAX_LINE_CHARS as MAX_LINE_CHARS,
    ConditionKind as ConditionKind,
    Vocabulary as Vocabulary,
    act as act,
    only_text as only_text,
)
from cubeling.characters.xml_elements import (
    XmlElement as XmlElement,
    XmlLimits as XmlLimits,
    read_xml as read_xml,
)

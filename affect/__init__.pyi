from cubeling.affect.dynamics import Feelings as Feelings
from cubeling.affect.emotion import NEUTRAL as NEUTRAL, Emotion as Emotion
from cubeling.affect.errors import AffectError as AffectError
from cubeling.affect.hysteresis import ANGRY_BELOW as ANGRY_BELOW, HAPPY_ABOVE as HAPPY_ABOVE
from cubeling.affect.labels import LABEL_SETS as LABEL_SETS, LabelSet as LabelSet
from cubeling.affect.occ import OCC_FACES as OCC_FACES
from cubeling.affect.personality import Personality as Personality
from cubeling.affect.personality_file import (
    bundled_names as bundled_names,
    bundled_text as bundled_text,
)
from cubeling.affect.regions import Region as Region, region_of as region_of
from cubeling.affect.words import (
    WORD_FACES as WORD_FACES,
    WORD_PLACES as WORD_PLACES,
    closest_word as closest_word,
)

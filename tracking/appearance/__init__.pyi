from cubeling.tracking.appearance.appearance import (
    ENVIRONMENT_PX as ENVIRONMENT_PX,
    Appearance as Appearance,
    EnvironmentMap as EnvironmentMap,
    MeasuredLight as MeasuredLight,
    PictureQuality as PictureQuality,
)
from cubeling.tracking.appearance.hand.finder import HandFinder as HandFinder
from cubeling.tracking.appearance.hand.mask import HandMask as HandMask
from cubeling.tracking.appearance.light import LightMeter as LightMeter
from cubeling.tracking.appearance.meter import (
    APPEARANCE_PARTS as APPEARANCE_PARTS,
    AppearanceMeter as AppearanceMeter,
)
from cubeling.tracking.appearance.picture_quality import QualityMeter as QualityMeter
from cubeling.tracking.appearance.room.room_meter import RoomMeter as RoomMeter

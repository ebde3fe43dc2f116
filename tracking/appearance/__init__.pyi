from cubeling.tracking.appearance.hand.finder import HandFinder as HandFinder
from cubeling.tracking.appearance.hand.mask import EDGE_SLOPE as EDGE_SLOPE, HandMask as HandMask
from cubeling.tracking.appearance.light import LightMeter as LightMeter
from cubeling.tracking.appearance.picture_quality import QualityMeter as QualityMeter

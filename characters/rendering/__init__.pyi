from cubeling.characters.rendering.context import (
    create_context as create_context,
    draws_in_software as draws_in_software,
)
from cubeling.characters.rendering.deferred.ambient_occlusion import (
    NOTHING_M as NOTHING_M,
    AmbientOcclusion as AmbientOcclusion,
    AmbientOcclusionSettings as AmbientOcclusionSettings,
)
from cubeling.characters.rendering.drawing import (
    draw_clip as draw_clip,
    draw_picture as draw_picture,
    standing_pose as standing_pose,
)
from cubeling.characters.rendering.portrait import (
    PAPER_BGR as PAPER_BGR,
    PortraitRenderer as PortraitRenderer,
    side_by_side as side_by_side,
)
from cubeling.characters.rendering.portrait_camera import (
    CharacterExtent as CharacterExtent,
    PortraitCamera as PortraitCamera,
    joints_below as joints_below,
)
from cubeling.characters.rendering.programs import ShaderPrograms as ShaderPrograms
from cubeling.characters.rendering.quality import (
    FULL as FULL,
    QUALITIES as QUALITIES,
    Effect as Effect,
    Quality as Quality,
)
from cubeling.characters.rendering.scene import (
    RIM_SHARE as RIM_SHARE,
    WALL_SHARE as WALL_SHARE,
    Box as Box,
    CameraView as CameraView,
    FloorPath as FloorPath,
    Focus as Focus,
    HandInFront as HandInFront,
    RoomLight as RoomLight,
    RoomMap as RoomMap,
    Scene as Scene,
    SceneCharacter as SceneCharacter,
    Softness as Softness,
)
from cubeling.characters.rendering.stage import Stage as Stage
from cubeling.characters.rendering.toys import GRIP_M as GRIP_M, toy as toy

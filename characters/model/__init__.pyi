from cubeling.characters.face.preset_face import PRESETS as PRESETS, PresetFace as PresetFace
from cubeling.characters.formats.loading import (
    RecordedMotion as RecordedMotion,
    is_motion_only as is_motion_only,
    load_motion as load_motion,
)
from cubeling.characters.formats.mocap.bvh_writing import save_bvh as save_bvh
from cubeling.characters.model.bind_pose import with_bind_pose as with_bind_pose
from cubeling.characters.model.inspection import (
    ClipStats as ClipStats,
    FootContactStats as FootContactStats,
    Inspection as Inspection,
    inspect as inspect,
)
from cubeling.characters.model.motion_library import library_of as library_of
from cubeling.characters.model.speaking import gestures_for as gestures_for
from cubeling.characters.model.standing import idle_clips as idle_clips
from cubeling.characters.model.stick_figures import stick_figure as stick_figure
from cubeling.characters.retargeting.bap import save_bap as save_bap
from cubeling.characters.retargeting.locomotion.grading import (
    YAW_RATE_PER_ANGULAR as YAW_RATE_PER_ANGULAR,
    GaitReport as GaitReport,
)
from cubeling.characters.retargeting.locomotion.locomotion_clips import (
    LocomotionResult as LocomotionResult,
    make_locomotion as make_locomotion,
)
from cubeling.characters.retargeting.recording import (
    Recording as Recording,
    load_recording as load_recording,
)
from cubeling.characters.retargeting.retarget import retarget as retarget
from cubeling.characters.retargeting.root import with_root_joint as with_root_joint
from cubeling.characters.retargeting.tpose_bones import TPoseBones as TPoseBones

from cubeling.characters.control.animator import Animator as Animator
from cubeling.characters.control.builtin_tree import built_in_trees as built_in_trees
from cubeling.characters.control.command import (
    ActionIntent as ActionIntent,
    CharacterCommand as CharacterCommand,
    ComingAct as ComingAct,
    LocomotionIntent as LocomotionIntent,
    PosedCharacter as PosedCharacter,
    SpeechIntent as SpeechIntent,
)
from cubeling.characters.control.controller_choices import (
    CONTROLLER_CHOICES as CONTROLLER_CHOICES,
    check_controller as check_controller,
    choose_controller as choose_controller,
)
from cubeling.characters.control.controllers import (
    ControllerFactory as ControllerFactory,
    first_suitable as first_suitable,
)
from cubeling.characters.control.controllers.actions import clips_of_actions as clips_of_actions
from cubeling.characters.control.controllers.idle import standing_as as standing_as
from cubeling.characters.control.controllers.in_place import InPlaceController as InPlaceController
from cubeling.characters.control.controllers.recordings import read_motions as read_motions
from cubeling.characters.control.layers import (
    DEFAULT_LAYERS as DEFAULT_LAYERS,
    layers_of as layers_of,
)
from cubeling.characters.control.layers.gestures.layer import (
    GestureLayer as GestureLayer,
    prepare_gestures as prepare_gestures,
)
from cubeling.characters.control.layers.layer import (
    FrameContext as FrameContext,
    LayerFactory as LayerFactory,
)
from cubeling.characters.control.layers.live_mouth import LiveMouthLayer as LiveMouthLayer
from cubeling.characters.control.layers.upper_body import (
    dependent_joints_of as dependent_joints_of,
    safe_ranges_of as safe_ranges_of,
)
from cubeling.characters.control.loading import load_to_play as load_to_play
from cubeling.characters.control.tagged_gestures import (
    GestureCalls as GestureCalls,
    known_gestures as known_gestures,
    meanings_of as meanings_of,
)
from cubeling.characters.errors import (
    CharacterError as CharacterError,
    CharacterWarning as CharacterWarning,
)
from cubeling.characters.formats.loading import load_motion as load_motion
from cubeling.characters.formats.mocap.bvh_writing import save_bvh as save_bvh
from cubeling.characters.locomotion.footfalls import Footfall as Footfall, Footfalls as Footfalls
from cubeling.characters.locomotion.gaits import IDLE_SPEED as IDLE_SPEED, RUN_SPEED as RUN_SPEED
from cubeling.characters.locomotion.obstacles import Obstacle as Obstacle, TableView as TableView
from cubeling.characters.locomotion.paths import ClosedPath as ClosedPath
from cubeling.characters.locomotion.places import past_circle as past_circle
from cubeling.characters.model.character import Character as Character
from cubeling.characters.model.colours import (
    colours_of as colours_of,
    with_colours as with_colours,
)
from cubeling.characters.model.mesh import Material as Material, Mesh as Mesh, Morph as Morph
from cubeling.characters.model.mirroring import mirror_of as mirror_of
from cubeling.characters.motion.blend import (
    Blend as Blend,
    BlendSpace1D as BlendSpace1D,
    BlendSpace2D as BlendSpace2D,
)
from cubeling.characters.motion.clip import Clip as Clip
from cubeling.characters.motion.crossfade import CrossFade as CrossFade
from cubeling.characters.motion.curves import (
    Adsr as Adsr,
    Curve as Curve,
    FadeCurve as FadeCurve,
    Keyed as Keyed,
    Product as Product,
)
from cubeling.characters.motion.layers import (
    AdditiveLayer as AdditiveLayer,
    MaskedLayer as MaskedLayer,
)
from cubeling.characters.motion.mirror import Mirror as Mirror, Mirrored as Mirrored
from cubeling.characters.motion.modifiers import (
    Loop as Loop,
    RootOffset as RootOffset,
    Stretch as Stretch,
    TimeCurve as TimeCurve,
    TimeWindow as TimeWindow,
    Warped as Warped,
)
from cubeling.characters.motion.motion import Motion as Motion, RootDelta as RootDelta
from cubeling.characters.motion.schedule import (
    Action as Action,
    LiveSchedule as LiveSchedule,
    Schedule as Schedule,
)
from cubeling.characters.motion.state_machine import StateMachine as StateMachine
from cubeling.characters.retargeting.lent_motions import with_lent_motions as with_lent_motions
from cubeling.characters.skeleton.masks import Mask as Mask, mask_of as mask_of
from cubeling.characters.skeleton.pose import Pose as Pose, Skeleton as Skeleton

from cubeling.characters.ik.reaching.effort import reach_effort as reach_effort
from cubeling.characters.ik.reaching.hand_shapes import HAND_SHAPES as HAND_SHAPES
from cubeling.characters.ik.reaching.hands import find_hand as find_hand
from cubeling.characters.ik.solvers.measures import (
    REACH_M as REACH_M,
    ReachingProblem as ReachingProblem,
    arc_targets as arc_targets,
    joint_change as joint_change,
    target_path as target_path,
    twist as twist,
    violations as violations,
    zig_zag as zig_zag,
)
from cubeling.characters.ik.solvers.single import SingleChain as SingleChain
from cubeling.characters.ik.solvers.solving import (
    SOLVERS as SOLVERS,
    TOLERANCE as TOLERANCE,
    solve as solve,
)
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M as ARRIVAL_DISTANCE_M
from cubeling.characters.motion.baking import bake as bake, stack as stack
from cubeling.characters.motion.motion import Motion as Motion
from cubeling.characters.motion.phase import with_phase as with_phase
from cubeling.characters.motion.schedule import Schedule as Schedule
from cubeling.characters.motion.schedule_file import ScheduleReader as ScheduleReader
from cubeling.characters.motion.trees.dot import to_dot as to_dot
from cubeling.characters.motion.trees.plan import (
    Node as Node,
    Plan as Plan,
    StateTransition as StateTransition,
)
from cubeling.characters.skeleton import rotations as rotations
from cubeling.characters.skeleton.pose import Array as Array, Skeleton as Skeleton
from cubeling.characters.smoothing import smoothstep as smoothstep
from cubeling.characters.synthesis.archive import skeleton_identity as skeleton_identity
from cubeling.characters.synthesis.capabilities import (
    capabilities as capabilities,
    falling as falling,
)
from cubeling.characters.synthesis.choices import (
    DEFAULT_PROFILE as DEFAULT_PROFILE,
    Alignment as Alignment,
)
from cubeling.characters.synthesis.distances import DISTANCES as DISTANCES
from cubeling.characters.synthesis.distances.distance import distance_matrix as distance_matrix
from cubeling.characters.synthesis.gestures.graph import (
    GestureGraph as GestureGraph,
    sweep as sweep,
)
from cubeling.characters.synthesis.gestures.learning import (
    find_gestures as find_gestures,
    learn_gestures as learn_gestures,
    library_of as library_of,
)
from cubeling.characters.synthesis.gestures.library import GestureLibrary as GestureLibrary
from cubeling.characters.synthesis.gestures.marks import (
    Agreement as Agreement,
    GestureMarks as GestureMarks,
    marks_of as marks_of,
)
from cubeling.characters.synthesis.gestures.marks_files import read_marks as read_marks
from cubeling.characters.synthesis.gestures.marks_writing import write_marks as write_marks
from cubeling.characters.synthesis.gestures.plan import (
    GesturePlan as GesturePlan,
    PlannedGesture as PlannedGesture,
)
from cubeling.characters.synthesis.gestures.planning import (
    GesturePlanner as GesturePlanner,
    GestureSettings as GestureSettings,
)
from cubeling.characters.synthesis.gestures.rules import (
    IntensityRule as IntensityRule,
    SynchronyRule as SynchronyRule,
)
from cubeling.characters.synthesis.graphs.building import (
    analyse as analyse,
    check_choices as check_choices,
    connectivity_curves as connectivity_curves,
    part_graphs as part_graphs,
    standard_graph as standard_graph,
)
from cubeling.characters.synthesis.graphs.graph import (
    PRINTED_COSTS as PRINTED_COSTS,
    EdgeCosts as EdgeCosts,
    MotionGraph as MotionGraph,
)
from cubeling.characters.synthesis.graphs.parts import PartGraphs as PartGraphs
from cubeling.characters.synthesis.graphs.storage import (
    WHOLE_BODY as WHOLE_BODY,
    StoredGraph as StoredGraph,
    load_graph as load_graph,
    save_graph as save_graph,
)
from cubeling.characters.synthesis.idle.database import (
    IdleDatabase as IdleDatabase,
    RestingPosture as RestingPosture,
)
from cubeling.characters.synthesis.idle.idle_motion import IdleMotion as IdleMotion
from cubeling.characters.synthesis.idle.motion_texture import StretchStream as StretchStream
from cubeling.characters.synthesis.idle.posture_space import (
    PostureSpace as PostureSpace,
    PostureVectors as PostureVectors,
)
from cubeling.characters.synthesis.idle.recordings import (
    BALANCES as BALANCES,
    StandingRecording as StandingRecording,
    borrow_shifts as borrow_shifts,
    find_rests as find_rests,
    read_parts as read_parts,
    read_standing as read_standing,
)
from cubeling.characters.synthesis.idle.storage import (
    Person as Person,
    load_person as load_person,
    save_person as save_person,
)
from cubeling.characters.synthesis.idle.variations import (
    COMPONENTS as COMPONENTS,
    VariationStream as VariationStream,
)
from cubeling.characters.synthesis.library import (
    DEFAULT_RATE_HZ as DEFAULT_RATE_HZ,
    MotionLibrary as MotionLibrary,
)
from cubeling.characters.synthesis.transitions.comparison import (
    Comparison as Comparison,
    SplitComparison as SplitComparison,
    common_requests as common_requests,
)
from cubeling.characters.synthesis.transitions.evaluation import (
    Answers as Answers,
    Requests as Requests,
    TransitionSummary as TransitionSummary,
    graph_requests as graph_requests,
    merge_answers as merge_answers,
    part_outcome as part_outcome,
)
from cubeling.characters.synthesis.transitions.playback import path_clip as path_clip
from cubeling.characters.synthesis.transitions.progressive import (
    PRINTED_SEARCH as PRINTED_SEARCH,
    SearchSettings as SearchSettings,
    TransitionPlanner as TransitionPlanner,
    whole_body_transition as whole_body_transition,
)
from cubeling.characters.synthesis.transitions.transition import (
    PartMove as PartMove,
    PartStreams as PartStreams,
    Transition as Transition,
)

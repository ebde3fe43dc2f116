from cubeling.app.session.acts import WizardAct as WizardAct, wizard_acts as wizard_acts
from cubeling.app.session.codecs import NO_VIDEO as NO_VIDEO, check_codec as check_codec
from cubeling.app.session.file_start import open_session_file as open_session_file
from cubeling.app.session.frames import (
    FrameEncoder as FrameEncoder,
    frame_encoder as frame_encoder,
)
from cubeling.app.session.info import SessionInfo as SessionInfo
from cubeling.app.session.labels import (
    Mark as Mark,
    SessionLabels as SessionLabels,
    check_participant as check_participant,
    with_mark as with_mark,
    write_labels as write_labels,
)
from cubeling.app.session.options import (
    START_STAGES as START_STAGES,
    SessionOptions as SessionOptions,
    check_stage as check_stage,
)
from cubeling.app.session.recorder import Recorder as Recorder
from cubeling.app.session.session_file import (
    INSIDE_EVENT as INSIDE_EVENT,
    START_OVER_EVENT as START_OVER_EVENT,
    SessionFile as SessionFile,
    messages as messages,
    session_info as session_info,
)

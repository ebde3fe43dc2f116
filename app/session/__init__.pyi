from cubeling.app.session.codecs import check_codec as check_codec
from cubeling.app.session.file_start import check_session_file as check_session_file
from cubeling.app.session.frames import (
    FrameEncoder as FrameEncoder,
    frame_encoder as frame_encoder,
)
from cubeling.app.session.inputs import (
    opening_times as opening_times,
    spoken_lines as spoken_lines,
    start_over_times as start_over_times,
)
from cubeling.app.session.options import (
    SessionOptions as SessionOptions,
    check_stage as check_stage,
)
from cubeling.app.session.reading import (
    INSIDE_EVENT as INSIDE_EVENT,
    START_OVER_EVENT as START_OVER_EVENT,
    SessionInfo as SessionInfo,
    events as events,
    has_channels as has_channels,
    messages as messages,
    session_info as session_info,
)
from cubeling.app.session.recorder import Recorder as Recorder

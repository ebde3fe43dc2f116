from cubeling.app.running.opening import open_session as open_session
from cubeling.app.running.runner import run as run

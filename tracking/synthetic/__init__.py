"""A camera that draws what it sees, so that the truth is known: `synthetic:NAME`."""

from tracking.synthetic.options import Options
from tracking.synthetic.scripts import SCRIPTS
from tracking.synthetic.source import SyntheticSource, open_synthetic

__all__ = ["SCRIPTS", "Options", "SyntheticSource", "open_synthetic"]

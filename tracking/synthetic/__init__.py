"""A rendered camera image of a cube whose true pose is known: `synthetic:NAME`."""

from tracking.synthetic.options import SyntheticOptions
from tracking.synthetic.scripts import SCRIPTS
from tracking.synthetic.source import SyntheticSource, open_synthetic

__all__ = ["SCRIPTS", "SyntheticOptions", "SyntheticSource", "open_synthetic"]

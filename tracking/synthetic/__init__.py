"""A rendered camera image of a cube whose true pose is known: `synthetic:NAME`."""

from cubeling.tracking.synthetic.options import SyntheticOptions
from cubeling.tracking.synthetic.scripts import SCRIPTS
from cubeling.tracking.synthetic.source import SyntheticSource, open_synthetic

__all__ = ["SCRIPTS", "SyntheticOptions", "SyntheticSource", "open_synthetic"]

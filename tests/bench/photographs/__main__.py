"""Start the benchmark: `python -m tests.bench.photographs`."""

import os

# Every library runs on one thread; it must be said before numpy is imported.
os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

from tests.bench.photographs.comparison import main

main()

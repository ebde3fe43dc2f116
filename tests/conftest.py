"""Lets numpy round in the tests as it does in the program: `app` must come before numpy."""

import app as app  # for what importing it sets

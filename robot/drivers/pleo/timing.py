"""Times and limits of the console; docs/pleo.md quotes them and a test compares.

The console was seen to take up to 60 s for an answer (OliverHoffmann/PleoCommand, 2010). The driver
does not wait that long: it ends the session, reports "lost", and searches for the console again.
"""

BAUD = 115200
"""Bits per second; 8N1, no flow control."""

ANSWER_TIMEOUT_S = 15.0
"""Time within which the console must be ready [s]."""

SHORT_TIMEOUT_S = 2.0
"""Time for the answer to a setting or a query [s]; then the console is nudged."""

LONG_TIMEOUT_S = 6.0
"""Time for the answer to a command that moves the body or reads the SD card [s]."""

PROMPT_SETTLE_S = 0.050
"""Silence after a prompt at the start of a line that ends the answer [s].

It is longer than the gap between USB or Bluetooth packets within one answer."""

STRAY_SETTLE_S = 0.5
"""The same for `> ` in the middle of a line, if an answer did not end its last line [s]."""

NUDGED_SETTLE_S = 0.3
"""The same after a nudge: two prompts may be on their way [s]."""

NUDGE_INTERVAL_S = 1.0
"""Interval of the nudges, empty lines, while an answer is overdue [s]."""

MAX_NUDGES = 3
"""Nudges without a prompt that end the session."""

SEARCH_INTERVAL_S = 2.0
"""Interval of the empty lines during the search for a console [s]."""

MAX_LOST_ANSWERS = 3
"""Lost answers in a row that end the session."""

PING_INTERVAL_S = 1.0
"""Interval at which an idle console is asked for a prompt [s]."""

DEGRADED_AFTER_S = 1.0
"""Time without a prompt after which the link is degraded [s]."""

MIN_RESTART_S = 2.0
"""Duration of an answer that may hide a restart [s]: APP UNLOAD is sent again.

An assumption; a faster restart is detected by its text, or by a refused motion."""

REFUSED_RETRY_DELAY_S = 2.0
"""Time after which a refused mood is tried again [s]."""

MAX_REFUSED_TRIES = 3
"""Most tries of a refused mood; a looping motion is tried at every round."""

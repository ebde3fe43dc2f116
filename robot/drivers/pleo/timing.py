"""The console's times and limits, each named once; docs/pleo.md quotes them and a test compares.

The console was seen to take up to 60 s for an answer (OliverHoffmann/PleoCommand, 2010). Nobody
waits so long here: the session is given up, the link says "lost", and the search goes on.
"""

BAUD = 115200
"""Bits a second, 8N1, no flow control."""

ANSWER_WITHIN = 15.0
"""A console that is not ready after this long is taken for none [s]."""

SHORT_WITHIN = 2.0
"""A command that only sets or tells something is answered within this [s], or is nudged for."""

LONG_WITHIN = 6.0
"""A command that moves the body or reads the SD card is answered within this [s]."""

PROMPT_SETTLES = 0.050
"""A prompt at the start of a line ends the answer when nothing follows it for this long [s].

Longer than the gap that a USB or Bluetooth packet leaves within one answer."""

STRAY_SETTLES = 0.5
"""The same for `> ` in the middle of a line, where an answer did not end its last line [s]."""

NUDGED_SETTLES = 0.3
"""The same after an empty line was sent into the silence: two prompts may be on their way [s]."""

NUDGE_EVERY = 1.0
"""An answer that is overdue is asked for with an empty line this often [s]."""

NUDGES_MAX = 3
"""After so many empty lines without a prompt the session is given up."""

SEEK_EVERY = 2.0
"""A console that is looked for gets an empty line this often [s]."""

UNSURE_MAX = 3
"""So many answers lost in a row end the session."""

PING_EVERY = 1.0
"""A console that is idle is asked for a prompt this often [s]."""

DEGRADED_AFTER = 1.0
"""A command without its prompt for this long makes the link degraded [s]."""

RESTART_TAKES = 2.0
"""An answer that took so long may hold a restart that nobody saw [s]: APP UNLOAD is sent again.

An assumption; a restart that is quicker is seen by its text, or when a motion is refused."""

REFUSED_AGAIN = 2.0
"""A mood that the console answered with an error text is tried again after this [s]."""

REFUSED_MAX = 3
"""Most tries of such a mood; a looping motion is tried at every round."""

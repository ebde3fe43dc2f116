"""The protocol's times and limits, each named once; PROTOCOL.md quotes them and a test compares."""

VERSION = 2
"""Highest version of the protocol that this code speaks."""

BEAT_EVERY = 0.050
"""The host says that it is there this often [s]."""

STATE_EVERY = 0.100
"""The robot reports its state at least this often in a session [s]; it also answers every BEAT."""

FAILSAFE_AFTER = 0.450
"""Silence of the host after which the robot goes to neutral [s].

The promise is 0.5 s; the rest is for a robot that looks at its clock only every 50 ms.
"""

FAILSAFE_PROMISE = 0.500
"""Longest time from the last frame heard to the neutral state [s]."""

DEGRADED_AFTER = 0.150
"""Silence of the robot, three beats, after which the host calls the link degraded [s]."""

LOST_AFTER = 0.500
"""Silence of the robot after which the host gives the session up and greets again [s]."""

HELLO_EVERY = 0.100
"""A greeting that is not answered is repeated this often [s]."""

RETRY_FIRST = 0.050
"""Time to wait for an acknowledgement before the round trip has been measured [s]."""

RETRY_MIN = 0.025
"""Shortest time before a command is sent again [s]; a few frames at 115200 baud."""

RETRY_MAX = 0.250
"""Longest time before a command is sent again [s]."""

TRIES_MAX = 20
"""A command not acknowledged after this many sends ends the session."""

DEGRADED_TRIES = 3
"""A command sent this often and not acknowledged makes the link degraded."""

GONE_EVERY = 0.020
"""A robot says that a session is gone at most this often [s], whatever it is sent."""

ACTIONS_MAX = 16
"""Motions and sounds that may wait to be sent; more are refused."""

ANSWER_WITHIN = 2.0
"""A robot that has not introduced itself after this long is taken for none [s]."""

BAUD = 115200
"""Bits a second on a real serial line, 8N1, no flow control."""

RULES: dict[str, str] = {
    "BEAT_EVERY": "the host sends BEAT",
    "STATE_EVERY": "the robot sends STATE of its own accord if it has not for this long",
    "FAILSAFE_AFTER": "silence of the host after which a robot should act",
    "FAILSAFE_PROMISE": "silence of the host after which a robot must have acted",
    "DEGRADED_AFTER": "silence of the robot: the link is degraded",
    "LOST_AFTER": "silence of the robot: the link is lost, and HELLO is sent again",
    "HELLO_EVERY": "between two HELLOs without an answer",
    "RETRY_FIRST": "before a repeat, while no round trip is known",
    "RETRY_MIN": "before a repeat, at least",
    "RETRY_MAX": "before a repeat, at most",
    "GONE_EVERY": "between two GONEs, at least",
}
"""The times that both ends keep, and what PROTOCOL.md says of each."""

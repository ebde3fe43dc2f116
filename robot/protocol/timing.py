"""Times and limits of the protocol; PROTOCOL.md quotes them and a test compares."""

VERSION = 3
"""Highest version of the protocol that this code speaks."""

BEAT_EVERY = 0.050
"""Interval of the host's BEAT [s]."""

STATE_EVERY = 0.100
"""Longest interval between two STATEs of a session [s]; the robot also answers every BEAT."""

FAILSAFE_AFTER = 0.450
"""Silence of the host after which the robot goes to neutral [s]: the promise, less 50 ms
for a robot that reads its clock only that often."""

FAILSAFE_PROMISE = 0.500
"""Longest time from the last received frame to the neutral state [s]."""

DEGRADED_AFTER = 0.150
"""Silence of the robot, three beats, after which the link is degraded [s]."""

LOST_AFTER = 0.500
"""Silence of the robot after which the host ends the session and sends HELLO again [s]."""

HELLO_EVERY = 0.100
"""Interval between two HELLOs without an answer [s]."""

RETRY_FIRST = 0.050
"""Retransmission timeout before the round trip has been measured [s]."""

RETRY_MIN = 0.025
"""Shortest retransmission timeout [s]; a few frames at 115200 baud."""

RETRY_MAX = 0.250
"""Longest retransmission timeout [s]."""

TRIES_MAX = 20
"""Sends of a command without an acknowledgement that end the session."""

DEGRADED_TRIES = 3
"""Sends of a command without an acknowledgement that make the link degraded."""

GONE_EVERY = 0.020
"""Shortest interval between two GONEs [s]."""

LOG_EVERY = 0.100
"""Shortest interval between two LOGs [s]: they take a twelfth of a line of 115200 baud at most."""

CLOCK_TOLERANCE = 500e-6
"""Largest relative error of the rate of the robot's clock; a crystal has a tenth of it."""

ACTIONS_MAX = 16
"""Motions, sounds and moves that may wait in the host; more are refused."""

ANSWER_WITHIN = 2.0
"""Time within which a robot must report its catalogue [s]."""

BAUD = 115200
"""Bits per second on a real serial line; 8N1, no flow control."""

RULE_DESCRIPTIONS: dict[str, str] = {
    "BEAT_EVERY": "the host sends BEAT; this is the mean, a single one may be some ms late",
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
    "LOG_EVERY": "between two LOGs, at least",
}
"""The times that both ends keep, with their descriptions in PROTOCOL.md."""

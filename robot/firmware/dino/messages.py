"""The protocol in numbers, generated from robot/protocol by tools.firmware_tables."""

# Do not edit: a test compares. Times are in ms.
# fmt: off
VERSION = 3
MAX_BODY = 120
MAX_FRAME = 124
STATE_EVERY = 100
FAILSAFE_AFTER = 450
GONE_EVERY = 20
LOG_EVERY = 100
NOTHING = 255
JOINTS_MAX = 16
ITEM_JOINT = 0
ITEM_MOTION = 1
ITEM_SOUND = 2
ITEM_MOOD = 3
RESULT_TAKEN = 0
RESULT_REFUSED = 1
RESULT_OUT_OF_RANGE = 2
RESULT_CANNOT = 3
RESULT_BUSY = 4
RESULT_NOT_NOW = 5
RESULT_MOTORS_OFF = 6
RESULT_LOW_BATTERY = 7
RESULT_TOO_HOT = 8
SEVERITY_INFO = 0
SEVERITY_WARNING = 1
SEVERITY_ERROR = 2
ABILITY_MOVE = 1
FLAG_CHARGING = 1
FLAG_STILL = 2
FLAG_LIMP = 4
FLAG_RECKONED = 8
HELLO = 0x01
ASK = 0x02
BEAT = 0x03
EXPRESS = 0x10
PLAY = 0x11
STOP = 0x12
MOVE = 0x13
BYE = 0x1F
WELCOME = 0x81
JOINT = 0x82
NAME = 0x83
STATE = 0x84
LOG = 0x85
ACK = 0x90
GONE = 0x9F

# number: (layout, bytes in version 1, (bytes, defaults) of the fields that each later
#          version added, (place, lowest, highest) of the fields with limits)
FROM_HOST: dict[
    int, tuple[str, int, tuple[tuple[int, bytes], ...], tuple[tuple[int, int, int], ...]]
] = {
    0x01: ("<BHBI", 8, (),
           ((2, 1, 255), (3, 1, 4294967295))),
    0x02: ("<BHBB", 5, (),
           ()),
    0x03: ("<BHH", 5, (),
           ()),
    0x10: ("<BHIhhB", 11, ((12, b'\xff'),),
           ((2, 1, 4294967295), (3, -10000, 10000), (4, -10000, 10000))),
    0x11: ("<BHIBB", 9, (),
           ((2, 1, 4294967295), (3, 1, 2))),
    0x12: ("<BHI", 7, (),
           ((2, 1, 4294967295),)),
    0x13: ("<BHIHHH16h", 45, (),
           ((2, 1, 4294967295),)),
    0x1F: ("<BH", 3, (),
           ()),
}

# number: (layout, (version, bytes) of each version that added fields)
FROM_ROBOT: dict[int, tuple[str, tuple[tuple[int, int], ...]]] = {
    0x81: ("<BHBIHBBBB16s16sB", ((1, 46), (3, 47))),
    0x82: ("<BHBhhH16s", ((1, 26),)),
    0x83: ("<BHBB16s", ((1, 21),)),
    0x84: ("<BHHIBhhHBBB16hIBH", ((1, 51), (3, 58))),
    0x85: ("<BHHIB80s", ((1, 90),)),
    0x90: ("<BHIB", ((1, 8),)),
    0x9F: ("<BH", ((1, 3),)),
}

ENTRIES_MAX = 254
NAME_BYTES = 16
LOG_BYTES = 80

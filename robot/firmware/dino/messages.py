"""The protocol in numbers, generated from robot/protocol by tools.firmware_tables."""

# Do not edit: a test compares. Times are in ms.
# fmt: off
VERSION = 2
MAX_BODY = 120
MAX_FRAME = 124
STATE_EVERY = 100
FAILSAFE_AFTER = 450
GONE_EVERY = 20
NOTHING = 255
JOINTS_MAX = 16
ITEM_JOINT = 0
ITEM_MOTION = 1
ITEM_SOUND = 2
ITEM_MOOD = 3
RESULT_TAKEN = 0
RESULT_REFUSED = 1
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
BYE = 0x1F
WELCOME = 0x81
JOINT = 0x82
NAME = 0x83
STATE = 0x84
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
    0x1F: ("<BH", 3, (),
           ()),
}

# number: (layout, (version, bytes) of each version that added fields)
FROM_ROBOT: dict[int, tuple[str, tuple[tuple[int, int], ...]]] = {
    0x81: ("<BHBIHBBBB16s16s", ((1, 46),)),
    0x82: ("<BHBhhH16s", ((1, 26),)),
    0x83: ("<BHBB16s", ((1, 21),)),
    0x84: ("<BHHIBhhHBBB16h", ((1, 51),)),
    0x90: ("<BHIB", ((1, 8),)),
    0x9F: ("<BH", ((1, 3),)),
}

ENTRIES_MAX = 254
NAME_BYTES = 16

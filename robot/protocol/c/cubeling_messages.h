/* Messages of the protocol "cubeling" in C99; see robot/PROTOCOL.md.
 *
 * Drawn from robot/protocol/messages.py by `python -m tools.protocol_reference`: change it there.
 *
 * Values stand in the structs as on the wire: whole numbers, in the unit that the comment names.
 * cubeling_pack_NAME writes a body into CUBELING_MAX_BODY bytes, as `version` has it, and returns
 * its size. cubeling_unpack_NAME returns 1, or 0 for a body that is to be skipped: of another
 * message, too short, or with a value out of its range. Fields that the sender's version does not
 * have get their defaults; bytes of a later version are skipped. A text has a zero byte behind it;
 * whether it is UTF-8 is not looked at.
 */
#ifndef CUBELING_MESSAGES_H
#define CUBELING_MESSAGES_H

#include <string.h>

#include "cubeling_frames.h"

#define CUBELING_VERSION 2
#define CUBELING_HEADER 3
#define CUBELING_JOINTS_MAX 16
#define CUBELING_NOTHING 255
#define CUBELING_BEAT_EVERY_MS 50
#define CUBELING_STATE_EVERY_MS 100
#define CUBELING_FAILSAFE_AFTER_MS 450
#define CUBELING_FAILSAFE_PROMISE_MS 500
#define CUBELING_DEGRADED_AFTER_MS 150
#define CUBELING_LOST_AFTER_MS 500
#define CUBELING_HELLO_EVERY_MS 100
#define CUBELING_RETRY_FIRST_MS 50
#define CUBELING_RETRY_MIN_MS 25
#define CUBELING_RETRY_MAX_MS 250
#define CUBELING_GONE_EVERY_MS 20
#define CUBELING_HELLO 0x01
#define CUBELING_ASK 0x02
#define CUBELING_BEAT 0x03
#define CUBELING_EXPRESS 0x10
#define CUBELING_PLAY 0x11
#define CUBELING_STOP 0x12
#define CUBELING_BYE 0x1F
#define CUBELING_WELCOME 0x81
#define CUBELING_JOINT 0x82
#define CUBELING_NAME 0x83
#define CUBELING_STATE 0x84
#define CUBELING_ACK 0x90
#define CUBELING_GONE 0x9F

static inline void cubeling_put16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)(value & 0xFFu);
    at[1] = (uint8_t)(value >> 8);
}

static inline void cubeling_put32(uint8_t *at, uint32_t value)
{
    cubeling_put16(at, (uint16_t)(value & 0xFFFFu));
    cubeling_put16(at + 2, (uint16_t)(value >> 16));
}

static inline uint16_t cubeling_get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | ((uint16_t)at[1] << 8));
}

static inline uint32_t cubeling_get32(const uint8_t *at)
{
    return cubeling_get16(at) | ((uint32_t)cubeling_get16(at + 2) << 16);
}

static inline int16_t cubeling_get16s(const uint8_t *at)
{
    uint16_t bits = cubeling_get16(at);
    return (int16_t)(bits < 0x8000u ? (int32_t)bits : (int32_t)bits - 0x10000);
}

/* The number and the session of a body of at least CUBELING_HEADER bytes. */
static inline uint8_t cubeling_number(const uint8_t *body) { return body[0]; }
static inline uint16_t cubeling_session(const uint8_t *body) { return cubeling_get16(body + 1); }

/* HELLO, from the host. Opens the session named in the header, or asks for its WELCOME again. */
typedef struct {
    uint8_t version; /* highest version that the host speaks */
    uint32_t host; /* who speaks: one number for the life of a host program */
} cubeling_hello;

static inline size_t cubeling_pack_hello(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_hello *from)
{
    body[0] = CUBELING_HELLO;
    cubeling_put16(body + 1, session);
    (void)version;
    body[3] = from->version;
    cubeling_put32(body + 4, from->host);
    return 8;
}

static inline int cubeling_unpack_hello(const uint8_t *body, size_t size, cubeling_hello *to)
{
    if (size < 8 || body[0] != CUBELING_HELLO)
        return 0;
    to->version = body[3];
    if (to->version < 1)
        return 0;
    to->host = cubeling_get32(body + 4);
    if (to->host < 1)
        return 0;
    return 1;
}

/* ASK, from the host. Asks for one entry of the robot's catalogue. */
typedef struct {
    uint8_t item; /* 0 joint, 1 motion, 2 sound, 3 mood */
    uint8_t index; /* which one, from 0 */
} cubeling_ask;

static inline size_t cubeling_pack_ask(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_ask *from)
{
    body[0] = CUBELING_ASK;
    cubeling_put16(body + 1, session);
    (void)version;
    body[3] = from->item;
    body[4] = from->index;
    return 5;
}

static inline int cubeling_unpack_ask(const uint8_t *body, size_t size, cubeling_ask *to)
{
    if (size < 5 || body[0] != CUBELING_ASK)
        return 0;
    to->item = body[3];
    to->index = body[4];
    return 1;
}

/* BEAT, from the host. The host is there. Answered by STATE at once. */
typedef struct {
    uint16_t count; /* counts up by one, and starts again at 0 after 65535 */
} cubeling_beat;

static inline size_t cubeling_pack_beat(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_beat *from)
{
    body[0] = CUBELING_BEAT;
    cubeling_put16(body + 1, session);
    (void)version;
    cubeling_put16(body + 3, (uint16_t)from->count);
    return 5;
}

static inline int cubeling_unpack_beat(const uint8_t *body, size_t size, cubeling_beat *to)
{
    if (size < 5 || body[0] != CUBELING_BEAT)
        return 0;
    to->count = cubeling_get16(body + 3);
    return 1;
}

/* EXPRESS, from the host. A command: feel this from now on. */
typedef struct {
    uint32_t number; /* number of the command */
    int16_t valence; /* unpleasant to pleasant [1/10000] */
    int16_t arousal; /* calm to excited [1/10000] */
    uint8_t mood; /* mood to show, an index; 255: the robot chooses by valence and arousal, since version 2 */
} cubeling_express;

static inline size_t cubeling_pack_express(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_express *from)
{
    body[0] = CUBELING_EXPRESS;
    cubeling_put16(body + 1, session);
    cubeling_put32(body + 3, from->number);
    cubeling_put16(body + 7, (uint16_t)from->valence);
    cubeling_put16(body + 9, (uint16_t)from->arousal);
    if (version < 2)
        return 11;
    body[11] = from->mood;
    return 12;
}

static inline int cubeling_unpack_express(const uint8_t *body, size_t size, cubeling_express *to)
{
    if (size < 11 || body[0] != CUBELING_EXPRESS)
        return 0;
    to->number = cubeling_get32(body + 3);
    if (to->number < 1)
        return 0;
    to->valence = cubeling_get16s(body + 7);
    if (to->valence < -10000 || to->valence > 10000)
        return 0;
    to->arousal = cubeling_get16s(body + 9);
    if (to->arousal < -10000 || to->arousal > 10000)
        return 0;
    if (size >= 12) {
        to->mood = body[11];
    } else {
        to->mood = 255;
    }
    return 1;
}

/* PLAY, from the host. A command: play a motion or a sound once. */
typedef struct {
    uint32_t number; /* number of the command */
    uint8_t item; /* 1 motion, 2 sound */
    uint8_t index; /* which one, from 0 */
} cubeling_play;

static inline size_t cubeling_pack_play(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_play *from)
{
    body[0] = CUBELING_PLAY;
    cubeling_put16(body + 1, session);
    (void)version;
    cubeling_put32(body + 3, from->number);
    body[7] = from->item;
    body[8] = from->index;
    return 9;
}

static inline int cubeling_unpack_play(const uint8_t *body, size_t size, cubeling_play *to)
{
    if (size < 9 || body[0] != CUBELING_PLAY)
        return 0;
    to->number = cubeling_get32(body + 3);
    if (to->number < 1)
        return 0;
    to->item = body[7];
    if (to->item < 1 || to->item > 2)
        return 0;
    to->index = body[8];
    return 1;
}

/* STOP, from the host. A command: end motion and sound, feel neutral, and hold the neutral pose. */
typedef struct {
    uint32_t number; /* number of the command */
} cubeling_stop;

static inline size_t cubeling_pack_stop(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_stop *from)
{
    body[0] = CUBELING_STOP;
    cubeling_put16(body + 1, session);
    (void)version;
    cubeling_put32(body + 3, from->number);
    return 7;
}

static inline int cubeling_unpack_stop(const uint8_t *body, size_t size, cubeling_stop *to)
{
    if (size < 7 || body[0] != CUBELING_STOP)
        return 0;
    to->number = cubeling_get32(body + 3);
    if (to->number < 1)
        return 0;
    return 1;
}

/* BYE, from the host. Ends the session. The robot goes to neutral at once; no answer. */
static inline size_t cubeling_pack_bye(
    uint8_t *body, uint16_t session, uint8_t version)
{
    body[0] = CUBELING_BYE;
    cubeling_put16(body + 1, session);
    (void)version;
    return 3;
}

static inline int cubeling_unpack_bye(const uint8_t *body, size_t size)
{
    if (size < 3 || body[0] != CUBELING_BYE)
        return 0;
    return 1;
}

/* WELCOME, from the robot. Answers HELLO: the session is open. */
typedef struct {
    uint8_t version; /* version to be spoken, at most the host's */
    uint32_t taken; /* last command of this host that is still in force; 0 if none is */
    uint16_t catalogue; /* any number that changes when the catalogue does */
    uint8_t joints; /* joints in the catalogue */
    uint8_t motions; /* motions in the catalogue */
    uint8_t sounds; /* sounds in the catalogue */
    uint8_t moods; /* moods in the catalogue */
    char name[17]; /* what the robot is called */
    char firmware[17]; /* what runs on it, and which version */
} cubeling_welcome;

static inline size_t cubeling_pack_welcome(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_welcome *from)
{
    body[0] = CUBELING_WELCOME;
    cubeling_put16(body + 1, session);
    (void)version;
    body[3] = from->version;
    cubeling_put32(body + 4, from->taken);
    cubeling_put16(body + 8, (uint16_t)from->catalogue);
    body[10] = from->joints;
    body[11] = from->motions;
    body[12] = from->sounds;
    body[13] = from->moods;
    strncpy((char *)body + 14, from->name, 16);
    strncpy((char *)body + 30, from->firmware, 16);
    return 46;
}

static inline int cubeling_unpack_welcome(const uint8_t *body, size_t size, cubeling_welcome *to)
{
    if (size < 46 || body[0] != CUBELING_WELCOME)
        return 0;
    to->version = body[3];
    if (to->version < 1)
        return 0;
    to->taken = cubeling_get32(body + 4);
    to->catalogue = cubeling_get16(body + 8);
    to->joints = body[10];
    if (to->joints > 16)
        return 0;
    to->motions = body[11];
    if (to->motions > 254)
        return 0;
    to->sounds = body[12];
    if (to->sounds > 254)
        return 0;
    to->moods = body[13];
    if (to->moods > 254)
        return 0;
    memcpy(to->name, body + 14, 16);
    to->name[16] = 0;
    memcpy(to->firmware, body + 30, 16);
    to->firmware[16] = 0;
    return 1;
}

/* JOINT, from the robot. Answers ASK for a joint. */
typedef struct {
    uint8_t index; /* which one, from 0 */
    int16_t low; /* smallest angle [mrad] */
    int16_t high; /* largest angle [mrad] */
    uint16_t speed; /* top speed [mrad/s] */
    char name[17]; /* what it is called */
} cubeling_joint;

static inline size_t cubeling_pack_joint(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_joint *from)
{
    body[0] = CUBELING_JOINT;
    cubeling_put16(body + 1, session);
    (void)version;
    body[3] = from->index;
    cubeling_put16(body + 4, (uint16_t)from->low);
    cubeling_put16(body + 6, (uint16_t)from->high);
    cubeling_put16(body + 8, (uint16_t)from->speed);
    strncpy((char *)body + 10, from->name, 16);
    return 26;
}

static inline int cubeling_unpack_joint(const uint8_t *body, size_t size, cubeling_joint *to)
{
    if (size < 26 || body[0] != CUBELING_JOINT)
        return 0;
    to->index = body[3];
    to->low = cubeling_get16s(body + 4);
    to->high = cubeling_get16s(body + 6);
    to->speed = cubeling_get16(body + 8);
    memcpy(to->name, body + 10, 16);
    to->name[16] = 0;
    return 1;
}

/* NAME, from the robot. Answers ASK for a motion, a sound or a mood. */
typedef struct {
    uint8_t item; /* 1 motion, 2 sound, 3 mood */
    uint8_t index; /* which one, from 0 */
    char name[17]; /* what it is called */
} cubeling_name;

static inline size_t cubeling_pack_name(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_name *from)
{
    body[0] = CUBELING_NAME;
    cubeling_put16(body + 1, session);
    (void)version;
    body[3] = from->item;
    body[4] = from->index;
    strncpy((char *)body + 5, from->name, 16);
    return 21;
}

static inline int cubeling_unpack_name(const uint8_t *body, size_t size, cubeling_name *to)
{
    if (size < 21 || body[0] != CUBELING_NAME)
        return 0;
    to->item = body[3];
    if (to->item < 1 || to->item > 3)
        return 0;
    to->index = body[4];
    memcpy(to->name, body + 5, 16);
    to->name[16] = 0;
    return 1;
}

/* STATE, from the robot. The robot is there, and this is how it is. */
typedef struct {
    uint16_t beat; /* count of the last BEAT heard; 0 before the first */
    uint32_t taken; /* number of the last command taken; 0 before the first */
    uint8_t flags; /* bit 0: charging; bit 1: stopped; bit 2: motors without power; bit 3: joints are reckoned from what was commanded, not measured; others 0 */
    int16_t valence; /* shown now, unpleasant to pleasant [1/10000] */
    int16_t arousal; /* shown now, calm to excited [1/10000] */
    uint16_t battery; /* empty to full [1/10000] */
    uint8_t mood; /* mood shown now, an index */
    uint8_t motion; /* motion played now, an index; 255 none */
    uint8_t sound; /* sound played now, an index; 255 none */
    int16_t joints[16]; /* angles, in catalogue order; 0 for those it does not have [mrad] */
} cubeling_state;

static inline size_t cubeling_pack_state(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_state *from)
{
    body[0] = CUBELING_STATE;
    cubeling_put16(body + 1, session);
    (void)version;
    cubeling_put16(body + 3, (uint16_t)from->beat);
    cubeling_put32(body + 5, from->taken);
    body[9] = from->flags;
    cubeling_put16(body + 10, (uint16_t)from->valence);
    cubeling_put16(body + 12, (uint16_t)from->arousal);
    cubeling_put16(body + 14, (uint16_t)from->battery);
    body[16] = from->mood;
    body[17] = from->motion;
    body[18] = from->sound;
    for (size_t i = 0; i < 16; i++)
        cubeling_put16(body + 19 + 2 * i, (uint16_t)from->joints[i]);
    return 51;
}

static inline int cubeling_unpack_state(const uint8_t *body, size_t size, cubeling_state *to)
{
    if (size < 51 || body[0] != CUBELING_STATE)
        return 0;
    to->beat = cubeling_get16(body + 3);
    to->taken = cubeling_get32(body + 5);
    to->flags = body[9];
    to->valence = cubeling_get16s(body + 10);
    if (to->valence < -10000 || to->valence > 10000)
        return 0;
    to->arousal = cubeling_get16s(body + 12);
    if (to->arousal < -10000 || to->arousal > 10000)
        return 0;
    to->battery = cubeling_get16(body + 14);
    if (to->battery > 10000)
        return 0;
    to->mood = body[16];
    to->motion = body[17];
    to->sound = body[18];
    for (size_t i = 0; i < 16; i++)
        to->joints[i] = cubeling_get16s(body + 19 + 2 * i);
    return 1;
}

/* ACK, from the robot. Answers every command, also one that it has taken before. */
typedef struct {
    uint32_t number; /* the command's number */
    uint8_t result; /* 0 taken; 1 refused, there is no such index */
} cubeling_ack;

static inline size_t cubeling_pack_ack(
    uint8_t *body, uint16_t session, uint8_t version, const cubeling_ack *from)
{
    body[0] = CUBELING_ACK;
    cubeling_put16(body + 1, session);
    (void)version;
    cubeling_put32(body + 3, from->number);
    body[7] = from->result;
    return 8;
}

static inline int cubeling_unpack_ack(const uint8_t *body, size_t size, cubeling_ack *to)
{
    if (size < 8 || body[0] != CUBELING_ACK)
        return 0;
    to->number = cubeling_get32(body + 3);
    if (to->number < 1)
        return 0;
    to->result = body[7];
    return 1;
}

/* GONE, from the robot. The session in the header is not open here: greet again. */
static inline size_t cubeling_pack_gone(
    uint8_t *body, uint16_t session, uint8_t version)
{
    body[0] = CUBELING_GONE;
    cubeling_put16(body + 1, session);
    (void)version;
    return 3;
}

static inline int cubeling_unpack_gone(const uint8_t *body, size_t size)
{
    if (size < 3 || body[0] != CUBELING_GONE)
        return 0;
    return 1;
}

#endif

/* The robot that PROTOCOL.md describes; the sections named here are that document's. */
#include "robot.h"

#include <math.h>
#include <stdio.h>

#define COUNT(list) (sizeof(list) / sizeof(list)[0])

#define FEELING_SPEED 0.8f /* of valence and arousal each [1/s]: a corner is 2.5 s from another */
#define MOOD_FROM 0.3f     /* valence from which on it looks happy, or sad */
#define SERVO_SHARE 0.9f   /* of a joint's top speed that is used: its clock may be a little fast */
#define LONGEST_STEP 50u   /* what is left of a longer pause: no joint may jump [ms] */

/* --- What it has --------------------------------------------------------------------------- */

static const struct {
    cubeling_joint entry;                /* index, low, high [mrad], speed [mrad/s], name */
    float neutral;                       /* [mrad] */
    float by_valence, by_arousal, swing; /* how far feelings and motions turn it [mrad] */
} JOINTS[ROBOT_JOINTS] = {
    {{0, -800, 800, 1500, "neck"}, 0, 0, 300, 500},
    {{1, -500, 1200, 2500, "tail"}, 200, 500, 0, 700},
    {{2, 0, 900, 3000, "ears"}, 300, 0, 250, 500},
};

typedef struct {
    const char *name;
    uint32_t length; /* [ms] */
} entry;

static const entry MOTIONS[ROBOT_JOINTS] = {{"nod", 900}, {"wag", 1500}, {"prick up", 1200}};
static const entry SOUNDS[] = {{"chirp", 600}, {"purr", 2000}};

enum { NEUTRAL, HAPPY, SAD };
static const char *const MOODS[] = {"neutral", "happy", "sad"};

/* --- How it lives (section 7) --------------------------------------------------------------- */

static void go_neutral(robot *self)
{
    self->target[0] = self->target[1] = 0.0f;
    if (self->mood != CUBELING_NOTHING)
        self->mood = NEUTRAL;
    self->motion.index = self->sound.index = CUBELING_NOTHING;
    self->held = 0;
}

static float towards(float from, float to, float step)
{
    return from + fminf(fmaxf(to - from, -step), step);
}

static void end_if_over(robot_playing *playing, const entry *list, uint32_t now)
{
    if (playing->index != CUBELING_NOTHING && now - playing->since >= list[playing->index].length)
        playing->index = CUBELING_NOTHING;
}

static float wanted_angle(const robot *self, size_t joint)
{
    float angle = JOINTS[joint].neutral;
    if (self->held >> joint & 1) {
        const robot_way *way = &self->ways[joint];
        uint32_t passed = self->now - way->since;
        float part = passed < way->duration ? (float)passed / way->duration : 1.0f;
        angle = way->from + part * (way->to - way->from);
    } else if (!self->still) {
        angle += JOINTS[joint].by_valence * self->feeling[0];
        angle += JOINTS[joint].by_arousal * self->feeling[1];
        if (self->motion.index == joint) /* each motion swings the joint of its number */
            angle += JOINTS[joint].swing * sinf((float)(self->now - self->motion.since) / 90.0f);
    }
    return fminf(fmaxf(angle, JOINTS[joint].entry.low), JOINTS[joint].entry.high);
}

static void live(robot *self, uint32_t now)
{
    uint32_t passed = now - self->now;
    float seconds = (float)(passed < LONGEST_STEP ? passed : LONGEST_STEP) / 1000.0f;
    self->now = now;
    end_if_over(&self->motion, MOTIONS, now);
    end_if_over(&self->sound, SOUNDS, now);
    for (size_t axis = 0; axis < 2; axis++)
        self->feeling[axis] =
            towards(self->feeling[axis], self->target[axis], FEELING_SPEED * seconds);
    for (size_t joint = 0; joint < ROBOT_JOINTS; joint++)
        self->angles[joint] = towards(self->angles[joint], wanted_angle(self, joint),
                                      SERVO_SHARE * JOINTS[joint].entry.speed * seconds);
}

static uint8_t mood_shown(const robot *self)
{
    if (self->mood != CUBELING_NOTHING)
        return self->mood;
    if (fabsf(self->feeling[0]) < MOOD_FROM)
        return NEUTRAL;
    return self->feeling[0] > 0.0f ? HAPPY : SAD;
}

/* --- What it says --------------------------------------------------------------------------- */

static void send(robot *self, const uint8_t *body, size_t size)
{
    uint8_t wire[CUBELING_MAX_WIRE];
    self->write(wire, cubeling_encode(body, size, wire));
}

static void send_state(robot *self)
{
    uint8_t body[CUBELING_MAX_BODY];
    cubeling_state state = {
        .beat = self->beat,
        .taken = self->taken,
        /* Bit 3, which version 2 added: these angles are reckoned. */
        .flags = (uint8_t)((self->still ? 2 : 0) | (self->version >= 2 ? 8 : 0)),
        .valence = (int16_t)lroundf(self->feeling[0] * 10000.0f),
        .arousal = (int16_t)lroundf(self->feeling[1] * 10000.0f),
        .battery = 9000,
        .mood = mood_shown(self),
        .motion = self->motion.index,
        .sound = self->sound.index,
        .time = self->now,
        .result = self->result,
        .held = self->held,
    };
    for (size_t joint = 0; joint < ROBOT_JOINTS; joint++)
        state.joints[joint] = (int16_t)lroundf(self->angles[joint]);
    self->stated = self->now;
    send(self, body, cubeling_pack_state(body, self->session, self->version, &state));
}

static void send_welcome(robot *self)
{
    uint8_t body[CUBELING_MAX_BODY];
    cubeling_welcome welcome = {
        .version = self->version,
        .taken = self->in_force ? self->taken : 0,
        .catalogue = 1, /* to be raised with every change of the tables above */
        .joints = ROBOT_JOINTS,
        .motions = COUNT(MOTIONS),
        .sounds = COUNT(SOUNDS),
        .moods = COUNT(MOODS),
        .name = "Stranger",
        .firmware = "c robot 1",
        .abilities = CUBELING_ABILITY_MOVE,
    };
    send(self, body, cubeling_pack_welcome(body, self->session, self->version, &welcome));
}

static void send_gone(robot *self, uint16_t session)
{
    uint8_t body[CUBELING_MAX_BODY];
    if (self->now - self->refused < CUBELING_GONE_EVERY_MS)
        return;
    self->refused = self->now;
    send(self, body, cubeling_pack_gone(body, session, self->version));
}

/* Keep one line for the owner; when another waits already, it is only counted. */
static void log_refusal(robot *self, const char *command, uint32_t number)
{
    self->lines++;
    if (self->line.text[0] != 0)
        return;
    self->line.count = self->lines;
    self->line.time = self->now;
    self->line.severity = CUBELING_SEVERITY_WARNING;
    snprintf(self->line.text, sizeof self->line.text, "%s %lu refused: result %u", command,
             (unsigned long)number, self->result);
}

static void send_log(robot *self)
{
    uint8_t body[CUBELING_MAX_BODY];
    send(self, body, cubeling_pack_log(body, self->session, self->version, &self->line));
    self->line.text[0] = 0;
    self->logged = self->now;
}

static const char *name_of(uint8_t item, uint8_t index)
{
    if (item == 1 && index < COUNT(MOTIONS))
        return MOTIONS[index].name;
    if (item == 2 && index < COUNT(SOUNDS))
        return SOUNDS[index].name;
    if (item == 3 && index < COUNT(MOODS))
        return MOODS[index];
    return NULL;
}

/* Answer ASK; nothing for an entry that there is not. */
static void describe(robot *self, const cubeling_ask *ask)
{
    uint8_t body[CUBELING_MAX_BODY];
    const char *name = name_of(ask->item, ask->index);
    if (name != NULL) {
        cubeling_name answer = {.item = ask->item, .index = ask->index};
        strcpy(answer.name, name);
        send(self, body, cubeling_pack_name(body, self->session, self->version, &answer));
    } else if (ask->item == 0 && ask->index < ROBOT_JOINTS) {
        const cubeling_joint *answer = &JOINTS[ask->index].entry;
        send(self, body, cubeling_pack_joint(body, self->session, self->version, answer));
    }
}

/* --- Commands (section 6) ------------------------------------------------------------------- */

/* A refused one changes nothing, but its number is used up. */
enum {
    TAKEN = CUBELING_RESULT_TAKEN,
    REFUSED = CUBELING_RESULT_REFUSED,
    OUT_OF_RANGE = CUBELING_RESULT_OUT_OF_RANGE
};

static uint8_t express(robot *self, const cubeling_express *command)
{
    if (command->mood != CUBELING_NOTHING && command->mood >= COUNT(MOODS))
        return REFUSED;
    self->target[0] = (float)command->valence / 10000.0f;
    self->target[1] = (float)command->arousal / 10000.0f;
    self->mood = command->mood;
    self->still = 0;
    return TAKEN;
}

static uint8_t play(robot *self, const cubeling_play *command)
{
    robot_playing *playing = command->item == 1 ? &self->motion : &self->sound;
    if (name_of(command->item, command->index) == NULL)
        return REFUSED;
    playing->index = command->index;
    playing->since = self->now;
    self->still = 0;
    return TAKEN;
}

static uint8_t stop(robot *self)
{
    go_neutral(self);
    self->still = 1;
    return TAKEN;
}

static uint8_t move(robot *self, const cubeling_move *command)
{
    if ((command->released | command->moved) >> ROBOT_JOINTS)
        return REFUSED;
    for (size_t joint = 0; joint < ROBOT_JOINTS; joint++)
        if (command->moved >> joint & 1 && (command->angles[joint] < JOINTS[joint].entry.low ||
                                            command->angles[joint] > JOINTS[joint].entry.high))
            return OUT_OF_RANGE;
    self->held = (uint16_t)((self->held & ~command->released) | command->moved);
    for (size_t joint = 0; joint < ROBOT_JOINTS; joint++)
        if (command->moved >> joint & 1)
            self->ways[joint] = (robot_way){.from = self->angles[joint],
                                            .to = command->angles[joint],
                                            .since = self->now,
                                            .duration = command->duration};
    self->still = 0;
    return TAKEN;
}

/* Whether a command has not come before: then, and only then, it is to be carried out. */
static int is_new(robot *self, uint32_t number)
{
    if (number <= self->taken)
        return 0;
    self->taken = number;
    self->in_force = 1;
    return 1;
}

static void settle(robot *self, const char *command, uint32_t number, uint8_t result)
{
    self->result = result;
    if (result != TAKEN)
        log_refusal(self, command, number);
}

static void acknowledge(robot *self, uint32_t number)
{
    uint8_t body[CUBELING_MAX_BODY];
    cubeling_ack ack = {.number = number, .result = self->result};
    if (self->version < 3 && self->result != TAKEN)
        ack.result = REFUSED; /* there are no other reasons */
    send(self, body, cubeling_pack_ack(body, self->session, self->version, &ack));
}

/* --- Sessions (section 5) ------------------------------------------------------------------- */

static void end_session(robot *self)
{
    self->session = 0;
    self->in_force = 0;
    go_neutral(self);
}

static void greet(robot *self, uint16_t session, const cubeling_hello *hello)
{
    if (hello->host != self->host) {
        go_neutral(self);
        self->host = hello->host;
        self->taken = 0;
        self->result = TAKEN;
        self->in_force = 0;
    }
    if (session != self->session) {
        self->session = session;
        self->beat = 0;
        self->stated = self->now;
    }
    self->heard = self->now;
    self->version = hello->version < CUBELING_VERSION ? hello->version : CUBELING_VERSION;
    send_welcome(self);
}

/* Whether a message is of the open session. If it is, the host is there; if not, it is told. */
static int is_ours(robot *self, uint16_t session)
{
    if (self->session == 0 || session != self->session) {
        send_gone(self, session);
        return 0;
    }
    self->heard = self->now;
    return 1;
}

/* What is not unpacked is skipped: cut short, out of its range, unknown, or a robot's. */
static void take_message(robot *self, const uint8_t *body, size_t size)
{
    uint16_t session = cubeling_session(body);
    union {
        cubeling_hello hello;
        cubeling_ask ask;
        cubeling_beat beat;
        cubeling_express express;
        cubeling_play play;
        cubeling_stop stop;
        cubeling_move move;
    } m;
    switch (cubeling_number(body)) {
    case CUBELING_HELLO:
        if (cubeling_unpack_hello(body, size, &m.hello) && session != 0)
            greet(self, session, &m.hello);
        break;
    case CUBELING_ASK:
        if (cubeling_unpack_ask(body, size, &m.ask) && is_ours(self, session))
            describe(self, &m.ask);
        break;
    case CUBELING_BEAT:
        if (cubeling_unpack_beat(body, size, &m.beat) && is_ours(self, session)) {
            self->beat = m.beat.count;
            send_state(self);
        }
        break;
    case CUBELING_EXPRESS:
        if (cubeling_unpack_express(body, size, &m.express) && is_ours(self, session)) {
            if (is_new(self, m.express.number))
                settle(self, "EXPRESS", m.express.number, express(self, &m.express));
            acknowledge(self, m.express.number);
        }
        break;
    case CUBELING_PLAY:
        if (cubeling_unpack_play(body, size, &m.play) && is_ours(self, session)) {
            if (is_new(self, m.play.number))
                settle(self, "PLAY", m.play.number, play(self, &m.play));
            acknowledge(self, m.play.number);
        }
        break;
    case CUBELING_STOP:
        if (cubeling_unpack_stop(body, size, &m.stop) && is_ours(self, session)) {
            if (is_new(self, m.stop.number))
                self->result = stop(self);
            acknowledge(self, m.stop.number);
        }
        break;
    case CUBELING_MOVE:
        if (cubeling_unpack_move(body, size, &m.move) && is_ours(self, session)) {
            if (is_new(self, m.move.number))
                settle(self, "MOVE", m.move.number, move(self, &m.move));
            acknowledge(self, m.move.number);
        }
        break;
    case CUBELING_BYE:
        if (cubeling_unpack_bye(body, size) && is_ours(self, session))
            end_session(self);
        break;
    }
}

/* --- To be called --------------------------------------------------------------------------- */

void robot_start(robot *self, void (*write)(const uint8_t *, size_t), uint32_t now)
{
    memset(self, 0, sizeof *self);
    self->write = write;
    self->now = now;
    self->version = CUBELING_VERSION;
    self->refused = now - CUBELING_GONE_EVERY_MS;
    self->logged = now - CUBELING_LOG_EVERY_MS;
    self->mood = self->motion.index = self->sound.index = CUBELING_NOTHING;
    for (size_t joint = 0; joint < ROBOT_JOINTS; joint++)
        self->angles[joint] = JOINTS[joint].neutral;
}

void robot_advance(robot *self, uint32_t now)
{
    live(self, now);
    if (self->session != 0 && now - self->heard >= CUBELING_FAILSAFE_AFTER_MS)
        end_session(self);
    if (self->session != 0 && now - self->stated >= CUBELING_STATE_EVERY_MS)
        send_state(self);
    if (self->session != 0 && self->version >= 3 && self->line.text[0] != 0 &&
        now - self->logged >= CUBELING_LOG_EVERY_MS)
        send_log(self);
}

void robot_receive(robot *self, const uint8_t *bytes, size_t size, uint32_t now)
{
    robot_advance(self, now); /* first the clock: bytes that waited may be too late (section 5) */
    for (size_t at = 0; at < size; at++) {
        size_t length = cubeling_read(&self->reader, bytes[at]);
        if (length >= CUBELING_HEADER)
            take_message(self, self->reader.bytes, length);
    }
}

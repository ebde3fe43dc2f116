/* A small robot that speaks "cubeling": three joints, three moods, no clock and no line of its own.
 *
 * Whoever owns it gives it bytes and the time (milliseconds; they may run over), and sends what it
 * writes. terminal.c puts it behind a pseudo-terminal, steps.c on virtual time.
 */
#ifndef ROBOT_H
#define ROBOT_H

#include "cubeling_messages.h"

#define ROBOT_JOINTS 3
#define ROBOT_LOOKS_EVERY_MS 10 /* call robot_advance at least so often; 50 ms are the limit */

typedef struct {
    uint8_t index;  /* of what is played; CUBELING_NOTHING if nothing is */
    uint32_t since; /* when it began [ms] */
} robot_playing;

typedef struct {
    float from, to;    /* [mrad] */
    uint32_t since;    /* when it began [ms] */
    uint16_t duration; /* [ms] */
} robot_way;

typedef struct {
    void (*write)(const uint8_t *bytes, size_t size); /* one whole frame; must not wait */
    uint32_t now;

    cubeling_reader reader;
    uint16_t session; /* 0: none is open */
    uint8_t version;  /* spoken in it */
    uint16_t beat;    /* last one heard in it */
    uint32_t heard;   /* when a message of it came [ms] */
    uint32_t stated;  /* when STATE was sent [ms] */
    uint32_t refused; /* when GONE was sent [ms] */
    uint32_t host;    /* who greeted last; 0: nobody has */
    uint32_t taken;   /* number of the host's last command, kept when a session ends */
    uint8_t result;   /* what that one was answered */
    uint8_t in_force; /* whether it has not been undone by going to neutral */

    float target[2];  /* valence and arousal that it moves towards */
    float feeling[2]; /* valence and arousal that it shows */
    uint8_t mood;     /* named by the host; CUBELING_NOTHING: by what it feels */
    uint8_t still;    /* stopped, and not told anything since */
    robot_playing motion, sound;
    float angles[ROBOT_JOINTS]; /* [mrad] */
    uint16_t held;              /* bit i: the host holds joint i */
    robot_way ways[ROBOT_JOINTS];

    cubeling_log line; /* waits to be sent, if its text is not empty */
    uint16_t lines;    /* written so far, also those for which there was no room */
    uint32_t logged;   /* when LOG was sent [ms] */
} robot;

void robot_start(robot *self, void (*write)(const uint8_t *, size_t), uint32_t now);

/* Take bytes from the line. */
void robot_receive(robot *self, const uint8_t *bytes, size_t size, uint32_t now);

/* Move, and do what is due. */
void robot_advance(robot *self, uint32_t now);

#endif

/* The robot behind a pseudo-terminal, in real time: prints its name and runs until it is ended. */
#define _XOPEN_SOURCE 700
#include "robot.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static int terminal;

/* What the line does not take is lost: a robot never waits for its host. */
static void write_frame(const uint8_t *bytes, size_t size)
{
    ssize_t taken = write(terminal, bytes, size);
    (void)taken;
}

static uint32_t milliseconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)now.tv_sec * 1000u + (uint32_t)(now.tv_nsec / 1000000);
}

/* A terminal that passes all bytes on as they are. Its far end stays open here too, so that it
 * does not hang up between two hosts. */
static int open_terminal(void)
{
    struct termios settings;
    terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0)
        return -1;
    int far_end = open(ptsname(terminal), O_RDWR | O_NOCTTY);
    if (far_end < 0 || tcgetattr(far_end, &settings) != 0)
        return -1;
    settings.c_iflag = settings.c_oflag = settings.c_lflag = 0;
    settings.c_cflag = CS8 | CREAD | CLOCAL;
    if (tcsetattr(far_end, TCSANOW, &settings) != 0)
        return -1;
    return fcntl(terminal, F_SETFL, O_NONBLOCK);
}

int main(void)
{
    static robot self;
    uint8_t bytes[256];
    if (open_terminal() != 0) {
        perror("no pseudo-terminal");
        return 1;
    }
    robot_start(&self, write_frame, milliseconds());
    printf("%s\n", ptsname(terminal));
    fflush(stdout);
    for (;;) {
        struct pollfd line = {.fd = terminal, .events = POLLIN};
        poll(&line, 1, ROBOT_LOOKS_EVERY_MS);
        ssize_t size = read(terminal, bytes, sizeof bytes);
        robot_receive(&self, bytes, size > 0 ? (size_t)size : 0, milliseconds());
    }
}

/* The robot on virtual time. A step of the input is a time [ms, 4 bytes], a size [2 bytes] and as
 * many bytes for the robot; a step of the output a size [2 bytes] and what the robot says. */
#include "robot.h"

#include <stdio.h>

static uint8_t said[60000];
static uint16_t said_size;

static void write_frame(const uint8_t *bytes, size_t size)
{
    if (size > sizeof said - said_size)
        return;
    memcpy(said + said_size, bytes, size);
    said_size = (uint16_t)(said_size + size);
}

int main(void)
{
    static robot self;
    static uint8_t heard[65536];
    uint8_t head[6];
    int started = 0;
    while (fread(head, sizeof head, 1, stdin) == 1) {
        uint32_t now = cubeling_get32(head);
        size_t size = cubeling_get16(head + 4);
        if (fread(heard, 1, size, stdin) != size)
            return 1;
        if (!started)
            robot_start(&self, write_frame, now);
        started = 1;
        said_size = 0;
        robot_receive(&self, heard, size, now);
        cubeling_put16(head, said_size);
        fwrite(head, 2, 1, stdout);
        fwrite(said, said_size, 1, stdout);
        fflush(stdout);
    }
    return 0;
}

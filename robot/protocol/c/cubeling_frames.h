/* Framing of the protocol "cubeling" in C99: delimiters and a checksum.
 *
 * See robot/PROTOCOL.md, section 2. No allocation, only freestanding headers; safe for any input.
 */
#ifndef CUBELING_FRAMES_H
#define CUBELING_FRAMES_H

#include <stddef.h>
#include <stdint.h>

#define CUBELING_MAX_BODY 120u
#define CUBELING_MAX_FRAME (CUBELING_MAX_BODY + 1u + 3u) /* between its delimiters */
#define CUBELING_MAX_WIRE (CUBELING_MAX_FRAME + 2u)      /* with its delimiters */

/* CRC-16/CCITT-FALSE; of "123456789" it is 0x29B1. */
static inline uint16_t cubeling_crc16(const uint8_t *data, size_t size)
{
    uint16_t crc = 0xFFFFu;
    for (size_t at = 0; at < size; at++) {
        crc = (uint16_t)(crc ^ (uint16_t)(data[at] << 8));
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)((uint32_t)crc << 1 ^ ((crc & 0x8000u) ? 0x1021u : 0u));
    }
    return crc;
}

/* Write the check of an encoded body; none of its three bytes is zero. */
static inline void cubeling_check(const uint8_t *encoded, size_t size, uint8_t check[3])
{
    uint16_t crc = cubeling_crc16(encoded, size);
    check[0] = (uint8_t)(0xE0u | (crc >> 12));
    check[1] = (uint8_t)(0x80u | ((crc >> 6) & 0x3Fu));
    check[2] = (uint8_t)(0x80u | (crc & 0x3Fu));
}

/* Write the frame of a body, delimiters included, into CUBELING_MAX_WIRE bytes.
 * Returns its size; 0 if the body is empty or too long. */
static inline size_t cubeling_encode(const uint8_t *body, size_t size, uint8_t *wire)
{
    if (size < 1 || size > CUBELING_MAX_BODY)
        return 0;
    uint8_t *encoded = wire + 1;
    size_t run = 0; /* index of the length of the current run */
    wire[0] = 0;
    encoded[0] = 1;
    for (size_t at = 0; at < size; at++) {
        encoded[at + 1] = body[at];
        if (body[at]) {
            encoded[run]++;
        } else {
            run = at + 1;
            encoded[run] = 1;
        }
    }
    cubeling_check(encoded, size + 1, encoded + size + 1);
    wire[size + 5] = 0;
    return size + 6;
}

/* Undo COBS in place: what stood between two edges becomes a body.
 * Returns its size; 0 if the frame is none. */
static inline size_t cubeling_decode(uint8_t *frame, size_t size)
{
    uint8_t check[3];
    if (size < 5 || size > CUBELING_MAX_FRAME)
        return 0;
    size -= 3; /* the encoded body */
    cubeling_check(frame, size, check);
    for (size_t at = 0; at < 3; at++)
        if (frame[size + at] != check[at])
            return 0;
    size_t run = 0;
    while (run < size) { /* every piece names the place of the next; the last one ends the body */
        size_t length = frame[run];
        if (length == 0 || run + length > size)
            return 0;
        frame[run] = 0;
        run += length;
    }
    for (size_t at = 1; at < size; at++)
        frame[at - 1] = frame[at];
    return size - 1;
}

/* Finds the frames in a stream; all zero is a new one. */
typedef struct {
    uint8_t bytes[CUBELING_MAX_FRAME + 1u]; /* one more than a frame can have: enough to drop it */
    uint8_t size;
    uint32_t errors; /* stretches between two edges that were no frame */
} cubeling_reader;

/* Take the next byte of the line. Returns the size of a body, which then stands in reader->bytes
 * until the next call; 0 while there is none. */
static inline size_t cubeling_read(cubeling_reader *reader, uint8_t byte)
{
    if (byte) {
        if (reader->size < sizeof reader->bytes)
            reader->bytes[reader->size++] = byte;
        return 0;
    }
    size_t size = reader->size;
    reader->size = 0;
    if (size == 0)
        return 0;
    size = cubeling_decode(reader->bytes, size);
    if (size == 0)
        reader->errors++;
    return size;
}

#endif

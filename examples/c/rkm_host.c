/* SPDX-License-Identifier: MIT */
#include "rkm_host.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define FLAG 0x7e
#define ESCAPE 0x7d
#define BODY_MAX 512
#define SET_COMMAND 2
#define GET_POSITION 4
#define GET_PROGRESS 7

enum rkm_result rkm_open(struct rkm_unit *unit, const char *path, uint8_t node)
{
    struct termios mode;

    *unit = (struct rkm_unit){.node = node, .timeout = 500, .retries = 2};
    unit->fd = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (unit->fd < 0)
        return RKM_PORT;
    if (tcgetattr(unit->fd, &mode) == 0) {
        cfmakeraw(&mode);
        cfsetspeed(&mode, B19200);
        if (tcsetattr(unit->fd, TCSANOW, &mode) == 0)
            return RKM_OK;
    }
    rkm_close(unit);
    return RKM_PORT;
}

void rkm_close(struct rkm_unit *unit)
{
    close(unit->fd);
    unit->fd = -1;
}

static uint16_t fcs16(const uint8_t *bytes, size_t length)
{
    uint16_t value = 0xffff;

    for (size_t i = 0; i < length; i++) {
        value ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            value = (uint16_t)(value >> 1 ^ (value & 1 ? 0x8408 : 0));
    }
    return value ^ 0xffff;
}

/* The frame of a body (node to, node from, message). Returns its length; `frame` has room for twice the body and 8 bytes. */
static size_t make_frame(uint8_t *body, size_t length, uint8_t *frame)
{
    uint16_t check = fcs16(body, length);
    size_t n = 0;

    body[length++] = (uint8_t)check;
    body[length++] = (uint8_t)(check >> 8);
    frame[n++] = FLAG;
    for (size_t i = 0; i < length; i++) {
        if (body[i] == FLAG || body[i] == ESCAPE) {
            frame[n++] = ESCAPE;
            frame[n++] = body[i] ^ 0x20;
        } else {
            frame[n++] = body[i];
        }
    }
    frame[n++] = FLAG;
    return n;
}

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* The next valid frame before `end`. Returns the length of its body without the check value; 0: none; -1: the port failed. */
static int next_frame(struct rkm_unit *unit, int64_t end, uint8_t body[BODY_MAX])
{
    size_t length = 0;
    bool escaped = false;

    for (;;) {
        int64_t left = end - now_ms();
        struct pollfd port = {.fd = unit->fd, .events = POLLIN};
        uint8_t byte;

        if (left <= 0)
            return 0;
        if (poll(&port, 1, (int)left) <= 0)
            continue;
        if (read(unit->fd, &byte, 1) != 1)
            return -1;
        if (byte == FLAG) {
            if (length >= 5 && fcs16(body, length - 2) == (body[length - 2] | body[length - 1] << 8))
                return (int)length - 2;
            length = 0;
            escaped = false;
        } else if (byte == ESCAPE) {
            escaped = true;
        } else if (length < BODY_MAX) {
            body[length++] = escaped ? byte ^ 0x20 : byte;
            escaped = false;
        }
    }
}

/* Send message `number` with `text` behind the motor's digit; the answer, from its number on, is in `answer`, ended by 0. */
static enum rkm_result request(struct rkm_unit *unit, uint8_t number, int motor, const char *text, char answer[BODY_MAX + 1])
{
    uint8_t body[BODY_MAX + 2] = {unit->node, 0, number, (uint8_t)('0' + motor)}, frame[2 * sizeof body + 8];
    size_t length = strlen(text);

    if (length > BODY_MAX - 4)
        return RKM_REFUSED;
    memcpy(body + 4, text, length);
    size_t size = make_frame(body, length + 4, frame);
    for (int attempt = 0; attempt <= unit->retries; attempt++) {
        int64_t end = now_ms() + unit->timeout;
        uint8_t heard[BODY_MAX];
        int count;

        tcflush(unit->fd, TCIFLUSH);
        if (write(unit->fd, frame, size) != (ssize_t)size)
            return RKM_PORT;
        while ((count = next_frame(unit, end, heard)) > 0) {
            if (count >= 4 && heard[0] == 0 && heard[1] == unit->node && heard[2] == number && heard[3] == '0' + motor) {
                memcpy(answer, heard + 2, (size_t)count - 2);
                answer[count - 2] = '\0';
                return RKM_OK;
            }
        }
        if (count < 0)
            return RKM_PORT;
    }
    return RKM_NO_ANSWER;
}

enum rkm_result rkm_set_command(struct rkm_unit *unit, int motor, const char *text)
{
    char answer[BODY_MAX + 1];
    enum rkm_result result = request(unit, SET_COMMAND, motor, text, answer);

    return result == RKM_OK && answer[2] != 0 ? RKM_REFUSED : result;
}

enum rkm_result rkm_position(struct rkm_unit *unit, int motor, int32_t *position)
{
    char answer[BODY_MAX + 1];
    enum rkm_result result = request(unit, GET_POSITION, motor, "", answer);

    if (result == RKM_OK)
        *position = (int32_t)strtol(answer + 3, NULL, 10);
    return result;
}

enum rkm_result rkm_busy(struct rkm_unit *unit, int motor, bool *busy)
{
    char answer[BODY_MAX + 1];
    enum rkm_result result = request(unit, GET_PROGRESS, motor, "", answer);
    const char *index = result == RKM_OK ? strchr(answer, ';') : NULL;

    if (result == RKM_OK)
        *busy = index != NULL && strtol(index + 1, NULL, 10) != 0;
    return result;
}

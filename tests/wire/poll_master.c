/* SPDX-License-Identifier: MIT */
/* poll_master: a host that starts the same motion on all motors of all units of a line and then asks every unit for its
 * positions, one after the other, as fast as it gets answers, until all have arrived.
 *
 *     poll_master PTY UNITS STEPS SECONDS
 *
 * PTY: the line; UNITS: addresses 1..UNITS are there; STEPS: of every motor; SECONDS: of real time, after which it stops anyway.
 * Prints {"polls":…,"answers":…,"wrong":…,"arrived":…,"seconds":…}: how many polls were answered, how many of the answers were
 * wrong, how many motors are at STEPS. Exits with 0 if every poll was answered and nothing was wrong. */
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <rkm04/link.h>

#define PATIENCE 5000 /* ms for an answer */
#define MOTORS 4
#define SET_COMMAND 2
#define GET_POSITION 4

struct host {
    int fd;
    uint64_t polls, answers, wrong;
    long steps;
    long position[RKM04_NODE_MAX + 1][MOTORS];
    uint8_t message[RKM04_MESSAGE_MAX];
};

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec / 1e9;
}

static bool send_message(const struct host *host, uint8_t node, const void *message, size_t length)
{
    struct rkm04_sender sender = {0};
    uint8_t frame[512];
    size_t at = rkm04_hdlc.begin(&sender, node, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, ((const uint8_t *)message)[i], frame + at);
    at += rkm04_hdlc.end(&sender, frame + at);
    return write(host->fd, frame, at) == (ssize_t)at;
}

/* Wait for the answer of a unit. Returns its length, 0: none came. */
static size_t hear(struct host *host, uint8_t node)
{
    struct rkm04_receiver receiver = {0};
    struct pollfd ready = {.fd = host->fd, .events = POLLIN};
    uint8_t bytes[256];
    while (poll(&ready, 1, PATIENCE) > 0) {
        ssize_t length = read(host->fd, bytes, sizeof bytes);
        if (length <= 0)
            return 0;
        for (ssize_t i = 0; i < length; i++)
            if (rkm04_hdlc.receive(&receiver, bytes[i], 0, host->message, sizeof host->message))
                return receiver.snode == node && receiver.dnode == 0 ? receiver.length : 0;
    }
    return 0;
}

/* Four fields, each a length and so many characters (message 4). Positions never go back nor beyond the end. */
static bool read_positions(struct host *host, uint8_t node, size_t length)
{
    size_t at = 2;
    for (unsigned motor = 0; motor < MOTORS; motor++) {
        char field[16] = "";
        if (at >= length || host->message[at] >= sizeof field || at + 1 + host->message[at] > length)
            return false;
        memcpy(field, host->message + at + 1, host->message[at]);
        at += 1 + (size_t)host->message[at];
        long position = strtol(field, NULL, 10);
        if (position < host->position[node][motor] || position > host->steps)
            return false;
        host->position[node][motor] = position;
    }
    return at == length;
}

static void ask(struct host *host, uint8_t node)
{
    host->polls++;
    if (!send_message(host, node, (uint8_t[]){GET_POSITION, '0'}, 2))
        return;
    size_t length = hear(host, node);
    if (length == 0)
        return;
    host->answers++;
    if (host->message[0] != GET_POSITION || !read_positions(host, node, length))
        host->wrong++;
}

static unsigned arrived(const struct host *host, unsigned units)
{
    unsigned number = 0;
    for (unsigned node = 1; node <= units; node++)
        for (unsigned motor = 0; motor < MOTORS; motor++)
            number += host->position[node][motor] == host->steps;
    return number;
}

static bool open_line(struct host *host, const char *path)
{
    struct termios settings;
    host->fd = open(path, O_RDWR | O_NOCTTY);
    if (host->fd < 0 || tcgetattr(host->fd, &settings) != 0)
        return false;
    cfmakeraw(&settings);
    cfsetspeed(&settings, B19200);
    return tcsetattr(host->fd, TCSANOW, &settings) == 0;
}

int main(int argc, char **argv)
{
    static struct host host;
    char text[64];
    if (argc != 5 || !open_line(&host, argv[1])) {
        fputs("usage: poll_master PTY UNITS STEPS SECONDS\n", stderr);
        return 2;
    }
    unsigned units = (unsigned)atoi(argv[2]);
    host.steps = atol(argv[3]);
    double start = now(), end = start + atof(argv[4]);
    int length = snprintf(text, sizeof text, "%c0\\C100 A60000 S2000 V16000 F%ld R", SET_COMMAND, host.steps);
    if (!send_message(&host, 0, text, (size_t)length))
        return 1;
    bool late = false;
    for (unsigned node = 1; arrived(&host, units) < MOTORS * units && !late; node = node % units + 1) {
        ask(&host, (uint8_t)node);
        late = now() > end || host.answers < host.polls;
    }
    printf("{\"polls\":%" PRIu64 ",\"answers\":%" PRIu64 ",\"wrong\":%" PRIu64 ",\"arrived\":%u,\"seconds\":%.3f}\n",
           host.polls, host.answers, host.wrong, arrived(&host, units), now() - start);
    return host.answers == host.polls && host.wrong == 0 ? 0 : 1;
}

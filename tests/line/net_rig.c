/* SPDX-License-Identifier: MIT */
#include "net_rig.h"

#include <arpa/inet.h>
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct net_rig line;

/* ---- The owner of the line ------------------------------------------------------------------------------------------ */

static void tell(const char *text)
{
    ck_assert_uint_lt(strlen(line.story) + strlen(text), sizeof line.story);
    strcat(line.story, text);
}

static void on_bytes(void *context, const uint8_t *data, size_t length)
{
    ck_assert_ptr_eq(context, &line);
    ck_assert_uint_le(length, line.room);
    ck_assert_uint_le(line.heard_count + length, HEARD_MAX);
    memcpy(line.heard + line.heard_count, data, length);
    line.heard_count += length;
    line.room -= length;
    net_port_wake(&line.port); /* as an owner may do at any time */
}

static size_t on_room(void *context)
{
    (void)context;
    return line.room;
}

static void on_event(void *context, enum net_event event, const char *peer)
{
    static const char *const words[] = {"detached ", "attached ", "refused "};
    (void)context;
    tell(words[event]);
    ck_assert(strchr(peer, ':') != NULL);
}

static const char *on_owner(void *context)
{
    (void)context;
    return line.owner;
}

static void on_settings(void *context, uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits)
{
    char text[40];
    (void)context;
    snprintf(text, sizeof text, "%u-%u%c%u ", baud, data_bits, parity, stop_bits);
    tell(text);
}

static void on_break(void *context, bool on)
{
    (void)context;
    tell(on ? "break " : "unbreak ");
}

static void on_lines(void *context, bool dtr, bool rts)
{
    (void)context;
    tell(dtr ? rts ? "dtr+rts " : "dtr " : rts ? "rts " : "none ");
}

static void on_purge(void *context)
{
    (void)context;
    tell("purge ");
}

const struct net_port_calls net_rig_calls = {
    .bytes = on_bytes,
    .room = on_room,
    .event = on_event,
    .owner = on_owner,
    .settings = on_settings,
    .line_break = on_break,
    .lines = on_lines,
    .purge = on_purge,
};

void open_line(enum net_kind kind, const char *address)
{
    memset(&line, 0, sizeof line);
    line.room = HEARD_MAX;
    ck_assert_int_eq(uv_loop_init(&line.loop), 0);
    ck_assert(net_port_open(&line.port, &line.loop, address, kind, &net_rig_calls, &line));
}

void close_line(void)
{
    net_port_close(&line.port);
    net_port_close(&line.port); /* twice is once */
    uv_run(&line.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&line.loop), 0);
}

/* ---- Clients -------------------------------------------------------------------------------------------------------- */

uint64_t now_ms(void)
{
    return uv_hrtime() / 1000000;
}

void spin(uint64_t end, const char *condition)
{
    uv_run(&line.loop, UV_RUN_NOWAIT);
    if (now_ms() > end)
        ck_abort_msg("never: %s; story: %s", condition, line.story);
}

int connect_client(void)
{
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    to.sin_port = htons((uint16_t)atoi(strrchr(line.port.address, ':') + 1));
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    fcntl(fd, F_SETFL, O_NONBLOCK); /* the line may have to let another client go first */
    ck_assert(connect(fd, (void *)&to, sizeof to) == 0 || errno == EINPROGRESS);
    return fd;
}

int attach_client(void)
{
    int fd = connect_client();
    line.story[0] = '\0';
    AWAIT(strstr(line.story, "attached"));
    return fd;
}

/* The client reads `length` bytes, or to the end of the connection. Returns their number. */
size_t receive(int fd, void *bytes, size_t length)
{
    size_t count = 0;
    bool ended = false;
    UNTIL(count == length || ended)
    {
        ssize_t n = recv(fd, (char *)bytes + count, length - count, 0);
        count += n > 0 ? (size_t)n : 0;
        ended = n == 0 || (n < 0 && errno != EAGAIN);
    }
    return count;
}

void send_all(int fd, const void *bytes, size_t length)
{
    size_t done = 0;
    UNTIL(done == length)
    {
        ssize_t n = send(fd, (const char *)bytes + done, length - done, MSG_NOSIGNAL);
        done += n > 0 ? (size_t)n : 0;
    }
}

void is_heard(const char *text)
{
    AWAIT(line.heard_count >= strlen(text));
    ck_assert_mem_eq(line.heard, text, strlen(text));
    ck_assert_uint_eq(line.heard_count, strlen(text));
}

void gets_bytes(int fd, const char *bytes, size_t length)
{
    char got[256];
    ck_assert_uint_eq(receive(fd, got, length), length);
    ck_assert_mem_eq(got, bytes, length);
}

/* The client has asked for something that is answered: then all before has been checked. */
void settle(int fd)
{
    send_all(fd, "\xff\xfa\x2c\x06\xff\xf0", 6);
    GETS(fd, "\xff\xfa\x2c\x6a\x60\xff\xf0");
}

int attach_rfc2217(void)
{
    int fd = attach_client();
    GETS(fd, opening);
    return fd;
}

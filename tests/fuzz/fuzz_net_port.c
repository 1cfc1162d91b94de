/* SPDX-License-Identifier: MIT */
/* fuzz_net_port.c: a line over TCP, raw or by RFC 2217, and clients that come, send anything, stop sending, go, are torn away
 * and read or do not, in any order; an owner who has room or not, sends, has the line himself, pulls the plug. Time is that of
 * loop_machine.c, the sockets are real. At most one client has the line; the owner never gets more bytes than there is room
 * for, nor more than clients have sent; when all have gone the next client gets the line, and is read.
 *
 * First byte: 1: RFC 2217. Then two bytes an action: what and who, and a value; a sender takes as many more bytes. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "fuzz.h"
#include "line/net_port.h"
#include "loop_machine.h"

#define CLIENTS 4u
#define ACTIONS 150u
#define CROWD_MAX 20u
#define TURNS 40u

static uv_loop_t loop;
static struct net_port port;
static int client[CLIENTS];    /* -1: not there */
static uint32_t sent[CLIENTS]; /* bytes */
static size_t room, heard;
static unsigned attached, detached, refused, crowd_count;
static bool owned;

static void on_bytes(void *context, const uint8_t *data, size_t length)
{
    (void)context, (void)data;
    FUZZ_CHECK(length > 0 && length <= room, "%zu bytes, room for %zu", length, room);
    room -= length;
    heard += length;
}

static size_t on_room(void *context)
{
    (void)context;
    return room;
}

static void on_event(void *context, enum net_event event, const char *peer)
{
    (void)context;
    FUZZ_CHECK(strncmp(peer, "127.0.0.1:", 10) == 0 || event != NET_ATTACHED, "'%s'", peer);
    attached += event == NET_ATTACHED;
    detached += event == NET_DETACHED;
    refused += event == NET_REFUSED;
    FUZZ_CHECK(attached - detached <= 1, "%u have come, %u have gone", attached, detached);
}

static const char *on_owner(void *context)
{
    (void)context;
    return owned ? "the owner" : NULL;
}

static void on_settings(void *context, uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits)
{
    (void)context, (void)baud;
    FUZZ_CHECK(data_bits >= 5 && data_bits <= 8 && strchr("NOEMS", parity) && stop_bits >= 1 && stop_bits <= 3, "settings");
}

static void on_break(void *context, bool on)
{
    (void)context, (void)on;
}

static void on_purge(void *context)
{
    (void)context;
}

static const struct net_port_calls calls = {
    .bytes = on_bytes,
    .room = on_room,
    .event = on_event,
    .owner = on_owner,
    .settings = on_settings,
    .line_break = on_break,
    .purge = on_purge,
};

static void turn(unsigned times)
{
    while (times-- > 0) {
        machine_ring();
        uv_run(&loop, UV_RUN_NOWAIT);
        FUZZ_CHECK(port.attached == (attached > detached), "attached %d", port.attached);
    }
}

static int come(void)
{
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int one = 1, fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    to.sin_port = htons((uint16_t)atoi(strrchr(port.address, ':') + 1));
    setsockopt(fd, IPPROTO_TCP, 1 /* TCP_NODELAY */, &one, sizeof one);
    FUZZ_CHECK(connect(fd, (void *)&to, sizeof to) == 0 || errno == EINPROGRESS, "%s", strerror(errno));
    return fd;
}

/* Torn away: with it goes its port, of which the system has few. */
static void tear(int fd)
{
    struct linger now = {.l_onoff = 1, .l_linger = 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(fd);
}

static void say(unsigned who, struct fuzz *fuzz, uint8_t value)
{
    static uint8_t much[16384];
    size_t length;
    const uint8_t *bytes = fuzz_take(fuzz, value & 63u, &length);
    if (value & 64)
        length = value & 128 ? sizeof much : length;
    ssize_t n = send(client[who], length == sizeof much ? much : bytes, length, MSG_NOSIGNAL);
    sent[who] += n > 0 ? (uint32_t)n : 0;
}

static void gather_crowd(unsigned number)
{
    while (number-- > 0 && crowd_count < CROWD_MAX) {
        crowd_count++;
        tear(come()); /* gone before it is checked */
    }
}

static void act(struct fuzz *fuzz, uint8_t what, uint8_t value)
{
    static const uint8_t bytes[255];
    uint8_t got[512];
    unsigned who = what >> 4 & 3u;
    int *fd = &client[who];
    switch (what & 15u) {
    case 0: case 1: case 2:
        if (*fd < 0)
            *fd = come();
        else
            say(who, fuzz, value);
        break;
    case 3:
        if (*fd >= 0)
            value & 1 ? tear(*fd) : close(*fd);
        *fd = -1;
        break;
    case 4:
        if (*fd >= 0)
            shutdown(*fd, SHUT_WR);
        break;
    case 5:
        if (*fd >= 0)
            (void)!recv(*fd, got, sizeof got, 0);
        break;
    case 6:
        room += value * 16u;
        net_port_wake(&port);
        break;
    case 7:
        net_port_send(&port, bytes, value);
        break;
    case 8:
        owned = value & 1;
        break;
    case 9:
        net_port_plug(&port, value & 1);
        break;
    case 10:
        machine_pass(value * UINT64_C(20000000));
        break;
    case 11:
        gather_crowd(value & 7u);
        break;
    case 12:
        net_port_client(&port);
        break;
    default:
        turn(1 + (value & 7u));
    }
}

/* Everybody goes: then the next one gets the line. */
static void check_next(void)
{
    for (unsigned i = 0; i < CLIENTS; i++)
        if (client[i] >= 0)
            tear(client[i]);
    owned = false;
    net_port_plug(&port, true);
    room = 100000000;
    net_port_wake(&port);
    for (unsigned i = 0; i < 3; i++) {
        turn(TURNS);
        machine_pass(UINT64_C(1000000000));
    }
    FUZZ_CHECK(!port.attached, "one who has gone has the line");
    unsigned before = attached;
    int fd = come();
    turn(TURNS);
    FUZZ_CHECK(attached == before + 1, "the next one does not get the line");
    size_t so_far = heard;
    FUZZ_CHECK(send(fd, "next", 4, MSG_NOSIGNAL) == 4, "%s", strerror(errno));
    turn(TURNS);
    FUZZ_CHECK(heard == so_far + 4, "%zu bytes of 4", heard - so_far);
    tear(fd);
    turn(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    signal(SIGPIPE, SIG_IGN);
    machine_begin(0);
    memset(&port, 0, sizeof port);
    memset(sent, 0, sizeof sent);
    for (unsigned i = 0; i < CLIENTS; i++)
        client[i] = -1;
    room = mode & 2 ? 100 : 100000;
    heard = attached = detached = refused = crowd_count = 0;
    owned = false;
    FUZZ_CHECK(uv_loop_init(&loop) == 0, "no loop");
    FUZZ_CHECK(net_port_open(&port, &loop, "0", mode & 1 ? NET_RFC2217 : NET_RAW, &calls, NULL), "it does not listen");
    for (unsigned i = 0; i < ACTIONS && fuzz.left > 0; i++) {
        uint8_t what = fuzz_byte(&fuzz);
        act(&fuzz, what, fuzz_byte(&fuzz));
    }
    uint64_t most = 0;
    for (unsigned i = 0; i < CLIENTS; i++)
        most += sent[i];
    FUZZ_CHECK(heard <= most, "%zu bytes of %llu", heard, (unsigned long long)most);
    check_next();
    net_port_close(&port);
    uv_run(&loop, UV_RUN_DEFAULT);
    FUZZ_CHECK(uv_loop_close(&loop) == 0, "a handle is open");
    machine_end();
    return 0;
}

/* SPDX-License-Identifier: MIT */
/* net_rig.h: a line over TCP as its owner and its clients see it, with real sockets on the loopback. */
#ifndef RKM04_TESTS_NET_RIG_H
#define RKM04_TESTS_NET_RIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "line/net_port.h"

#define LIMIT_MS 20000 /* until a condition counts as never coming true */
#define HEARD_MAX 65536

/* The line as its owner sees it. */
struct net_rig {
    uv_loop_t loop;
    struct net_port port;
    size_t room;           /* bytes the units still take */
    const char *owner;
    uint8_t heard[HEARD_MAX]; /* by the units */
    size_t heard_count;
    char story[20000];      /* news and what RFC 2217 brought, in words */
};
extern struct net_rig line;
extern const struct net_port_calls net_rig_calls;

void open_line(enum net_kind kind, const char *address);
void close_line(void);

uint64_t now_ms(void);

/* One turn of the loop; fails if it is later than `end` (ms). */
void spin(uint64_t end, const char *condition);

/* Let the loop run until the condition is true; fail if that takes too long. UNTIL does what follows meanwhile. */
#define UNTIL(condition) for (uint64_t end_ = now_ms() + LIMIT_MS; !(condition); spin(end_, #condition))
#define AWAIT(condition) UNTIL(condition) {}

int connect_client(void);

/* Connect, and wait until the line is had. */
int attach_client(void);

/* The client reads `length` bytes, or to the end of the connection. Returns their number. */
size_t receive(int fd, void *bytes, size_t length);
void send_all(int fd, const void *bytes, size_t length);

/* The units have received this and nothing else. */
void is_heard(const char *text);

/* The client gets these bytes. */
void gets_bytes(int fd, const char *bytes, size_t length);
#define GETS(fd, text) gets_bytes(fd, text, sizeof text - 1)

/* The client has asked for something that is answered: then all before has been checked. */
void settle(int fd);

/* What the line says to a client of RFC 2217 first. */
static const char opening[] = "\xff\xfb\x00\xff\xfd\x00\xff\xfb\x03\xff\xfd\x2c";

int attach_rfc2217(void);

#endif

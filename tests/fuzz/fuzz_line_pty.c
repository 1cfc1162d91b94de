/* SPDX-License-Identifier: MIT */
/* fuzz_line_pty.c: a real pty, and clients that open, close, lock (TIOCEXCL), set up, write and read it in any order. Whenever
 * the line has been followed it knows whether a client is there; a client has the settings that were made last; one that
 * comes to a line without a client finds nothing to read, no lock, and a raw line; bytes pass in order; none makes the line fail.
 *
 * First byte: 1: inotify is used up. Then two bytes an action: what and who, and a value. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/timerfd.h>
#include <termios.h>
#include <unistd.h>

#include "fuzz.h"
#include "line/line.h"
#include "line/line_raw.h"
#include "line/log.h"

#define CLIENTS 3u
#define ACTIONS 200u

int __wrap_inotify_add_watch(int fd, const char *path, uint32_t mask);
int __real_inotify_add_watch(int fd, const char *path, uint32_t mask);

int __wrap_timerfd_create(clockid_t clock, int flags);
int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old);

static int timer; /* goes off when the line is followed */
static bool used_up;
static struct line_watch watch;
static struct line line;
static int client[CLIENTS]; /* -1: not there */
static unsigned there;
static bool known, loose, locked;   /* `set` is right; actions since the line was followed; a client may have left a lock */
static struct termios set;        /* by a client, last */

int __wrap_inotify_add_watch(int fd, const char *path, uint32_t mask)
{
    errno = ENOSPC;
    return used_up ? -1 : __real_inotify_add_watch(fd, path, mask);
}

void log_error(const char *format, ...)
{
    (void)format;
}

void log_at(uint64_t tick, const char *format, ...)
{
    (void)tick, (void)format;
}

static void on_event(void *context, enum line_event event)
{
    (void)context;
    FUZZ_CHECK(event != LINE_FAILED, "the line has failed");
}

int __wrap_timerfd_create(clockid_t clock, int flags)
{
    (void)clock, (void)flags;
    timer = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    return timer;
}

int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old)
{
    (void)fd, (void)flags, (void)spec, (void)old;
    return 0;
}

static bool same(const struct termios *a, const struct termios *b)
{
    return a->c_iflag == b->c_iflag && a->c_oflag == b->c_oflag && a->c_lflag == b->c_lflag && a->c_cflag == b->c_cflag &&
           memcmp(a->c_cc, b->c_cc, sizeof a->c_cc) == 0;
}

static void check_settings(void)
{
    struct termios now;
    FUZZ_CHECK(tcgetattr(line.fd, &now) == 0, "%s", strerror(errno));
    FUZZ_CHECK(!known || same(&now, &set), "the settings are others");
}

/* Without notices a look is due. */
static void follow(void)
{
    if (used_up)
        eventfd_write(timer, 1);
    line_watch_update(&watch);
    /* One who opened it together with one that locked it and has gone is seen when it sends. */
    bool unseen = locked && line.clients == 0 && there > 0;
    FUZZ_CHECK((line.clients > 0) == (there > 0) || unseen, "%u clients, %u there", line.clients, there);
    known = known && !unseen;
    line_watch_update(&watch);
    check_settings();
    loose = false;
    if (there == 0)
        locked = false;
}

static void come(unsigned who)
{
    struct termios now;
    int waiting = 0;
    bool first = there == 0 && !loose;
    client[who] = open(line.path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    FUZZ_CHECK(client[who] >= 0 || (errno == EBUSY && (locked || there > 0)), "%s", strerror(errno));
    if (client[who] < 0)
        return;
    there++;
    if (!first)
        return;
    FUZZ_CHECK(ioctl(client[who], FIONREAD, &waiting) == 0 && waiting == 0, "%d bytes of another one", waiting);
    FUZZ_CHECK(tcgetattr(client[who], &now) == 0 && !line_is_cooked(&now), "a cooked line");
}

static void go(unsigned who)
{
    close(client[who]);
    client[who] = -1;
    there--;
    if (there == 0 && line_is_cooked(&set))
        known = false; /* it will be made raw, unless a client comes first */
}

static void set_up(unsigned who, uint8_t value)
{
    tcgetattr(client[who], &set);
    if (value & 1)
        set.c_lflag ^= ECHO;
    if (value & 2)
        set.c_cflag ^= CSTOPB;
    if (value & 4)
        set.c_iflag ^= IXON;
    set.c_cc[VTIME] = value >> 4;
    cfsetspeed(&set, value & 8 ? B9600 : B19200);
    FUZZ_CHECK(tcsetattr(client[who], TCSANOW, &set) == 0, "%s", strerror(errno));
    tcgetattr(client[who], &set); /* as the system has taken it */
    known = true;
}

static void pass_bytes(unsigned who, uint8_t value)
{
    uint8_t bytes[300];
    memset(bytes, value | 0x80, sizeof bytes);
    if (value & 1)
        (void)!write(client[who], bytes, value);
    else
        (void)!read(client[who], bytes, sizeof bytes);
}

static void act(uint8_t what, uint8_t value)
{
    uint8_t bytes[300];
    unsigned who = (what >> 4) % CLIENTS;
    bool is_there = client[who] >= 0;
    switch (what & 7) {
    case 0:
        if (!is_there)
            come(who);
        else
            go(who);
        break;
    case 1:
        follow();
        return;
    case 2:
        if (is_there)
            set_up(who, value);
        break;
    case 3:
        if (is_there && ioctl(client[who], value & 1 ? TIOCEXCL : TIOCNXCL) == 0)
            locked = locked || (value & 1);
        break;
    case 4:
        if (is_there)
            pass_bytes(who, value);
        break;
    case 5:
        FUZZ_CHECK(line_read(&line, bytes, sizeof bytes) >= 0, "the line is gone: %s", strerror(errno));
        if (line.clients == 0)
            line_pty_recount(&line);
        break;
    case 6:
        memset(bytes, value, sizeof bytes);
        FUZZ_CHECK(line_write(&line, bytes, value) <= value, "more dropped than sent");
        break;
    default:
        if (is_there)
            tcflow(client[who], value & 1 ? TCOOFF : TCOON);
    }
    loose = loose || (what & 7) == 0;
    if (what & 8)
        follow();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    used_up = fuzz_byte(&fuzz) & 1;
    known = loose = locked = false;
    there = 0;
    for (unsigned i = 0; i < CLIENTS; i++)
        client[i] = -1;
    FUZZ_CHECK(line_watch_open(&watch) && line_pty_open(&line, &watch, on_event, NULL), "no pty");
    tcgetattr(line.fd, &set);
    known = true;
    for (unsigned i = 0; i < ACTIONS && fuzz.left > 0; i++) {
        uint8_t what = fuzz_byte(&fuzz);
        act(what, fuzz_byte(&fuzz));
    }
    for (unsigned i = 0; i < CLIENTS; i++)
        if (client[i] >= 0)
            go(i);
    follow();
    FUZZ_CHECK(line.slave >= 0, "nobody keeps us out any more");
    come(0);
    go(0);
    line_close(&line);
    line_watch_close(&watch);
    return 0;
}

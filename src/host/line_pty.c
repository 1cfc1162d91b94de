/* SPDX-License-Identifier: MIT */
/* The emulator's own pty. It holds one slave descriptor itself, so the master never reports a hang-up (which would make
 * poll() return at once, for ever) and the settings stay within reach; who comes and goes is told by inotify.
 *
 * inotify merges equal notices that follow each other, so counting them may err when two clients come or go together. Hence
 * whether anybody is left is looked up whenever one closes it: with our own slave closed for a moment, the master tells by a
 * hang-up whether anybody else has the slave open. */
#include "line.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "log.h"

#define COUNT_TRIES 5

static bool set_flags(int fd)
{
    return fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 && fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK) == 0;
}

/* The settings of a pty nobody has touched: raw, 19200 baud, reads return what is there. */
static void fresh_settings(struct termios *settings)
{
    line_make_raw(settings);
    cfsetspeed(settings, B19200);
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
}

bool line_watch_open(struct line_watch *watch)
{
    watch->lines = NULL;
    watch->fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (watch->fd < 0)
        log_error("cannot watch who opens the line: %s; too many inotify instances in use?", strerror(errno));
    return watch->fd >= 0;
}

void line_watch_close(struct line_watch *watch)
{
    if (watch->fd >= 0)
        close(watch->fd);
    watch->fd = -1;
}

bool line_pty_open(struct line *line, struct line_watch *watch, line_tell *tell, void *context)
{
    line_none(line);
    line->tell = tell;
    line->context = context;
    struct termios settings = {0};
    fresh_settings(&settings);
    if (openpty(&line->fd, &line->slave, NULL, &settings, NULL) != 0) {
        log_error("cannot make a pty: %s; is /dev/pts mounted?", strerror(errno));
        return false;
    }
    int failed = ptsname_r(line->fd, line->path, sizeof line->path);
    if (failed != 0 || !set_flags(line->fd) || !set_flags(line->slave) ||
        (line->mark = inotify_add_watch(watch->fd, line->path, IN_OPEN | IN_CLOSE)) < 0) {
        log_error("cannot use the pty %s: %s", line->path, strerror(failed ? failed : errno));
        line_close(line);
        return false;
    }
    line->watch = watch;
    line->next = watch->lines;
    watch->lines = line;
    return true;
}

/* Nobody listens any more: what the unit sent and nobody read is lost, as on a line; the next client finds a fresh pty. */
static void forget_client(struct line *line)
{
    uint8_t bytes[1024];
    ssize_t length;
    struct termios settings;
    ioctl(line->slave, TIOCNXCL); /* a client's TIOCEXCL outlives it and would keep the next one out */
    if (tcgetattr(line->slave, &settings) == 0) {
        fresh_settings(&settings);
        tcsetattr(line->slave, TCSANOW, &settings);
    }
    tcflow(line->slave, TCOON);
    while ((length = read(line->slave, bytes, sizeof bytes)) > 0)
        line->dropped += (uint64_t)length;
    tcflush(line->fd, TCOFLUSH);    /* what is still on its way to the slave; what the client wrote stays */
    tcflush(line->slave, TCIFLUSH);
}

/* A client has come. It may already have made its own settings, so only what is not raw is touched. */
static void greet_client(struct line *line)
{
    struct termios settings;
    if (tcgetattr(line->slave, &settings) == 0 && line_make_raw(&settings))
        tcsetattr(line->slave, TCSANOW, &settings);
}

static void opened(struct line *line)
{
    line->clients++;
    if (line->clients == 1)
        greet_client(line);
    line->tell(line->context, line->clients == 1 ? LINE_ATTACHED : LINE_SHARED);
}

/* The last client has gone. */
static void deserted(struct line *line)
{
    line->clients = 0;
    forget_client(line);
    line->tell(line->context, LINE_DETACHED);
}

/* Who has closed the line is counted when it is certain whether anybody is left: two who have opened it at once give one notice.
 * But if all that are known have closed it, and then one opens it, they have gone. */
static void follow(struct line *line, uint32_t mask)
{
    if ((mask & IN_OPEN) && line->closings > 0 && line->closings >= line->clients) {
        line->closings = 0;
        deserted(line);
    }
    if (mask & IN_OPEN)
        opened(line);
    if ((mask & IN_CLOSE) && line->clients > 0)
        line->closings++;
}

static struct line *marked(const struct line_watch *watch, int mark)
{
    struct line *line = watch->lines;
    while (line && line->mark != mark)
        line = line->next;
    return line;
}

/* Read the notices that are waiting, and follow them, but not those of line `ignored`. Returns the number of the latter. */
static unsigned read_notices(struct line_watch *watch, const struct line *ignored)
{
    _Alignas(struct inotify_event) char buffer[4096];
    unsigned number = 0;
    ssize_t length;
    while ((length = read(watch->fd, buffer, sizeof buffer)) > 0) {
        for (ssize_t at = 0; at < length;) {
            const struct inotify_event *event = (const void *)(buffer + at);
            struct line *line = marked(watch, event->wd);
            if (event->mask & IN_Q_OVERFLOW)
                for (line = watch->lines; line; line = line->next)
                    line->doubtful = true;
            else if (line && line == ignored)
                number++;
            else if (line)
                follow(line, event->mask);
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
    return number;
}

/* Does anybody else have the slave open? Returns 1 or 0; -1: the slave is lost (reported). */
static int anybody_else(struct line *line)
{
    struct pollfd master = {.fd = line->fd};
    int exclusive = 0;
    /* TIOCEXCL would keep us out as well, unless we are root. */
    ioctl(line->slave, TIOCGEXCL, &exclusive);
    ioctl(line->slave, TIOCNXCL);
    close(line->slave);
    bool others = poll(&master, 1, 0) >= 0 && !(master.revents & POLLHUP);
    line->slave = open(line->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (line->slave < 0) {
        log_error("a client has locked the pty %s for good: %s; start the emulator again", line->path, strerror(errno));
        return -1;
    }
    if (others && exclusive)
        ioctl(line->slave, TIOCEXCL);
    return others;
}

void line_pty_count_again(struct line *line)
{
    int others = 0;
    /* Our own close and open give two notices; if there are more, somebody came or went meanwhile. */
    for (unsigned tries = 0, notices = 0; tries < COUNT_TRIES && notices != 2; tries++) {
        others = anybody_else(line);
        notices = read_notices(line->watch, line);
    }
    unsigned closings = line->closings;
    line->doubtful = false;
    line->closings = 0;
    if (others < 0)
        line->tell(line->context, LINE_FAILED);
    else if (others && line->clients == 0)
        opened(line);
    else if (others)
        line->clients = line->clients > closings ? line->clients - closings : 1;
    else if (line->clients > 0)
        deserted(line);
}

void line_watch_follow(struct line_watch *watch)
{
    read_notices(watch, NULL);
    for (struct line *line = watch->lines; line; line = line->next)
        if (line->doubtful || line->closings > 0)
            line_pty_count_again(line);
}

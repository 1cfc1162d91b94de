/* SPDX-License-Identifier: MIT */
/* The emulator's own pty. It holds one slave descriptor itself, so the master never reports a hang-up (which would make
 * poll() return at once, without end) and the settings stay within reach; inotify reports who opens and closes it.
 *
 * inotify merges equal notices that follow each other, so counting them may err when two clients come or go together. Hence
 * whether a client is left is looked up whenever one closes it: with our own slave closed for a moment, the master shows by a
 * hang-up whether another process has the slave open. Our own close and open give notices, too: our slave can only be read, and
 * notices of another kind stand around that of its opening, so that they are not merged with those of clients. A look with more
 * than our two notices is repeated, in the next turn of the loop if need be; and the system gives notice of a client that closes
 * the pty before it has closed it, so that the look may still find it. Hence a client that comes is called another one only if
 * it is certain that one is there: by the notice of its opening, or by looks for a second. A client that takes the pty for
 * itself (TIOCEXCL) while our slave is closed keeps us out until it has gone: then the line is without one, and the master's
 * hang-up is taken for nothing to read.
 *
 * Settings are as on a serial port: they outlive the client. The next client may open the pty and make its own settings at any
 * moment, and one tcsetattr() cannot be distinguished from another, so nothing that a client may have meant is ever reset. Only
 * a line that was left cooked is made raw again, and only while no notice of another client has come. */
#include "line.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "line_raw.h"
#include "log.h"

#define COUNT_TRIES 5
#define NOTICE_READS 16 /* at once, of 4 KiB each; the rest is read in the next turn */
#define UNREAD_READS 64 /* KiB; a pty holds less */
#define LOOK_MS 100 /* between two checks of a line that inotify does not watch, or that a client is closing */
#define LOOKS 10    /* until a client counts as one that stays: the system may take its time over closing */

/* Only to be read: then the notice of its end is another one than a client's, which is never merged with it. */
#define SLAVE_FLAGS (O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)

static bool set_flags(int fd)
{
    return fcntl(fd, F_SETFD, FD_CLOEXEC) == 0 && fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK) == 0;
}

/* The settings of a new pty: raw, 19200 baud, reads return what is there. */
static void set_initial_settings(struct termios *settings)
{
    line_make_raw(settings);
    cfsetspeed(settings, B19200);
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
}

/* ---- The watch ------------------------------------------------------------------------------------------------------ */

static void close_descriptor(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

static bool add_to_watch(struct line_watch *watch, int fd)
{
    struct epoll_event event = {.events = EPOLLIN};
    return fd >= 0 && epoll_ctl(watch->fd, EPOLL_CTL_ADD, fd, &event) == 0;
}

/* Returns false if it does not work (errno). */
static bool make_timer(struct line_watch *watch)
{
    if (watch->timer >= 0)
        return true;
    watch->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (add_to_watch(watch, watch->timer))
        return true;
    close_descriptor(&watch->timer);
    return false;
}

/* Check the lines now and then, or no more. Returns false if it does not work (errno). */
static bool set_polling(struct line_watch *watch, bool on)
{
    struct itimerspec spec = {0};
    if (watch->looking == on)
        return true;
    if (on)
        spec.it_interval.tv_nsec = spec.it_value.tv_nsec = LOOK_MS * 1000000L;
    if (!make_timer(watch))
        return false;
    watch->looking = timerfd_settime(watch->timer, 0, &spec, NULL) == 0 ? on : watch->looking;
    return watch->looking == on;
}

/* Notices before this and after it are not merged, and the loop has something to read: a watch that ends is a notice, too. */
static void divide_notices(const struct line_watch *watch)
{
    int mark = watch->notices >= 0 ? inotify_add_watch(watch->notices, "/", IN_DELETE_SELF) : -1;
    if (mark >= 0)
        inotify_rm_watch(watch->notices, mark);
}

bool line_watch_open(struct line_watch *watch)
{
    watch->lines = NULL;
    watch->timer = -1;
    watch->looking = false;
    watch->fd = epoll_create1(EPOLL_CLOEXEC);
    watch->notices = watch->fd < 0 ? -1 : inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    /* The timer at once: the number of the emulator's files does not change by what clients do. */
    if (watch->notices >= 0 && add_to_watch(watch, watch->notices) && make_timer(watch))
        return true;
    int why = errno;
    if (watch->fd >= 0 && set_polling(watch, true)) {
        log_error("cannot use inotify: %s (fs.inotify.max_user_instances?); checking every %d ms for clients", strerror(why),
                  LOOK_MS);
        return true;
    }
    log_error("cannot watch for clients of the bus: %s", strerror(errno));
    return false;
}

void line_watch_close(struct line_watch *watch)
{
    if (watch->fd < 0)
        return; /* it was never opened */
    close_descriptor(&watch->fd);
    close_descriptor(&watch->notices);
    close_descriptor(&watch->timer);
}

/* Have the new line watched. Returns false if it is not possible in any way (errno). */
static bool watch_line(struct line_watch *watch, struct line *line)
{
    if (watch->notices >= 0)
        line->mark = inotify_add_watch(watch->notices, line->path, IN_OPEN | IN_CLOSE);
    if (line->mark < 0 && watch->notices >= 0 && !watch->looking)
        log_error("inotify cannot watch %s: %s; checking every %d ms for clients", line->path,
                  errno == ENOSPC ? "too many watches in use (fs.inotify.max_user_watches)" : strerror(errno), LOOK_MS);
    return line->mark >= 0 || set_polling(watch, true);
}

bool line_pty_open(struct line *line, struct line_watch *watch, line_notify *notify, void *context)
{
    line_none(line);
    line->notify = notify;
    line->context = context;
    struct termios settings = {0};
    set_initial_settings(&settings);
    int writable;
    if (openpty(&line->fd, &writable, NULL, &settings, NULL) != 0) {
        log_error("cannot make a pty: %s%s", strerror(errno),
                  errno == ENOSPC                      ? "; too many ptys in use (kernel.pty.max)?"
                  : errno == EMFILE || errno == ENFILE ? "; `ulimit -n' allows more"
                                                       : "; is /dev/pts mounted?");
        return false;
    }
    int failed = ptsname_r(line->fd, line->path, sizeof line->path);
    line->slave = failed ? -1 : ioctl(line->fd, TIOCGPTPEER, SLAVE_FLAGS);
    int why = errno;
    close(writable);
    errno = why;
    if (line->slave < 0 || !set_flags(line->fd) || !watch_line(watch, line)) {
        log_error("cannot use the pty %s: %s", line->path, strerror(failed ? failed : errno));
        line_close(line);
        return false;
    }
    line->watch = watch;
    line->next = watch->lines;
    watch->lines = line;
    return true;
}

/* ---- Who comes and goes --------------------------------------------------------------------------------------------- */

/* There is no client any more: what the unit sent and no client has read is lost, as on a line. */
static void drop_unread(struct line *line)
{
    uint8_t bytes[1024];
    ssize_t length;
    if (line->slave < 0)
        return;
    tcflow(line->slave, TCOON);
    for (unsigned i = 0; i < UNREAD_READS && (length = read(line->slave, bytes, sizeof bytes)) > 0; i++)
        line->dropped += (uint64_t)length;
    tcflush(line->fd, TCOFLUSH);    /* what is still on its way to the slave; what the client wrote stays */
    tcflush(line->slave, TCIFLUSH);
}

/* One that is known but not for certain may have gone: then the one that comes is not another one. */
static void count_opened(struct line *line)
{
    bool first = line->clients == 0, another = !first && line->certain;
    line->clients += first || another;
    line->certain = !line->doubtful;
    line->looks = 0;
    line->left = false;
    if (first || another)
        line->notify(line->context, first ? LINE_ATTACHED : LINE_SHARED);
}

/* The last client has gone. */
static void report_detached(struct line *line)
{
    line->clients = line->looks = 0;
    line->certain = false;
    line->left = true;
    drop_unread(line);
    line->notify(line->context, LINE_DETACHED);
}

/* Who has closed the line is counted when it is certain whether anybody is left: two who have opened it at once give one notice.
 * But if all that are known have closed it, and then one opens it, they have gone. */
static void handle_notice(struct line *line, uint32_t mask)
{
    if ((mask & IN_OPEN) && line->closings > 0 && line->closings >= line->clients) {
        line->closings = 0;
        report_detached(line);
    }
    if (mask & IN_OPEN)
        count_opened(line);
    if (!(mask & IN_CLOSE))
        return;
    line->certain = false;
    if (line->clients > 0)
        line->closings++;
    else
        line->doubtful = line->left = true; /* by one who was not known: may have left anything */
}

static struct line *find_by_mark(const struct line_watch *watch, int mark)
{
    struct line *line = watch->lines;
    while (line && line->mark != mark)
        line = line->next;
    return line;
}

/* Notices of one line. */
struct notices {
    unsigned all, opens;
};

/* Read the notices that are waiting, and follow them, but not those of line `ignored`, which are counted. Returns whether that
 * were all. */
static bool read_notices(struct line_watch *watch, const struct line *ignored, struct notices *counted)
{
    _Alignas(struct inotify_event) char buffer[4096];
    ssize_t length = 0;
    for (unsigned i = 0; i < NOTICE_READS && (length = read(watch->notices, buffer, sizeof buffer)) > 0; i++) {
        for (ssize_t at = 0; at < length;) {
            const struct inotify_event *event = (const void *)(buffer + at);
            struct line *line = event->wd >= 0 ? find_by_mark(watch, event->wd) : NULL;
            if (event->mask & IN_Q_OVERFLOW) {
                for (line = watch->lines; line; line = line->next) {
                    line->doubtful = true;
                    line->certain = false;
                }
            } else if (line && line == ignored) {
                counted->all++;
                counted->opens += (event->mask & IN_OPEN) != 0;
            } else if (line) {
                handle_notice(line, event->mask);
            }
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
    return length < 0;
}

static bool is_hung_up(const struct line *line)
{
    struct pollfd master = {.fd = line->fd};
    return poll(&master, 1, 0) > 0 && (master.revents & POLLHUP);
}

/* Does anybody else have the slave open? Returns 1 or 0; -1: our own slave cannot be had any more, and there is no other
 * client. */
static int check_other_clients(struct line *line)
{
    if (line->slave >= 0)
        close(line->slave);
    for (unsigned tries = 0; tries < COUNT_TRIES; tries++) {
        bool others = !is_hung_up(line);
        divide_notices(line->watch);
        line->slave = open(line->path, SLAVE_FLAGS);
        divide_notices(line->watch);
        if (line->slave >= 0)
            return others;
        if (!is_hung_up(line))
            return 1; /* and keeps us out */
    }
    return -1;
}

/* Was the check of the line undisturbed? Our own close and open give a notice each; if there are more, a client came or went
 * meanwhile. A client that keeps us out came, at most. `closed`: times that we have closed our slave. */
static bool is_undisturbed(const struct line *line, const struct notices *notices, unsigned closed)
{
    if (line->mark < 0)
        return true; /* there are none */
    return line->slave >= 0 ? notices->all == closed + 1 : notices->all - notices->opens == closed;
}

/* A client has the pty for itself, or has left it so. Then only root could open it since, and of a client that was alone
 * the notices are enough: to look would let the next one lock us out. One that opened it together with the one that locked it,
 * so that there was one notice, is found when it sends. Returns true if they were enough. */
static bool count_exclusive(struct line *line)
{
    int exclusive = 0;
    if (line->slave < 0 || ioctl(line->slave, TIOCGEXCL, &exclusive) != 0 || !exclusive)
        return false;
    bool known = line->mark >= 0 && !line->doubtful && line->closings > 0 && line->clients == 1;
    read_notices(line->watch, NULL, NULL); /* whose it is may have come after the others had gone */
    if (known && !line->doubtful && line->closings == 0)
        return true; /* they had, see handle_notice() */
    ioctl(line->slave, TIOCNXCL); /* would keep out the next client, and us */
    if (!known || line->doubtful)
        return false;
    line->closings = 0;
    report_detached(line);
    return true;
}

/* There seems to be a client: the system gives notice of a client that closes the line before it has closed it.
 * `closing`: there were such notices. Certain is only who is still there after more looks. */
static void schedule_checks(struct line *line, bool closing)
{
    if (line->mark < 0 || (line->certain && !closing && !line->doubtful))
        return;
    line->certain = false;
    if (closing || line->doubtful || line->looks == 0)
        line->looks = LOOKS;
    set_polling(line->watch, true);
}

void line_pty_recount(struct line *line)
{
    int others = 0;
    unsigned reopened = 0, closed = 0;
    struct notices counted = {0};
    bool undisturbed = false;
    read_notices(line->watch, NULL, NULL);
    if (count_exclusive(line))
        return;
    for (unsigned tries = 0; tries < COUNT_TRIES && !undisturbed; tries++) {
        struct notices one = {0};
        bool had_slave = line->slave >= 0;
        others = check_other_clients(line);
        reopened += line->slave >= 0;
        closed += had_slave;
        undisturbed = read_notices(line->watch, line, &one) && is_undisturbed(line, &one, had_slave);
        counted.opens += one.opens;
        counted.all += one.all;
    }
    unsigned closings = line->closings;
    bool somebody_came = counted.opens > reopened;
    line->doubtful = !undisturbed;
    if (!undisturbed)
        divide_notices(line->watch); /* look again in the next turn */
    line->closings = 0;
    line->left = line->left || (!others && somebody_came);
    if (others < 0) {
        line->notify(line->context, LINE_FAILED);
        return;
    }
    if (line->clients > 0 && (!others || (closings >= line->clients && somebody_came)))
        report_detached(line);
    if (others && line->clients == 0) {
        count_opened(line);
        line->certain = false;
    } else if (others) {
        line->clients = line->clients > closings ? line->clients - closings : 1;
    }
    if (others)
        schedule_checks(line, closings > 0 || counted.all - counted.opens > closed);
}

/* A client that has gone may have left the line cooked. Made raw as long as no client has come that might have meant it. */
static void make_raw_again(struct line *line)
{
    struct termios settings;
    int waiting = 0;
    if (line->slave < 0 || tcgetattr(line->slave, &settings) != 0)
        return;
    if (line_is_cooked(&settings)) {
        line_make_uncooked(&settings);
        if (line->watch->notices >= 0 && (ioctl(line->watch->notices, FIONREAD, &waiting) != 0 || waiting > 0))
            return; /* of this line or another: they are read first */
        tcsetattr(line->slave, TCSANOW, &settings);
    }
    line->left = false;
}

void line_watch_update(struct line_watch *watch)
{
    uint64_t expired;
    bool look = watch->timer >= 0 && read(watch->timer, &expired, sizeof expired) > 0, later = watch->notices < 0;
    read_notices(watch, NULL, NULL);
    for (struct line *line = watch->lines, *next; line; line = next) {
        next = line->next;
        if (line->doubtful || line->closings > 0 || line->slave < 0 || (look && (line->mark < 0 || line->looks > 0)))
            line_pty_recount(line);
        if (look && line->looks > 0)
            line->certain = --line->looks == 0;
        if (line->mark < 0)
            line->left = look && line->clients == 0; /* maybe by one who came and went between two looks */
        if (line->left)
            make_raw_again(line);
        later = later || line->mark < 0 || line->looks > 0;
    }
    set_polling(watch, later);
}

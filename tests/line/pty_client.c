/* SPDX-License-Identifier: MIT */
/* pty_client.c: a client of a pty that opens, asks, closes and opens again at once, many times: pty_client HOW PATH TIMES
 *
 *     exclusive   it has the pty for itself while it is there (TIOCEXCL, TIOCNXCL)
 *     careless    likewise, and leaves it so: the next one, which is itself, tries until it gets in
 *     settings    it makes settings of its own, which have to be there at the end of the session
 *
 * Between two sessions there are 0 to 299 us, a different time after each: the emulator is met in all it does after a client.
 *
 * Exit status: 0 every session was as it should be; 1 one was not (said); 2 usage. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define LIMIT_MS 30000 /* until an answer counts as never coming */

static const uint8_t request[] = {0x7e, 0x01, 0x00, 0x08, 0x58, 0x10, 0x7e}; /* message 8 to unit 1, which does not know it */
static const uint8_t wanted[] = {0x7e, 0x00, 0x01, 0xff, 0x08, 0x00, 0x00, 0xdb, 0xff, 0x7e};

static bool wrong(const char *what, int error)
{
    printf("%s%s%s\n", what, error ? ": " : "", error ? strerror(error) : "");
    return false;
}

/* Open the pty. `patient`: what the client before has left behind may keep us out for a moment. */
static int open_pty(const char *path, bool patient)
{
    struct timespec begun, now;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    do {
        int fd = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
        if (fd >= 0 || !patient || (errno != EBUSY && errno != ENOENT))
            return fd;
        clock_gettime(CLOCK_MONOTONIC, &now);
    } while ((now.tv_sec - begun.tv_sec) * 1000 < LIMIT_MS);
    return -1;
}

static bool ask(int fd)
{
    uint8_t answer[sizeof wanted];
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    if (write(fd, request, sizeof request) != sizeof request)
        return wrong("write", errno);
    for (size_t had = 0; had < sizeof answer;) {
        if (poll(&ready, 1, LIMIT_MS) <= 0)
            return wrong("no answer", 0);
        ssize_t length = read(fd, answer + had, sizeof answer - had);
        if (length <= 0)
            return wrong("read", length < 0 ? errno : 0);
        had += (size_t)length;
    }
    return memcmp(answer, wanted, sizeof wanted) == 0 || wrong("another answer", 0);
}

static bool session_exclusive(int fd, unsigned number, bool careless)
{
    (void)number;
    if (ioctl(fd, TIOCEXCL) != 0)
        return wrong("TIOCEXCL", errno);
    if (!ask(fd))
        return false;
    return careless || ioctl(fd, TIOCNXCL) == 0 || wrong("TIOCNXCL", errno);
}

static bool same(const struct termios *a, const struct termios *b)
{
    return a->c_iflag == b->c_iflag && a->c_oflag == b->c_oflag && a->c_lflag == b->c_lflag && a->c_cflag == b->c_cflag &&
           a->c_cc[VMIN] == b->c_cc[VMIN] && a->c_cc[VTIME] == b->c_cc[VTIME] && cfgetospeed(a) == cfgetospeed(b);
}

/* Each session has other settings than the one before. */
static bool session_settings(int fd, unsigned number)
{
    struct termios ours, found;
    memset(&ours, 0, sizeof ours);
    if (tcgetattr(fd, &ours) != 0)
        return wrong("tcgetattr", errno);
    cfmakeraw(&ours);
    ours.c_cflag |= CLOCAL | CREAD;
    ours.c_cflag = number % 3 == 0 ? ours.c_cflag | CSTOPB : ours.c_cflag & ~(tcflag_t)CSTOPB;
    ours.c_cc[VMIN] = 0;
    ours.c_cc[VTIME] = (cc_t)(20 + number % 100);
    cfsetspeed(&ours, number % 2 ? B9600 : B38400);
    if (tcsetattr(fd, TCSANOW, &ours) != 0)
        return wrong("tcsetattr", errno);
    if (!ask(fd))
        return false;
    if (tcgetattr(fd, &found) != 0)
        return wrong("tcgetattr", errno);
    return same(&ours, &found) || wrong("the settings are not those that were made", 0);
}

/* Busy: a sleep would last longer. */
static void wait_us(unsigned us)
{
    struct timespec begun, now;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    do
        clock_gettime(CLOCK_MONOTONIC, &now);
    while ((now.tv_sec - begun.tv_sec) * 1000000 + (now.tv_nsec - begun.tv_nsec) / 1000 < (long)us);
}

int main(int argc, char **argv)
{
    const char *how = argc == 4 ? argv[1] : "";
    bool careless = strcmp(how, "careless") == 0, settings = strcmp(how, "settings") == 0;
    if (!careless && !settings && strcmp(how, "exclusive") != 0) {
        fputs("usage: pty_client exclusive|careless|settings PATH TIMES\n", stderr);
        return 2;
    }
    unsigned times = (unsigned)atoi(argv[3]), bad = 0;
    for (unsigned i = 0; i < times; i++) {
        int fd = open_pty(argv[2], careless);
        if (fd < 0) {
            printf("time %u: cannot open: %s\n", i + 1, strerror(errno));
            return 1;
        }
        if (!(settings ? session_settings(fd, i) : session_exclusive(fd, i, careless)))
            bad++;
        close(fd);
        wait_us(i % 2 ? i * 7u % 300u : 0);
    }
    printf("%u of %u\n", times - bad, times);
    return bad > 0;
}

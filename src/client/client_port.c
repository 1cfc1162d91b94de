/* SPDX-License-Identifier: MIT */
#include "client_port.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "client_report.h"
#include "options/options.h"
#include "text/text.h"

#define TCP "tcp:"
#define LOCK_RETRY_MS 10

uint64_t client_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

/* ---- Terminals ---------------------------------------------------------------------------------------------------- */

static const char *open_advice(int error)
{
    switch (error) {
    case EACCES:
        return "; is your user in the group dialout?";
    case ENOENT:
        return "; is the adapter plugged in, or the emulator running?";
    case EBUSY:
        return "; another program has locked it";
    case EIO:
    case ENXIO:
        return "; the program at its other end has ended";
    default:
        return "";
    }
}

/* Two clients at once would take each other's answers: wait for the other one to finish. */
static bool lock_terminal(int fd, unsigned timeout_ms)
{
    uint64_t end = client_now() + (uint64_t)timeout_ms * 1000u;
    while (flock(fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno != EWOULDBLOCK || client_now() >= end)
            return errno != EWOULDBLOCK; /* what cannot be locked is used without */
        poll(NULL, 0, LOCK_RETRY_MS);
    }
    return true;
}

static bool make_raw(int fd)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0)
        return false;
    cfmakeraw(&settings);
    settings.c_cflag &= ~(tcflag_t)(CSTOPB | CRTSCTS);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    return cfsetspeed(&settings, B19200) == 0 && tcsetattr(fd, TCSANOW, &settings) == 0;
}

static bool set_up_terminal(int fd, const char *path, unsigned timeout_ms)
{
    if (!isatty(fd)) {
        client_report("%s is not a serial device: expected one like " CLIENT_PORT_EXAMPLE ", a pseudo terminal, or tcp:HOST:PORT",
                      path);
        return false;
    }
    if (!lock_terminal(fd, timeout_ms)) {
        client_report("%s is in use by another program: end that program, or wait for it with a longer --timeout", path);
        return false;
    }
    if (!make_raw(fd)) {
        client_report("cannot set %s to 19200 baud, 8N1: %s", path, strerror(errno));
        return false;
    }
    tcflush(fd, TCIFLUSH);
    return true;
}

static int open_terminal(const char *path, unsigned timeout_ms)
{
    int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        client_report("cannot open %s: %s%s", path, strerror(errno), open_advice(errno));
        return -1;
    }
    if (set_up_terminal(fd, path, timeout_ms))
        return fd;
    close(fd);
    return -1;
}

/* ---- TCP ---------------------------------------------------------------------------------------------------------- */

/* Connect within the time limit. Returns a descriptor, or -1 and errno. */
static int connect_to(const struct addrinfo *address, unsigned timeout_ms)
{
    int error = 0, one = 1;
    socklen_t size = sizeof error;
    int fd = socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address->ai_protocol);
    if (fd < 0)
        return -1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    struct pollfd ready = {.fd = fd, .events = POLLOUT};
    if (connect(fd, address->ai_addr, address->ai_addrlen) == 0)
        return fd;
    if (errno != EINPROGRESS)
        error = errno;
    else if (poll(&ready, 1, (int)timeout_ms) <= 0)
        error = ETIMEDOUT;
    else if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
        error = errno;
    if (error == 0)
        return fd;
    close(fd);
    errno = error;
    return -1;
}

/* Where the last colon of tcp:HOST:PORT is; NULL: not of that form. */
static const char *find_service(const char *port)
{
    const char *host = port + strlen(TCP);
    const char *colon = strrchr(host, ':');
    uint64_t number;
    return colon != NULL && colon > host && number_read(colon + 1, 1, UINT16_MAX, &number) ? colon : NULL;
}

static int open_tcp(const char *port, unsigned timeout_ms)
{
    struct addrinfo *list = NULL;
    const char *name = port + strlen(TCP), *colon = find_service(port);
    bool bracketed = name[0] == '[' && colon[-1] == ']';
    char *host = strndup(name + bracketed, (size_t)(colon - name) - 2u * bracketed);
    const char *wrong = host != NULL ? host_address_find(host, colon + 1, AF_UNSPEC, timeout_ms, &list) : strerror(ENOMEM);
    free(host);
    if (wrong != NULL) {
        client_report("cannot find %s: %s", port, wrong);
        return -1;
    }
    int fd = -1;
    for (const struct addrinfo *address = list; address != NULL && fd < 0; address = address->ai_next)
        fd = connect_to(address, timeout_ms);
    if (fd < 0)
        client_report("cannot connect to %s: %s", port, strerror(errno));
    freeaddrinfo(list);
    return fd;
}

bool client_port_valid(const char *port)
{
    return strncmp(port, TCP, strlen(TCP)) != 0 || find_service(port) != NULL;
}

int client_port_open(const char *port, unsigned timeout_ms)
{
    return strncmp(port, TCP, strlen(TCP)) == 0 ? open_tcp(port, timeout_ms) : open_terminal(port, timeout_ms);
}

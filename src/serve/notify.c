/* SPDX-License-Identifier: MIT */
#include "notify.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "line/line.h"
#include "text/text.h"

#define FD_FIRST 3 /* those below are stdin, stdout (which has the line anyway) and stderr */
#define FD_LAST 1048575

/* ---- The service manager -------------------------------------------------------------------------------------------- */

/* Turn the value of $NOTIFY_SOCKET into an address: a path, or "@name" for one without a file. Returns its length, 0: none. */
static socklen_t read_address(struct sockaddr_un *address, const char *text)
{
    size_t length = strlen(text);
    *address = (struct sockaddr_un){.sun_family = AF_UNIX};
    if ((text[0] != '/' && text[0] != '@') || length < 2 || length >= sizeof address->sun_path)
        return 0;
    memcpy(address->sun_path, text, length);
    if (text[0] == '@') {
        address->sun_path[0] = '\0';
        return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    }
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length + 1);
}

/* Send one datagram. Returns false with errno. */
static bool send_to(const struct sockaddr_un *address, socklen_t length, const char *text)
{
    int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return false;
    bool sent = sendto(fd, text, strlen(text), MSG_NOSIGNAL, (const struct sockaddr *)address, length) >= 0;
    int why = errno;
    close(fd);
    errno = why;
    return sent;
}

static void notify_manager(const char *state)
{
    struct sockaddr_un address;
    const char *text = getenv("NOTIFY_SOCKET");
    if (!text || !*text)
        return;
    socklen_t length = read_address(&address, text);
    if (length == 0)
        log_error("cannot notify the service manager: NOTIFY_SOCKET is `%s': expected a path from / or a name after @", text);
    else if (!send_to(&address, length, state))
        log_error("cannot notify the service manager at NOTIFY_SOCKET=%s: %s", text, strerror(errno));
}

/* ---- A file descriptor ---------------------------------------------------------------------------------------------- */

int notify_fd_read(const char *text)
{
    uint64_t fd;
    if (!number_read(text, FD_FIRST, FD_LAST, &fd))
        return -1;
    int flags = fcntl((int)fd, F_GETFL), more = fcntl((int)fd, F_GETFD);
    if (flags < 0 || more < 0 || (flags & O_ACCMODE) == O_RDONLY || (flags & O_PATH))
        return -1;
    fcntl((int)fd, F_SETFD, more | FD_CLOEXEC);
    return (int)fd;
}

static bool write_ready_fd(int fd, const char *text)
{
    struct delivery *delivery = delivery_begin(fd, text, true);
    int error = delivery ? delivery_wait(delivery, NOTIFY_WAIT_MS) : ENOMEM;
    if (error != 0)
        log_error("--ready-fd: cannot write the READY line to %d: %s", fd, strerror(error));
    return error == 0;
}

/* ---- Both ----------------------------------------------------------------------------------------------------------- */

bool notify_ready(int fd, const char *text, const char *status)
{
    char state[1024] = "READY=1";
    if (status)
        snprintf(state, sizeof state, "READY=1\nSTATUS=%.*s", (int)strcspn(status, "\n"), status);
    notify_manager(state);
    return fd < 0 || write_ready_fd(fd, text);
}

void notify_stopping(void)
{
    notify_manager("STOPPING=1");
}

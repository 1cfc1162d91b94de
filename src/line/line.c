/* SPDX-License-Identifier: MIT */
#include "line.h"

#include <errno.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <unistd.h>

ssize_t line_read(struct line *line, uint8_t *bytes, size_t room)
{
    errno = 0;
    ssize_t length = read(line->fd, bytes, room);
    if (length > 0)
        return length;
    if (length < 0 && errno == EIO && line->watch && line->slave < 0)
        return 0; /* a pty without a client, closed by us, too (line_pty.c) */
    return length < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

size_t line_write(struct line *line, const uint8_t *bytes, size_t length)
{
    size_t done = 0;
    if (line->toggles && !line->raised && length > 0)
        line->raised = ioctl(line->fd, TIOCMBIS, &(int){TIOCM_RTS}) == 0;
    while (line->clients > 0 && done < length) {
        ssize_t sent = write(line->fd, bytes + done, length - done);
        if (sent > 0)
            done += (size_t)sent;
        else if (sent == 0 || errno != EINTR)
            break;
    }
    line->dropped += length - done;
    return length - done;
}

void line_none(struct line *line)
{
    *line = (struct line){.fd = -1, .slave = -1, .mark = -1};
}

void line_close(struct line *line)
{
    line_serial_restore(line);
    int *fds[] = {&line->slave, &line->fd};
    if (line->watch && line->mark >= 0)
        inotify_rm_watch(line->watch->notices, line->mark);
    for (struct line **at = line->watch ? &line->watch->lines : NULL; at && *at; at = &(*at)->next) {
        if (*at == line) {
            *at = line->next;
            break;
        }
    }
    line->watch = NULL;
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; i++) {
        if (*fds[i] >= 0)
            close(*fds[i]);
        *fds[i] = -1;
    }
}

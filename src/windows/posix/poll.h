/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_POLL_H
#define RKM04_WINDOWS_POLL_H

#define POLLIN 1

struct pollfd {
    int fd;
    short events, revents;
};

/* Of one descriptor, a pipe or a file, without waiting. */
int poll(struct pollfd *fds, unsigned long count, int timeout);

#endif

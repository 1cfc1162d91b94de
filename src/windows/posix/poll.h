/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_POLL_H
#define RKM04_WINDOWS_POLL_H

#define POLLIN 1
#define POLLOUT 4

struct pollfd {
    int fd;
    short events, revents;
};

/* Of the port that rkmctl has open, and of nothing else, for a time; or of standard input, without waiting. */
int poll(struct pollfd *fds, unsigned long count, int timeout);

#endif

/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_POLL_H
#define RKM04_WINDOWS_POLL_H

#define POLLIN 1
#define POLLOUT 4

struct pollfd {
    int fd;
    short events, revents;
};

/* For a time of the port that rkmctl has open, with the flag that ends it (port.h); of standard input, without waiting. */
int poll(struct pollfd *fds, unsigned long count, int timeout);

#endif

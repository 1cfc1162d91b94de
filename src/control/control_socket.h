/* SPDX-License-Identifier: MIT */
/* control_socket.h: a Unix stream socket that listens under a path, for its owner alone.
 *
 * Beside it lies PATH.lock, locked as long as the emulator runs; it says which socket is ours. Nothing else is ever removed, and
 * no link is followed in the last part of the path. */
#ifndef RKM04_CONTROL_SOCKET_H
#define RKM04_CONTROL_SOCKET_H

#include <limits.h>
#include <stdbool.h>
#include <sys/types.h>

struct control_socket {
    char path[PATH_MAX], lock_path[PATH_MAX];
    int lock;    /* -1: not claimed */
    int fd;      /* -1: none, or given away */
    dev_t device; /* of the socket that we made; both 0: none */
    ino_t inode;
};

/* Make the socket `path`; it does not listen yet. Failures are reported with advice. Returns false if it did not work: then
 * nothing is left behind. */
bool control_socket_open(struct control_socket *socket, const char *path);

/* Remove what is ours and give the lock free; `fd` is not closed. One that was never opened, or is released, is left alone. */
void control_socket_release(struct control_socket *socket);

#endif

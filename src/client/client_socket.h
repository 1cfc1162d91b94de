/* SPDX-License-Identifier: MIT */
/* client_socket.h: a connection to an emulator on this machine: to its Unix socket, or over TCP. src/windows has another one. */
#ifndef RKM04_CLIENT_SOCKET_H
#define RKM04_CLIENT_SOCKET_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* The folders of default links, from 0 on. Returns false if there are no more of them. */
bool client_socket_folder(unsigned number, char folder[PATH_MAX]);

/* Connect to the Unix socket `path`, or to `address`, 127.0.0.1:PORT or [::1]:PORT, within 10 s. Return a descriptor; -1: errno
 * says why. */
int client_socket_open(const char *path);
int client_socket_open_tcp(const char *address);

/* Is it an emulator of another user, at a Unix socket? */
bool client_socket_is_foreign(int fd);

/* Is the file that `fd` has open another user's? */
bool client_socket_is_foreign_file(int fd);

/* Wait for bytes, up to `timeout_ms` (-1: without limit). Returns false if none have come. */
bool client_socket_wait(int fd, int timeout_ms);

/* Wait for room to write to, as long. */
void client_socket_wait_room(int fd, int timeout_ms);

/* As read() and send(): no signal if the other end has gone. Writing does not wait: errno is EAGAIN if there is no room. */
ssize_t client_socket_read(int fd, char *bytes, size_t room);
ssize_t client_socket_write(int fd, const char *bytes, size_t length);
void client_socket_close(int fd);

#endif

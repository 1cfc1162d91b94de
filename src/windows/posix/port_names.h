/* SPDX-License-Identifier: MIT */
/* port_names.h: included before the files of the client that read and write its port, which has no descriptor here (port.c). */
#ifndef RKM04_WINDOWS_PORT_NAMES_H
#define RKM04_WINDOWS_PORT_NAMES_H

#include <posix.h>

ssize_t windows_port_read(int fd, void *bytes, size_t room);
ssize_t windows_port_write(int fd, const void *bytes, size_t length);
int windows_port_close(int fd);

#define read windows_port_read
#define write windows_port_write
#define close windows_port_close

#endif

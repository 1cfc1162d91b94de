/* SPDX-License-Identifier: MIT */
#include "net_socket.h"

#include <errno.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

static int descriptor(const uv_tcp_t *tcp)
{
    int fd;
    return uv_fileno((const uv_handle_t *)tcp, &fd) == 0 ? fd : -1;
}

void net_socket_prepare_listener(uv_tcp_t *listener)
{
    (void)listener;
}

size_t net_socket_waiting(const uv_tcp_t *tcp)
{
    int fd = descriptor(tcp), waiting = 0;
    return fd >= 0 && ioctl(fd, FIONREAD, &waiting) == 0 && waiting > 0 ? (size_t)waiting : 0;
}

bool net_socket_has_ended(const uv_tcp_t *tcp)
{
    struct pollfd end = {.fd = descriptor(tcp), .events = POLLRDHUP};
    return end.fd >= 0 && poll(&end, 1, 0) > 0;
}

ssize_t net_socket_read(const uv_tcp_t *tcp, uint8_t *bytes, size_t room)
{
    ssize_t length = recv(descriptor(tcp), bytes, room, MSG_DONTWAIT);
    return length < 0 && errno == EAGAIN ? 0 : length;
}

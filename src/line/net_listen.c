/* SPDX-License-Identifier: MIT */
#include "net_listen.h"

#include "net_socket.h"

#define BACKLOG 128 /* connections that the system keeps until the next turn of the loop */

const char *net_listen(uv_tcp_t *listener, const char *address, uv_connection_cb on_connection, char real[NET_NAME_SIZE])
{
    struct sockaddr_storage at = {0};
    int size = sizeof at;
    const char *wrong = net_address_read(address, &at);
    if (wrong)
        return wrong;
    net_socket_prepare_listener(listener);
    int error = uv_tcp_bind(listener, (const struct sockaddr *)&at, 0);
    if (error == 0)
        error = uv_listen((uv_stream_t *)listener, BACKLOG, on_connection);
    if (error == 0)
        error = uv_tcp_getsockname(listener, (struct sockaddr *)&at, &size);
    if (error == UV_EADDRINUSE)
        return "another program listens there; port 0 takes a free one";
    if (error != 0)
        return uv_strerror(error);
    net_address_write(real, &at);
    return NULL;
}

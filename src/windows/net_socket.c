/* SPDX-License-Identifier: MIT */
/* net_socket.c: sockets before libuv reads them. libuv asks for nothing but the notice that bytes have come, so that they can be
 * read here. */
#include <uv.h>

#include <iphlpapi.h>

#include "line/net_socket.h"

#define SPARE_SIZE 4096u /* for connections that come between two calls */

static SOCKET socket_of(const uv_tcp_t *tcp)
{
    uv_os_fd_t handle;
    return uv_fileno((const uv_handle_t *)tcp, &handle) == 0 ? (SOCKET)handle : INVALID_SOCKET;
}

/* libuv has 32 sockets ready for each listener otherwise, which must all be closed at the end: several seconds with 256 buses. */
void net_socket_prepare_listener(uv_tcp_t *listener)
{
    uv_tcp_simultaneous_accepts(listener, 0);
}

size_t net_socket_waiting(const uv_tcp_t *tcp)
{
    u_long waiting = 0;
    return ioctlsocket(socket_of(tcp), FIONREAD, &waiting) == 0 ? waiting : 0;
}

/* The state of a connection in the table of the system. 0: it is not there. */
static DWORD find_state(const struct sockaddr_in *own, const struct sockaddr_in *other)
{
    DWORD size = 0, state = 0;
    MIB_TCPTABLE *table = NULL;
    while (GetTcpTable(table, &size, FALSE) == ERROR_INSUFFICIENT_BUFFER) {
        free(table);
        size += SPARE_SIZE;
        table = malloc(size);
        if (!table)
            return 0;
    }
    for (DWORD i = 0; table && i < table->dwNumEntries; i++) {
        const MIB_TCPROW *row = &table->table[i];
        if (row->dwLocalAddr == own->sin_addr.s_addr && (u_short)row->dwLocalPort == own->sin_port &&
            row->dwRemoteAddr == other->sin_addr.s_addr && (u_short)row->dwRemotePort == other->sin_port)
            state = row->dwState;
    }
    free(table);
    return state;
}

static DWORD find_state6(const struct sockaddr_in6 *own, const struct sockaddr_in6 *other)
{
    DWORD size = 0, state = 0;
    MIB_TCP6TABLE *table = NULL;
    while (GetTcp6Table(table, &size, FALSE) == ERROR_INSUFFICIENT_BUFFER) {
        free(table);
        size += SPARE_SIZE;
        table = malloc(size);
        if (!table)
            return 0;
    }
    for (DWORD i = 0; table && i < table->dwNumEntries; i++) {
        const MIB_TCP6ROW *row = &table->table[i];
        if (memcmp(&row->LocalAddr, &own->sin6_addr, sizeof row->LocalAddr) == 0 && (u_short)row->dwLocalPort == own->sin6_port &&
            memcmp(&row->RemoteAddr, &other->sin6_addr, sizeof row->RemoteAddr) == 0 &&
            (u_short)row->dwRemotePort == other->sin6_port)
            state = (DWORD)row->State;
    }
    free(table);
    return state;
}

/* Not all systems report an end behind bytes that wait; the table of connections has it. */
bool net_socket_has_ended(const uv_tcp_t *tcp)
{
    WSAPOLLFD end = {.fd = socket_of(tcp), .events = POLLRDNORM};
    struct sockaddr_storage own = {0}, other = {0};
    int size = sizeof own, other_size = sizeof other;
    if (end.fd == INVALID_SOCKET || WSAPoll(&end, 1, 0) <= 0)
        return false;
    if ((end.revents & (POLLHUP | POLLERR)) != 0 || getsockname(end.fd, (struct sockaddr *)&own, &size) != 0 ||
        getpeername(end.fd, (struct sockaddr *)&other, &other_size) != 0)
        return true;
    DWORD state = own.ss_family == AF_INET6 ? find_state6((const void *)&own, (const void *)&other)
                                            : find_state((const void *)&own, (const void *)&other);
    return state == MIB_TCP_STATE_CLOSE_WAIT;
}

ssize_t net_socket_read(const uv_tcp_t *tcp, uint8_t *bytes, size_t room)
{
    SOCKET from = socket_of(tcp);
    WSAPOLLFD look = {.fd = from, .events = POLLRDNORM};
    if (from == INVALID_SOCKET || WSAPoll(&look, 1, 0) <= 0)
        return 0;
    int length = recv(from, (char *)bytes, (int)room, 0);
    return length >= 0 ? length : WSAGetLastError() == WSAEWOULDBLOCK ? 0 : -1;
}

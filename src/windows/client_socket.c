/* SPDX-License-Identifier: MIT */
/* client_socket.c: connections to emulators, over TCP alone. A SOCKET fits an int: handles have 32 bits. */
#include "client/client_socket.h"

#include <errno.h>
#include <ws2tcpip.h>

#include "text/text.h"

bool client_socket_folder(unsigned number, char folder[PATH_MAX])
{
    const char *own = getenv("LOCALAPPDATA");
    if (number > 0 || own == NULL || snprintf(folder, PATH_MAX, "%s/rkm04", own) >= PATH_MAX)
        return false;
    for (char *at = folder; *at != '\0'; at++)
        *at = *at == '\\' ? '/' : *at;
    return true;
}

int client_socket_open(const char *path)
{
    errno = GetFileAttributesA(path) == INVALID_FILE_ATTRIBUTES ? ENOENT : ECONNREFUSED;
    return -1;
}

static int connect_to(const char *host, const char *port)
{
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV}, *found = NULL;
    WSADATA data;
    BOOL on = TRUE;
    u_long no_wait = 1;
    errno = EINVAL;
    if (WSAStartup(MAKEWORD(2, 2), &data) != 0 || getaddrinfo(host, port, &hints, &found) != 0)
        return -1;
    SOCKET made = socket(found->ai_family, SOCK_STREAM, 0);
    errno = ECONNREFUSED;
    if (made != INVALID_SOCKET && connect(made, found->ai_addr, (int)found->ai_addrlen) != 0) {
        closesocket(made);
        made = INVALID_SOCKET;
    }
    freeaddrinfo(found);
    if (made != INVALID_SOCKET)
        ioctlsocket(made, (long)FIONBIO, &no_wait); /* what comes is waited for */
    if (made != INVALID_SOCKET)
        setsockopt(made, IPPROTO_TCP, TCP_NODELAY, (const char *)&on, sizeof on);
    return made != INVALID_SOCKET ? (int)made : -1;
}

int client_socket_open_tcp(const char *address)
{
    const char *colon = strrchr(address, ':');
    char host[64];
    size_t length = colon != NULL ? (size_t)(colon - address) : 0;
    bool is_six = strncmp(address, "[::1]:", 6) == 0;
    errno = EINVAL;
    if ((!is_six && strncmp(address, "127.", 4) != 0) || length >= sizeof host)
        return -1;
    snprintf(host, sizeof host, "%.*s", (int)length, address);
    return connect_to(is_six ? "::1" : host, colon + 1);
}

/* Files that only their owner can read need no more. */

bool client_socket_is_foreign(int fd)
{
    (void)fd;
    return false;
}

bool client_socket_is_foreign_file(int fd)
{
    (void)fd;
    return false;
}

bool client_socket_wait(int fd, int timeout_ms)
{
    struct timeval left = {.tv_sec = timeout_ms / 1000, .tv_usec = timeout_ms % 1000 * 1000};
    fd_set sockets;
    FD_ZERO(&sockets);
    FD_SET((SOCKET)fd, &sockets);
    return select(0, &sockets, NULL, NULL, timeout_ms < 0 ? NULL : &left) > 0;
}

void client_socket_wait_room(int fd, int timeout_ms)
{
    struct timeval left = {.tv_sec = timeout_ms / 1000, .tv_usec = timeout_ms % 1000 * 1000};
    fd_set sockets;
    FD_ZERO(&sockets);
    FD_SET((SOCKET)fd, &sockets);
    (void)select(0, NULL, &sockets, NULL, timeout_ms < 0 ? NULL : &left);
}

static ssize_t with_errno(int count)
{
    errno = count < 0 && WSAGetLastError() == WSAEWOULDBLOCK ? EAGAIN : ECONNRESET;
    return count;
}

ssize_t client_socket_read(int fd, char *bytes, size_t room)
{
    return with_errno(recv((SOCKET)fd, bytes, (int)room, 0));
}

ssize_t client_socket_write(int fd, const char *bytes, size_t length)
{
    return with_errno(send((SOCKET)fd, bytes, (int)length, 0));
}

void client_socket_close(int fd)
{
    closesocket((SOCKET)fd);
}

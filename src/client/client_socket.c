/* SPDX-License-Identifier: MIT */
#include "client_socket.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "options/options.h"
#include "text/text.h"

#define CONNECT_S 10

bool client_socket_folder(unsigned number, char folder[PATH_MAX])
{
    const char *runtime = getenv("XDG_RUNTIME_DIR"), *temporary = getenv("TMPDIR");
    const bool has_runtime = runtime != NULL && runtime[0] == '/';
    if (number == 0 && has_runtime)
        return snprintf(folder, PATH_MAX, "%s/rkm04", runtime) < PATH_MAX;
    return number == (has_runtime ? 1u : 0u) &&
           snprintf(folder, PATH_MAX, "%s/rkm04-%lu", temporary != NULL && temporary[0] == '/' ? temporary : "/tmp",
                    (unsigned long)geteuid()) < PATH_MAX;
}

static int connect_to(int family, const void *address, socklen_t size)
{
    const struct timeval patience = {.tv_sec = CONNECT_S};
    int fd = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd >= 0)
        setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (fd < 0 || connect(fd, address, size) == 0)
        return fd;
    int error = errno == EAGAIN || errno == EINPROGRESS ? ETIMEDOUT : errno;
    close(fd);
    errno = error;
    return -1;
}

int client_socket_open(const char *path)
{
    struct sockaddr_un address;
    int folder, fd = -1;
    if (socket_address_find(path, &address, &folder))
        fd = connect_to(AF_UNIX, &address, sizeof address);
    int error = errno;
    if (folder >= 0)
        close(folder);
    errno = error;
    return fd;
}

int client_socket_open_tcp(const char *address)
{
    struct sockaddr_in four = {.sin_family = AF_INET};
    struct sockaddr_in6 six = {.sin6_family = AF_INET6};
    const char *colon = strrchr(address, ':');
    uint64_t number;
    char host[INET6_ADDRSTRLEN + 2];
    int fd, on = 1;
    errno = EINVAL;
    if (colon == NULL || !number_read(colon + 1, 1, UINT16_MAX, &number) || (size_t)(colon - address) >= sizeof host)
        return -1;
    snprintf(host, sizeof host, "%.*s", (int)(colon - address), address);
    four.sin_port = six.sin6_port = htons((uint16_t)number);
    six.sin6_addr = in6addr_loopback;
    if (strcmp(host, "[::1]") == 0)
        fd = connect_to(AF_INET6, &six, sizeof six);
    else if (strncmp(host, "127.", 4) == 0 && inet_pton(AF_INET, host, &four.sin_addr) == 1)
        fd = connect_to(AF_INET, &four, sizeof four);
    else
        return -1;
    if (fd >= 0)
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return fd;
}

bool client_socket_is_foreign(int fd)
{
    struct ucred peer;
    socklen_t size = sizeof peer;
    return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0 || (peer.uid != geteuid() && peer.uid != 0);
}

bool client_socket_is_foreign_file(int fd)
{
    struct stat found;
    return fstat(fd, &found) != 0 || (found.st_uid != geteuid() && found.st_uid != 0);
}

bool client_socket_wait(int fd, int timeout_ms)
{
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    return poll(&ready, 1, timeout_ms) > 0;
}

void client_socket_wait_room(int fd, int timeout_ms)
{
    struct pollfd ready = {.fd = fd, .events = POLLOUT};
    (void)poll(&ready, 1, timeout_ms);
}

ssize_t client_socket_read(int fd, char *bytes, size_t room)
{
    return read(fd, bytes, room);
}

ssize_t client_socket_write(int fd, const char *bytes, size_t length)
{
    return send(fd, bytes, length, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void client_socket_close(int fd)
{
    close(fd);
}

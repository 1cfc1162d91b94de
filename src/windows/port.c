/* SPDX-License-Identifier: MIT */
/* port.c: the port of rkmctl: a COM port by Win32, or TCP. One at a time. */
#include "port.h"

#include <errno.h>
#include <port_names.h>
#include <stdbool.h>
#include <termios.h>
#include <ws2tcpip.h>

#include "client/client_port.h"
#include "client/client_report.h"
#include "com.h"
#include "options/host_address.h"
#include "text/text.h"

#define TCP "tcp:"
#define LOOK_MS 1 /* between two looks at a COM port */
#define WRITE_MS 1000
#define CONNECT_LOOK_MS 20 /* between two looks whether a connection is still wanted */

static HANDLE com = INVALID_HANDLE_VALUE;
static SOCKET tcp = INVALID_SOCKET;

uint64_t client_now(void)
{
    LARGE_INTEGER now, each;
    QueryPerformanceCounter(&now);
    QueryPerformanceFrequency(&each);
    uint64_t second = (uint64_t)each.QuadPart, at = (uint64_t)now.QuadPart;
    return at / second * 1000000u + at % second * 1000000u / second;
}

/* ---- COM ports ------------------------------------------------------------------------------------------------------ */

static int open_com(const char *name)
{
    COMMTIMEOUTS timeouts = {MAXDWORD, 0, 0, 0, WRITE_MS}; /* a read returns what is there */
    const char *why;
    com = com_open(name, 0, &why);
    if (com == INVALID_HANDLE_VALUE) {
        client_report("cannot open %s: %s", name, why);
        return -1;
    }
    if (com_set_up(com, CBR_19200) && SetCommTimeouts(com, &timeouts))
        return PORT_FD;
    client_report("%s is not a serial device that takes 19200 baud, 8N1: expected one like COM3, or tcp:HOST:PORT", name);
    windows_port_close(PORT_FD);
    return -1;
}

static short poll_com(short events)
{
    COMSTAT status;
    DWORD errors;
    if (!ClearCommError(com, &errors, &status))
        return PORT_IN; /* reading reports it */
    return (short)((events & PORT_OUT) | (status.cbInQue > 0 ? events & PORT_IN : 0));
}

/* ---- TCP ------------------------------------------------------------------------------------------------------------ */

/* Where the last colon of tcp:HOST:PORT stands; NULL: not of that form. */
static const char *find_service(const char *port)
{
    const char *host = port + strlen(TCP), *colon = strrchr(host, ':');
    uint64_t number;
    return colon && colon > host && number_read(colon + 1, 1, UINT16_MAX, &number) ? colon : NULL;
}

/* Wait until the socket can be read or written. Returns the events. */
static short poll_tcp(short events, int timeout)
{
    fd_set in, out, refused;
    struct timeval limit = {timeout / 1000, timeout % 1000 * 1000};
    FD_ZERO(&in);
    FD_ZERO(&out);
    FD_ZERO(&refused);
    if (events & PORT_IN)
        FD_SET(tcp, &in);
    if (events & PORT_OUT)
        FD_SET(tcp, &out);
    FD_SET(tcp, &refused);
    if (select(0, &in, &out, &refused, &limit) <= 0)
        return 0;
    return (short)((FD_ISSET(tcp, &in) || FD_ISSET(tcp, &refused) ? PORT_IN : 0) | (FD_ISSET(tcp, &out) ? PORT_OUT : 0));
}

/* Wait until the connection is there. Returns false if it is refused, cancelled, or the time is over. */
static bool await_connection(unsigned timeout_ms)
{
    uint64_t end = client_now() + (uint64_t)timeout_ms * 1000u;
    short found = 0;
    while (found == 0 && client_now() < end && !port_is_cancelled())
        found = poll_tcp(PORT_OUT, CONNECT_LOOK_MS);
    return found == PORT_OUT;
}

static bool connect_to(const struct addrinfo *address, unsigned timeout_ms)
{
    u_long on = 1;
    tcp = socket(address->ai_family, SOCK_STREAM, 0);
    if (tcp == INVALID_SOCKET)
        return false;
    ioctlsocket(tcp, (long)FIONBIO, &on);
    setsockopt(tcp, IPPROTO_TCP, TCP_NODELAY, (const char *)&on, sizeof on);
    if (connect(tcp, address->ai_addr, (int)address->ai_addrlen) == 0 || await_connection(timeout_ms))
        return true;
    windows_port_close(PORT_FD);
    return false;
}

static int open_tcp(const char *port, unsigned timeout_ms)
{
    const char *name = port + strlen(TCP), *colon = find_service(port);
    bool bracketed = name[0] == '[' && colon[-1] == ']', connected = false;
    struct addrinfo *list = NULL;
    char host[256];
    snprintf(host, sizeof host, "%.*s", (int)(colon - name) - 2 * bracketed, name + bracketed);
    const char *why = host_address_find(host, colon + 1, AF_UNSPEC, timeout_ms, &list);
    if (why) {
        client_report("cannot find %s: %s", port, why);
        return -1;
    }
    for (const struct addrinfo *address = list; address && !connected; address = address->ai_next)
        connected = connect_to(address, timeout_ms);
    freeaddrinfo(list);
    if (!connected)
        client_report("cannot connect to %s: nobody listens there, or nobody answers in time", port);
    return connected ? PORT_FD : -1;
}

/* ---- Either --------------------------------------------------------------------------------------------------------- */

static short poll_port(short events, int timeout)
{
    uint64_t end = client_now() + (uint64_t)timeout * 1000u;
    if (tcp != INVALID_SOCKET)
        return poll_tcp(events, timeout);
    for (;;) {
        short found = com != INVALID_HANDLE_VALUE ? poll_com(events) : 0;
        if (found || client_now() >= end)
            return found;
        Sleep(LOOK_MS);
    }
}

bool client_port_valid(const char *port)
{
    return strncmp(port, TCP, strlen(TCP)) != 0 || find_service(port) != NULL;
}

int client_port_open(const char *port, unsigned timeout_ms)
{
    port_poll = poll_port;
    return strncmp(port, TCP, strlen(TCP)) == 0 ? open_tcp(port, timeout_ms) : open_com(port);
}

/* -1, with errno as POSIX has it. */
static ssize_t fail(bool would_block)
{
    errno = would_block ? EAGAIN : EIO;
    return -1;
}

ssize_t windows_port_read(int fd, void *bytes, size_t room)
{
    DWORD length = 0;
    (void)fd;
    if (tcp != INVALID_SOCKET) {
        int got = recv(tcp, bytes, (int)room, 0);
        return got >= 0 ? got : fail(WSAGetLastError() == WSAEWOULDBLOCK);
    }
    if (!ReadFile(com, bytes, (DWORD)room, &length, NULL))
        return fail(false);
    return length > 0 ? (ssize_t)length : fail(true);
}

ssize_t windows_port_write(int fd, const void *bytes, size_t length)
{
    DWORD written = 0;
    (void)fd;
    if (tcp != INVALID_SOCKET) {
        int sent = send(tcp, bytes, (int)length, 0);
        return sent >= 0 ? sent : fail(WSAGetLastError() == WSAEWOULDBLOCK);
    }
    if (!WriteFile(com, bytes, (DWORD)length, &written, NULL))
        return fail(false);
    return written > 0 ? (ssize_t)written : fail(true);
}

int windows_port_close(int fd)
{
    (void)fd;
    if (tcp != INVALID_SOCKET)
        closesocket(tcp);
    if (com != INVALID_HANDLE_VALUE)
        CloseHandle(com);
    tcp = INVALID_SOCKET;
    com = INVALID_HANDLE_VALUE;
    return 0;
}

int tcflush(int fd, int which)
{
    (void)fd;
    (void)which;
    return com == INVALID_HANDLE_VALUE || PurgeComm(com, PURGE_TXCLEAR) ? 0 : -1;
}

int tcdrain(int fd)
{
    (void)fd;
    return com == INVALID_HANDLE_VALUE || FlushFileBuffers(com) ? 0 : -1;
}

int tcgetattr(int fd, struct termios *settings)
{
    DCB dcb = {.DCBlength = sizeof dcb};
    (void)fd;
    if (com == INVALID_HANDLE_VALUE || !GetCommState(com, &dcb))
        return -1;
    settings->speed = dcb.BaudRate;
    return 0;
}

int tcsetattr(int fd, int when, const struct termios *settings)
{
    DCB dcb = {.DCBlength = sizeof dcb};
    (void)fd;
    (void)when;
    if (com == INVALID_HANDLE_VALUE || !GetCommState(com, &dcb))
        return -1;
    dcb.BaudRate = settings->speed;
    return SetCommState(com, &dcb) ? 0 : -1;
}

int cfsetspeed(struct termios *settings, speed_t speed)
{
    settings->speed = speed;
    return 0;
}

/* SPDX-License-Identifier: MIT */
#include "port.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ws2tcpip.h>

bool wrong(const char *what, DWORD error)
{
    printf("%s: error %lu\n", what, (unsigned long)error);
    return false;
}

/* ---- Opening -------------------------------------------------------------------------------------------------------- */

static bool open_socket(struct port *port, const char *name)
{
    char host[256];
    const char *colon = strrchr(name, ':');
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *found;
    WSADATA data;
    snprintf(host, sizeof host, "%.*s", (int)(colon - name), name);
    if (WSAStartup(MAKEWORD(2, 2), &data) != 0 || getaddrinfo(host, colon + 1, &hints, &found) != 0)
        return wrong(name, (DWORD)WSAGetLastError());
    port->socket = socket(found->ai_family, SOCK_STREAM, 0);
    int failed = connect(port->socket, found->ai_addr, (int)found->ai_addrlen);
    freeaddrinfo(found);
    if (failed)
        return wrong("connect", (DWORD)WSAGetLastError());
    DWORD limit = LIMIT_MS;
    setsockopt(port->socket, SOL_SOCKET, SO_RCVTIMEO, (const char *)&limit, sizeof limit);
    return true;
}

bool port_open(struct port *port, const char *name, bool overlapped)
{
    char path[32];
    *port = (struct port){.com = INVALID_HANDLE_VALUE, .socket = INVALID_SOCKET, .overlapped = overlapped};
    if (strncmp(name, "tcp:", 4) == 0 && strchr(name + 4, ':'))
        return open_socket(port, name + 4);
    snprintf(path, sizeof path, "\\\\.\\%.16s", name);
    port->com = CreateFileA(path, GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING,
                            overlapped ? FILE_FLAG_OVERLAPPED : 0, NULL);
    if (port->com == INVALID_HANDLE_VALUE)
        return wrong("CreateFile", GetLastError());
    for (int i = 0; i < 2; i++)
        port->done[i] = CreateEventA(NULL, TRUE, FALSE, NULL);
    return true;
}

void port_close(struct port *port)
{
    if (port->socket != INVALID_SOCKET)
        closesocket(port->socket);
    if (port->com == INVALID_HANDLE_VALUE)
        return;
    CloseHandle(port->com);
    for (int i = 0; i < 2; i++)
        CloseHandle(port->done[i]);
}

bool port_set_up(const struct port *port)
{
    DCB dcb = {.DCBlength = sizeof dcb};
    COMMTIMEOUTS timeouts = {0, 0, LIMIT_MS, 0, LIMIT_MS};
    if (port->com == INVALID_HANDLE_VALUE)
        return true;
    if (!GetCommState(port->com, &dcb))
        return wrong("GetCommState", GetLastError());
    dcb.BaudRate = CBR_19200;
    dcb.ByteSize = 8;
    dcb.Parity = NOPARITY;
    dcb.StopBits = ONESTOPBIT;
    dcb.fBinary = TRUE;
    dcb.fParity = dcb.fOutX = dcb.fInX = dcb.fOutxCtsFlow = dcb.fOutxDsrFlow = FALSE;
    dcb.fDtrControl = DTR_CONTROL_ENABLE;
    dcb.fRtsControl = RTS_CONTROL_ENABLE;
    if (!SetCommState(port->com, &dcb))
        return wrong("SetCommState", GetLastError());
    if (!SetCommTimeouts(port->com, &timeouts))
        return wrong("SetCommTimeouts", GetLastError());
    return true;
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

bool port_write(const struct port *port, const uint8_t *bytes, size_t length)
{
    OVERLAPPED overlapped = {.hEvent = port->done[1]};
    DWORD written = 0;
    if (port->com == INVALID_HANDLE_VALUE)
        return send(port->socket, (const char *)bytes, (int)length, 0) == (int)length || wrong("send", (DWORD)WSAGetLastError());
    if (!port->overlapped)
        return (WriteFile(port->com, bytes, (DWORD)length, &written, NULL) && written == length) ||
               wrong("WriteFile", GetLastError());
    if (!WriteFile(port->com, bytes, (DWORD)length, NULL, &overlapped) && GetLastError() != ERROR_IO_PENDING)
        return wrong("WriteFile", GetLastError());
    if (!GetOverlappedResult(port->com, &overlapped, &written, TRUE) || written != length)
        return wrong("GetOverlappedResult of WriteFile", GetLastError());
    return true;
}

DWORD com_read(const struct port *port, uint8_t *bytes, DWORD room)
{
    OVERLAPPED overlapped = {.hEvent = port->done[0]};
    DWORD length = 0;
    if (!port->overlapped)
        return ReadFile(port->com, bytes, room, &length, NULL) ? length : wrong("ReadFile", GetLastError());
    if (!ReadFile(port->com, bytes, room, NULL, &overlapped) && GetLastError() != ERROR_IO_PENDING)
        return wrong("ReadFile", GetLastError());
    return GetOverlappedResult(port->com, &overlapped, &length, TRUE) ? length : 0;
}

/* One byte, as soon as it comes, then those that came with it. */
size_t port_read(const struct port *port, uint8_t *bytes, size_t room)
{
    COMSTAT status = {0};
    DWORD errors;
    if (port->com == INVALID_HANDLE_VALUE) {
        int received = recv(port->socket, (char *)bytes, (int)room, 0);
        return received > 0 ? (size_t)received : wrong("recv", (DWORD)WSAGetLastError());
    }
    if (com_read(port, bytes, 1) != 1)
        return wrong("no bytes", GetLastError());
    if (!ClearCommError(port->com, &errors, &status))
        return wrong("ClearCommError", GetLastError());
    size_t more = status.cbInQue < room - 1 ? status.cbInQue : room - 1;
    return 1 + (more > 0 ? com_read(port, bytes + 1, (DWORD)more) : 0);
}

/* ---- Frames --------------------------------------------------------------------------------------------------------- */

static uint16_t fcs(uint16_t check, uint8_t byte)
{
    check ^= byte;
    for (int bit = 0; bit < 8; bit++)
        check = (uint16_t)(check >> 1 ^ (check & 1 ? 0x8408 : 0));
    return check;
}

size_t unit_frame(const void *request, size_t length, uint8_t *frame)
{
    uint8_t plain[64] = {1, 0};
    uint16_t check = 0xFFFF;
    size_t n = 0;
    memcpy(plain + 2, request, length);
    for (size_t i = 0; i < length + 2; i++)
        check = fcs(check, plain[i]);
    plain[length + 2] = (uint8_t)~check;
    plain[length + 3] = (uint8_t)(~check >> 8);
    frame[n++] = 0x7E;
    for (size_t i = 0; i < length + 4; i++) {
        bool stuffed = plain[i] == 0x7E || plain[i] == 0x7D;
        if (stuffed)
            frame[n++] = 0x7D;
        frame[n++] = (uint8_t)(plain[i] ^ (stuffed ? 0x20 : 0));
    }
    frame[n++] = 0x7E;
    return n;
}

size_t unit_ask(const struct port *port, const void *request, size_t length, uint8_t *answer, size_t room)
{
    uint8_t frame[160], bytes[256];
    size_t kept = 0;
    uint16_t check = 0xFFFF;
    bool inside = false, escaped = false;
    if (!port_write(port, frame, unit_frame(request, length, frame)))
        return 0;
    for (;;) {
        size_t got = port_read(port, bytes, sizeof bytes);
        if (got == 0)
            return 0;
        for (size_t i = 0; i < got; i++) {
            if (bytes[i] == 0x7E && inside && kept > 4) {
                if (check != 0xF0B8)
                    return wrong("check sum of the answer", check);
                memmove(answer, answer + 2, kept - 4);
                return kept - 4;
            }
            inside = inside || bytes[i] == 0x7E;
            if (bytes[i] == 0x7D)
                escaped = true;
            if (bytes[i] == 0x7E || bytes[i] == 0x7D)
                continue;
            if (kept == room)
                return wrong("length of the answer", (DWORD)kept);
            answer[kept] = (uint8_t)(bytes[i] ^ (escaped ? 0x20 : 0));
            escaped = false;
            check = fcs(check, answer[kept++]);
        }
    }
}

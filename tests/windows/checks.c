/* SPDX-License-Identifier: MIT */
/* checks.c: what a Windows program does with a COM port, and what Windows promises for it. */
#include "checks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t version[] = {1};

/* A condition of a check. */
static bool expect(bool holds, const char *what)
{
    return holds || wrong(what, GetLastError());
}

static bool ask_version(const struct port *port)
{
    uint8_t answer[128];
    size_t length = unit_ask(port, version, sizeof version, answer, sizeof answer);
    if (length < 2)
        return false;
    printf("%.*s\n", (int)length - 2, (const char *)answer + 2);
    return true;
}

static bool send_version(const struct port *port)
{
    uint8_t frame[32];
    return port_write(port, frame, unit_frame(version, sizeof version, frame));
}

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

static bool set(const struct port *port, DWORD baud, BYTE bits, BYTE parity, BYTE stop)
{
    DCB dcb = {.DCBlength = sizeof dcb};
    if (!GetCommState(port->com, &dcb))
        return false;
    dcb.BaudRate = baud;
    dcb.ByteSize = bits;
    dcb.Parity = parity;
    dcb.StopBits = stop;
    return SetCommState(port->com, &dcb);
}

/* Set these and see that they are set. */
static bool set_and_get(const struct port *port, const DCB *wanted, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        DCB dcb = {.DCBlength = sizeof dcb};
        if (!set(port, wanted[i].BaudRate, wanted[i].ByteSize, wanted[i].Parity, wanted[i].StopBits) ||
            !GetCommState(port->com, &dcb))
            return wrong("settings", GetLastError());
        if (dcb.BaudRate != wanted[i].BaudRate || dcb.ByteSize != wanted[i].ByteSize || dcb.Parity != wanted[i].Parity ||
            dcb.StopBits != wanted[i].StopBits)
            return wrong("GetCommState: other settings than those that were set", (DWORD)i);
    }
    return true;
}

static bool check_settings(const struct port *port)
{
    static const DCB wanted[] = {{.BaudRate = 9600, .ByteSize = 8, .Parity = NOPARITY, .StopBits = TWOSTOPBITS},
                                 {.BaudRate = 57600, .ByteSize = 8, .Parity = NOPARITY, .StopBits = ONESTOPBIT},
                                 {.BaudRate = 19200, .ByteSize = 8, .Parity = NOPARITY, .StopBits = ONESTOPBIT}};
    return set_and_get(port, wanted, sizeof wanted / sizeof wanted[0]) &&
           expect(!set(port, 19200, 9, NOPARITY, ONESTOPBIT), "nine data bits are accepted") && ask_version(port);
}

static bool check_formats(const struct port *port)
{
    static const DCB wanted[] = {{.BaudRate = 9600, .ByteSize = 7, .Parity = EVENPARITY, .StopBits = TWOSTOPBITS},
                                 {.BaudRate = 19200, .ByteSize = 8, .Parity = MARKPARITY, .StopBits = ONESTOPBIT}};
    return set_and_get(port, wanted, sizeof wanted / sizeof wanted[0]);
}

/* A unit does not understand other settings than its own: it answers once they are right. */
static bool check_after(const struct port *port, DWORD baud, BYTE parity)
{
    COMMTIMEOUTS timeouts = {0, 0, 300, 0, 0};
    uint8_t bytes[64];
    if (!set(port, baud, 8, parity, ONESTOPBIT) || !SetCommTimeouts(port->com, &timeouts) || !send_version(port))
        return wrong("wrong settings", GetLastError());
    return expect(com_read(port, bytes, sizeof bytes) == 0, "an answer in spite of wrong settings") && port_set_up(port) &&
           ask_version(port);
}

static bool check_other_speed(const struct port *port)
{
    return check_after(port, 9600, NOPARITY);
}

static bool check_other_parity(const struct port *port)
{
    return check_after(port, 19200, EVENPARITY);
}

static bool check_setup(const struct port *port)
{
    COMMPROP properties = {.wPacketLength = sizeof properties};
    if (!SetupComm(port->com, 4096, 4096) || !GetCommProperties(port->com, &properties))
        return wrong("SetupComm or GetCommProperties", GetLastError());
    return expect((properties.dwSettableBaud & BAUD_19200) != 0, "19200 baud among the properties");
}

/* ---- Timeouts ------------------------------------------------------------------------------------------------------- */

#define VERSION_FRAME 24u /* bytes of the answer: flags, addresses, message and check sum */

/* One read with these timeouts. Returns the number of bytes; `*took`: milliseconds. */
static DWORD timed_read(const struct port *port, COMMTIMEOUTS timeouts, DWORD room, uint64_t *took)
{
    uint8_t bytes[64];
    SetCommTimeouts(port->com, &timeouts);
    uint64_t begun = GetTickCount64();
    DWORD length = com_read(port, bytes, room);
    *took = GetTickCount64() - begun;
    return length;
}

static bool check_timeouts(const struct port *port)
{
    static const COMMTIMEOUTS at_once = {MAXDWORD, 0, 0, 0, 0}, constant = {0, 0, 200, 0, 0}, each = {0, 20, 0, 0, 0},
                              all = {0, 0, 0, 0, 0};
    uint64_t took;
    if (!expect(timed_read(port, at_once, 10, &took) == 0 && took < LIMIT_MS / 2, "a read that does not wait") ||
        !expect(timed_read(port, constant, 10, &took) == 0 && took >= 150, "a read of 200 ms at most") ||
        !expect(timed_read(port, each, 10, &took) == 0 && took >= 150, "a read of 20 ms for each of 10 bytes") ||
        !send_version(port))
        return false;
    return expect(timed_read(port, all, VERSION_FRAME, &took) == VERSION_FRAME, "a read that waits for all bytes");
}

/* A read ends after a gap between two bytes; not within the answer, unless the machine is so busy that there is one. */
static bool check_gap(const struct port *port)
{
    static const COMMTIMEOUTS gap = {200, 0, LIMIT_MS, 0, 0}, constant = {0, 0, 2000, 0, 0};
    uint64_t took, rest;
    for (unsigned tries = 0; tries < 10; tries++) {
        if (!send_version(port))
            return false;
        DWORD length = timed_read(port, gap, 64, &took);
        if (length == VERSION_FRAME && took < LIMIT_MS)
            return true;
        if (length < VERSION_FRAME)
            timed_read(port, constant, VERSION_FRAME - length, &rest);
    }
    return expect(false, "a read that ends after a gap of 200 ms");
}

/* A read waits, and ends with the first byte. */
static bool check_first_byte(const struct port *port)
{
    static const COMMTIMEOUTS first = {MAXDWORD, MAXDWORD, LIMIT_MS, 0, 0};
    uint64_t took;
    if (!send_version(port))
        return false;
    DWORD length = timed_read(port, first, 64, &took);
    return expect(length > 0 && length <= VERSION_FRAME && took < LIMIT_MS, "a read that ends with the first byte");
}

/* ---- Overlapped ----------------------------------------------------------------------------------------------------- */

static bool check_overlapped(const struct port *port)
{
    uint8_t bytes[VERSION_FRAME];
    OVERLAPPED overlapped = {.hEvent = port->done[0]};
    DWORD length = 0;
    if (ReadFile(port->com, bytes, sizeof bytes, NULL, &overlapped) || GetLastError() != ERROR_IO_PENDING)
        return wrong("a read before the request is not pending", GetLastError());
    if (!expect(WaitForSingleObject(overlapped.hEvent, 0) == WAIT_TIMEOUT, "a read ends without bytes") || !send_version(port))
        return false;
    if (WaitForSingleObject(overlapped.hEvent, LIMIT_MS) != WAIT_OBJECT_0 ||
        !GetOverlappedResult(port->com, &overlapped, &length, FALSE) || length != sizeof bytes)
        return wrong("the pending read", GetLastError());
    if (ReadFile(port->com, bytes, sizeof bytes, NULL, &overlapped) || GetLastError() != ERROR_IO_PENDING || !CancelIo(port->com))
        return wrong("CancelIo", GetLastError());
    if (GetOverlappedResult(port->com, &overlapped, &length, TRUE) || GetLastError() != ERROR_OPERATION_ABORTED)
        return wrong("a cancelled read", GetLastError());
    return true;
}

/* ---- Events --------------------------------------------------------------------------------------------------------- */

static bool check_events(const struct port *port)
{
    uint8_t bytes[VERSION_FRAME];
    DWORD events = 0, length;
    OVERLAPPED overlapped = {.hEvent = port->done[0]};
    if (!SetCommMask(port->com, EV_RXCHAR))
        return wrong("SetCommMask", GetLastError());
    if (WaitCommEvent(port->com, &events, &overlapped) || GetLastError() != ERROR_IO_PENDING)
        return wrong("WaitCommEvent is not pending", GetLastError());
    if (!send_version(port))
        return false;
    if (WaitForSingleObject(overlapped.hEvent, LIMIT_MS) != WAIT_OBJECT_0 ||
        !GetOverlappedResult(port->com, &overlapped, &length, FALSE))
        return wrong("WaitCommEvent", GetLastError());
    if (!expect(events == EV_RXCHAR, "the event"))
        return false;
    if (!expect(com_read(port, bytes, sizeof bytes) == sizeof bytes, "the bytes after the event"))
        return false;
    if (WaitCommEvent(port->com, &events, &overlapped) || GetLastError() != ERROR_IO_PENDING || !SetCommMask(port->com, 0))
        return wrong("another WaitCommEvent", GetLastError());
    return expect(WaitForSingleObject(overlapped.hEvent, LIMIT_MS) == WAIT_OBJECT_0, "SetCommMask ends WaitCommEvent");
}

/* Bytes are counted when they have come, and purged. */
static bool check_queue(const struct port *port)
{
    COMSTAT status = {0};
    DWORD errors = 0;
    uint64_t begun = GetTickCount64(), took;
    static const COMMTIMEOUTS at_once = {MAXDWORD, 0, 0, 0, 0};
    if (!send_version(port))
        return false;
    while (status.cbInQue < VERSION_FRAME && GetTickCount64() - begun < LIMIT_MS)
        if (!ClearCommError(port->com, &errors, &status))
            return wrong("ClearCommError", GetLastError());
    if (!expect(status.cbInQue == VERSION_FRAME && errors == 0, "bytes that wait to be read") ||
        !expect(PurgeComm(port->com, PURGE_RXCLEAR | PURGE_TXCLEAR | PURGE_RXABORT | PURGE_TXABORT), "PurgeComm") ||
        !expect(ClearCommError(port->com, &errors, &status) && status.cbInQue == 0, "bytes that were purged") ||
        !expect(timed_read(port, at_once, 64, &took) == 0, "purged bytes are read"))
        return false;
    return port_set_up(port);
}

/* ---- Lines ---------------------------------------------------------------------------------------------------------- */

static bool check_lines(const struct port *port)
{
    static const DWORD functions[] = {CLRRTS, SETRTS, CLRDTR, SETDTR};
    const DWORD inputs = MS_CTS_ON | MS_DSR_ON | MS_RLSD_ON;
    DWORD status = 0;
    for (size_t i = 0; i < sizeof functions / sizeof functions[0]; i++)
        if (!EscapeCommFunction(port->com, functions[i]))
            return wrong("EscapeCommFunction", GetLastError());
    if (!GetCommModemStatus(port->com, &status))
        return wrong("GetCommModemStatus", GetLastError());
    return expect((status & inputs) == inputs, "CTS, DSR and carrier");
}

static bool check_break(const struct port *port)
{
    if (!SetCommBreak(port->com) || !ClearCommBreak(port->com))
        return wrong("SetCommBreak or ClearCommBreak", GetLastError());
    return ask_version(port);
}

/* A port is for one program alone. */
static bool check_sharing(const struct port *port)
{
    HANDLE other = CreateFileA(port_name(), GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING, 0, NULL);
    (void)port;
    if (other != INVALID_HANDLE_VALUE)
        CloseHandle(other);
    return expect(other == INVALID_HANDLE_VALUE && GetLastError() == ERROR_ACCESS_DENIED, "the port is opened twice");
}

/* ---- The unit ------------------------------------------------------------------------------------------------------- */

/* Motor 1 makes 500 steps. */
static bool check_motion(const struct port *port)
{
    static const char program[] = "\x02" "1\\C100 S100 V1000 A2000 F500 R";
    static const char position[] = "\x04" "1";
    uint8_t answer[128];
    char text[32] = "";
    uint64_t begun = GetTickCount64();
    if (unit_ask(port, program, sizeof program - 1, answer, sizeof answer) != 4 || answer[2] != 0)
        return wrong("the program is refused", answer[2]);
    while (GetTickCount64() - begun < LIMIT_MS) {
        size_t length = unit_ask(port, position, sizeof position - 1, answer, sizeof answer);
        if (length < 3 || length > sizeof text)
            return wrong("the position", (DWORD)length);
        memcpy(text, answer + 3, length - 3);
        text[length - 3] = '\0';
        if (strtol(text, NULL, 10) == 500) {
            printf("position %ld\n", strtol(text, NULL, 10));
            return true;
        }
    }
    return wrong("the last position", (DWORD)strtol(text, NULL, 10));
}

const struct check checks[] = {
    {"version", ANY_PORT, ask_version},
    {"motion", ANY_PORT, check_motion},
    {"settings", PLAIN_PORT, check_settings},
    {"formats", PLAIN_PORT, check_formats},
    {"other-speed", PLAIN_PORT, check_other_speed},
    {"other-parity", PLAIN_PORT, check_other_parity},
    {"setup", OVERLAPPED_PORT, check_setup},
    {"timeouts", PLAIN_PORT, check_timeouts},
    {"gap", PLAIN_PORT, check_gap},
    {"first-byte", PLAIN_PORT, check_first_byte},
    {"overlapped", OVERLAPPED_PORT, check_overlapped},
    {"events", OVERLAPPED_PORT, check_events},
    {"queue", PLAIN_PORT, check_queue},
    {"lines", OVERLAPPED_PORT, check_lines},
    {"break", OVERLAPPED_PORT, check_break},
    {"sharing", OVERLAPPED_PORT, check_sharing},
    {NULL, ANY_PORT, NULL},
};

/* SPDX-License-Identifier: MIT */
#include "com.h"

#include <stdbool.h>

static const char *reason(DWORD error)
{
    switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
        return "there is no such port; is the adapter plugged in?";
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
        return "another program has it open";
    default:
        return "Windows cannot open it";
    }
}

HANDLE com_open(const char *name, DWORD flags, const char **why)
{
    char path[64];
    bool whole = strncmp(name, "\\\\.\\", 4) == 0 || strncmp(name, "//./", 4) == 0;
    snprintf(path, sizeof path, "%s%.50s", whole ? "" : "\\\\.\\", name);
    HANDLE com = CreateFileA(path, GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING, flags, NULL);
    if (com == INVALID_HANDLE_VALUE)
        *why = reason(GetLastError());
    return com;
}

BOOL com_set_up(HANDLE com, DWORD baud)
{
    DCB dcb = {.DCBlength = sizeof dcb};
    if (!GetCommState(com, &dcb))
        return FALSE;
    dcb.BaudRate = baud;
    dcb.ByteSize = 8;
    dcb.Parity = NOPARITY;
    dcb.StopBits = ONESTOPBIT;
    dcb.fBinary = TRUE;
    dcb.fParity = dcb.fOutX = dcb.fInX = dcb.fOutxCtsFlow = dcb.fOutxDsrFlow = dcb.fDsrSensitivity = dcb.fNull = FALSE;
    dcb.fAbortOnError = dcb.fErrorChar = FALSE;
    dcb.fDtrControl = DTR_CONTROL_ENABLE;
    dcb.fRtsControl = RTS_CONTROL_ENABLE;
    return SetCommState(com, &dcb) && PurgeComm(com, PURGE_RXCLEAR | PURGE_TXCLEAR);
}

/* SPDX-License-Identifier: MIT */
/* com.h: COM ports by Win32, for the client and the emulator. */
#ifndef RKM04_WINDOWS_COM_H
#define RKM04_WINDOWS_COM_H

#include <windows.h>

/* Open a port, "COM3" or "\\.\COM3", for this process alone. flags: 0 or FILE_FLAG_OVERLAPPED. Returns INVALID_HANDLE_VALUE if it
 * did not work; *why is the reason then. */
HANDLE com_open(const char *name, DWORD flags, const char **why);

/* 8N1 with this speed, no flow control, RTS and DTR on; what came before is discarded. Returns false if it did not work. */
BOOL com_set_up(HANDLE com, DWORD baud);

#endif

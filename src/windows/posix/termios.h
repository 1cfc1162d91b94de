/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_TERMIOS_H
#define RKM04_WINDOWS_TERMIOS_H

#define TCOFLUSH 1

/* Of the port that rkmctl has open (port.c). */
int tcflush(int fd, int which);
int tcdrain(int fd);

#endif

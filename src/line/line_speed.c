/* SPDX-License-Identifier: MIT */
/* line_speed.c: speeds of any number. */
#include <asm/termbits.h> /* not <termios.h>: the kernel's own structure has them */
#include <sys/ioctl.h>

#include "line_settings.h"

#ifndef TCGETS2 /* where the first structure has them already */
#define TCGETS2 TCGETS
#define TCSETS2 TCSETS
#define termios2 termios
#endif

static uint8_t data_bits_of(tcflag_t flags)
{
    switch (flags & CSIZE) {
    case CS5:
        return 5;
    case CS6:
        return 6;
    case CS7:
        return 7;
    default:
        return 8;
    }
}

static char parity_of(tcflag_t flags)
{
    if (!(flags & PARENB))
        return 'N';
    if (flags & CMSPAR)
        return flags & PARODD ? 'M' : 'S';
    return flags & PARODD ? 'O' : 'E';
}

bool line_settings_read(int fd, struct line_settings *settings)
{
    struct termios2 terminal;
    if (ioctl(fd, TCGETS2, &terminal) != 0)
        return false;
    settings->baud = terminal.c_ospeed;
    settings->data_bits = data_bits_of(terminal.c_cflag);
    settings->parity = parity_of(terminal.c_cflag);
    settings->stop_halves = 2;
    if (terminal.c_cflag & CSTOPB)
        settings->stop_halves = settings->data_bits == 5 ? 3 : 4; /* so UARTs have it */
    return true;
}

void line_settings_set_baud(int fd, unsigned baud)
{
    struct termios2 settings;
    if (ioctl(fd, TCGETS2, &settings) != 0)
        return;
    settings.c_cflag &= ~((tcflag_t)CBAUD | (tcflag_t)CBAUD << IBSHIFT);
    settings.c_cflag |= BOTHER | (tcflag_t)BOTHER << IBSHIFT;
    settings.c_ispeed = settings.c_ospeed = baud;
    ioctl(fd, TCSETS2, &settings);
}

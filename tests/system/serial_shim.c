/* SPDX-License-Identifier: MIT */
/* serial_shim.c, for LD_PRELOAD: makes a pty look like an RS485 device. What is asked of the driver goes to the file $SHIM_LOG, a
 * word a line; without $SHIM_RS485 the driver has no RS485 mode. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static int note(const char *word)
{
    int fd = open(getenv("SHIM_LOG"), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
    if (fd >= 0 && write(fd, word, strlen(word)) < 0)
        return -1;
    close(fd);
    return 0;
}

static int rs485(unsigned long request, struct serial_rs485 *settings)
{
    if (!getenv("SHIM_RS485")) {
        errno = ENOTTY;
        return -1;
    }
    if (request == TIOCGRS485) {
        *settings = (struct serial_rs485){0};
        return 0;
    }
    return note(settings->flags & SER_RS485_ENABLED ? "rs485_on\n" : "rs485_off\n");
}

int ioctl(int fd, unsigned long request, ...)
{
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    switch (request) {
    case TIOCMGET:
        *(int *)argument = 0;
        return 0;
    case TIOCMBIS:
        return note(*(int *)argument & TIOCM_RTS ? "rts_on\n" : "other\n");
    case TIOCMBIC:
        return note(*(int *)argument & TIOCM_RTS ? "rts_off\n" : "other\n");
    case TIOCOUTQ:
        *(int *)argument = 0;
        return 0;
    case TIOCSERGETLSR:
        *(int *)argument = TIOCSER_TEMT;
        return 0;
    case TIOCGRS485:
    case TIOCSRS485:
        return rs485(request, argument);
    default:
        break;
    }
    int (*next)(int, unsigned long, ...);
    *(void **)&next = dlsym(RTLD_NEXT, "ioctl");
    return next(fd, request, argument);
}

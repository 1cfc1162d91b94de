/* SPDX-License-Identifier: MIT */
/* modem_lines.c: a library to be loaded before a program (LD_PRELOAD) that asks a serial port for its modem lines and cannot do
 * without an answer: Linux has none for a pty. CTS, DSR and carrier are on; RTS and DTR are what the program has set, all ptys of
 * the process together. A port that knows its lines answers itself.
 *
 * Wine is such a program: without the lines WaitCommEvent(), EscapeCommFunction() and GetCommModemStatus() fail. */
#include <dlfcn.h>
#include <errno.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define INPUTS (TIOCM_CTS | TIOCM_DSR | TIOCM_CAR)
#define OUTPUTS (TIOCM_RTS | TIOCM_DTR)

static atomic_int outputs = OUTPUTS;

typedef int ioctl_function(int fd, unsigned long request, ...);

/* The system's, found before the program's threads begin. */
static ioctl_function *system_ioctl;

__attribute__((constructor)) static void find_ioctl(void)
{
    *(void **)&system_ioctl = dlsym(RTLD_NEXT, "ioctl"); /* as POSIX shows it: ISO C has no such conversion */
}

static bool is_about_lines(unsigned long request)
{
    return request == TIOCMGET || request == TIOCMSET || request == TIOCMBIS || request == TIOCMBIC;
}

static void answer(unsigned long request, int *lines)
{
    switch (request) {
    case TIOCMGET:
        *lines = atomic_load(&outputs) | INPUTS;
        break;
    case TIOCMSET:
        atomic_store(&outputs, *lines & OUTPUTS);
        break;
    case TIOCMBIS:
        atomic_fetch_or(&outputs, *lines & OUTPUTS);
        break;
    default:
        atomic_fetch_and(&outputs, ~(*lines & OUTPUTS));
        break;
    }
}

__attribute__((visibility("default"))) int ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *argument = va_arg(arguments, void *);
    va_end(arguments);
    int result = system_ioctl(fd, request, argument);
    if (result >= 0 || errno != ENOTTY || !is_about_lines(request) || !argument || !isatty(fd))
        return result;
    answer(request, argument);
    return 0;
}

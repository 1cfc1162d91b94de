/* SPDX-License-Identifier: MIT */
#include "line.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "line_raw.h"
#include "log.h"

struct line_device {
    bool rs485_set; /* the driver's RS485 mode is ours, `rs485` is what it was */
    struct serial_rs485 rs485;
};

/* Raw, 19200 baud, 8N1; what came before is discarded. */
static bool set_up(int fd, const char *path)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0) {
        log_error("%s is not a serial device: expected one like /dev/ttyUSB0, or a pty", path);
        return false;
    }
    line_make_raw(&settings);
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    if (cfsetspeed(&settings, B19200) != 0 || tcsetattr(fd, TCSANOW, &settings) != 0) {
        log_error("cannot set %s to 19200 baud, 8N1: %s", path, strerror(errno));
        return false;
    }
    tcflush(fd, TCIOFLUSH);
    return true;
}

/* Let the driver turn the line round. Returns false if it cannot. */
static bool set_driver(struct line *line)
{
    struct line_device *device = line->device;
    if (ioctl(line->fd, TIOCGRS485, &device->rs485) != 0)
        return false;
    struct serial_rs485 ours = device->rs485;
    ours.flags = (ours.flags & ~(__u32)(SER_RS485_RTS_AFTER_SEND | SER_RS485_RX_DURING_TX)) | SER_RS485_ENABLED |
                 SER_RS485_RTS_ON_SEND;
    ours.delay_rts_before_send = ours.delay_rts_after_send = 0;
    device->rs485_set = ioctl(line->fd, TIOCSRS485, &ours) == 0;
    return device->rs485_set;
}

/* Check that the driver of the line is switched. A pty has nothing to turn. */
static bool set_rts(struct line *line, const char *path, enum line_rts rts)
{
    int modem;
    line->is_wire = ioctl(line->fd, TIOCMGET, &modem) == 0;
    if (rts == LINE_RTS_TOGGLES) {
        line->toggles = ioctl(line->fd, TIOCMBIC, &(int){TIOCM_RTS}) == 0;
        if (!line->toggles)
            log_error("--rts toggles: %s has no RTS: %s", path, strerror(errno));
        return line->toggles;
    }
    if (line->is_wire && !set_driver(line))
        log_at(0, "the driver of %s has no RS485 mode: the adapter has to switch between sending and receiving; if it needs "
                  "RTS for that, give --rts toggles", path);
    return true;
}

bool line_serial_lower(struct line *line)
{
    int left, state;
    if (ioctl(line->fd, TIOCOUTQ, &left) == 0 && left > 0)
        return false;
    if (ioctl(line->fd, TIOCSERGETLSR, &state) == 0 && !(state & TIOCSER_TEMT))
        return false;
    ioctl(line->fd, TIOCMBIC, &(int){TIOCM_RTS});
    line->raised = false;
    return true;
}

void line_set_baud(const struct line *line, unsigned baud)
{
    line_settings_set_baud(line->fd, baud);
}

void line_serial_restore(struct line *line)
{
    if (line->raised)
        ioctl(line->fd, TIOCMBIC, &(int){TIOCM_RTS});
    if (line->device && line->device->rs485_set)
        ioctl(line->fd, TIOCSRS485, &line->device->rs485);
    line->raised = false;
    free(line->device);
    line->device = NULL;
}

bool line_serial_open(struct line *line, const char *path, enum line_rts rts)
{
    line_none(line);
    line->clients = 1;
    int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        log_error("cannot open %s: %s%s", path, strerror(errno),
                  errno == EACCES  ? "; is your user in the group dialout?"
                  : errno == ENOENT ? "; is the device plugged in, or the other program of the pty pair running?"
                                    : "");
        return false;
    }
    if (isatty(fd) && flock(fd, LOCK_EX | LOCK_NB) != 0) {
        log_error("%s is in use by another program: end that program, or choose another --port", path);
        close(fd);
        return false;
    }
    if (!set_up(fd, path)) {
        close(fd);
        return false;
    }
    line->fd = fd;
    line->device = calloc(1, sizeof *line->device);
    if (!line->device)
        log_error("out of memory");
    if (line->device && set_rts(line, path, rts))
        return true;
    line_close(line);
    return false;
}

#include "line.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "log.h"

/* Raw, 19200 baud, 8N1; what came before us is forgotten. */
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

bool line_serial_open(struct line *line, const char *path)
{
    *line = (struct line){.fd = -1, .notices = -1, .slave = -1, .clients = 1};
    int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        log_error("cannot open %s: %s%s", path, strerror(errno),
                  errno == EACCES  ? "; is your user in the group dialout?"
                  : errno == ENOENT ? "; is the device plugged in, or the other program of the pty pair running?"
                                    : "");
        return false;
    }
    if (isatty(fd) && flock(fd, LOCK_EX | LOCK_NB) != 0) {
        log_error("%s is in use by another program: end that one, or choose another --port", path);
        close(fd);
        return false;
    }
    if (!set_up(fd, path)) {
        close(fd);
        return false;
    }
    line->fd = fd;
    return true;
}

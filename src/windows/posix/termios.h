/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_TERMIOS_H
#define RKM04_WINDOWS_TERMIOS_H

#define TCOFLUSH 1
#define TCSANOW 0

typedef unsigned speed_t;

enum { B9600 = 9600, B19200 = 19200, B38400 = 38400, B57600 = 57600, B115200 = 115200 };

struct termios {
    speed_t speed;
};

int tcgetattr(int fd, struct termios *settings); /* fails if it is not a COM port */
int tcsetattr(int fd, int when, const struct termios *settings);
int cfsetspeed(struct termios *settings, speed_t speed);

/* Of the port that rkmctl has open (port.c). */
int tcflush(int fd, int which);
int tcdrain(int fd);

#endif

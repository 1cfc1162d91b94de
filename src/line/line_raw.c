/* SPDX-License-Identifier: MIT */
#include "line_raw.h"

#define INPUT_OFF (IGNBRK | BRKINT | PARMRK | INPCK | ISTRIP | INLCR | IGNCR | ICRNL | IXON | IXOFF | IXANY)
#define LOCAL_OFF (ECHO | ECHONL | ICANON | ISIG | IEXTEN)
#define CONTROL_OFF (CSIZE | PARENB | CSTOPB | CRTSCTS)
#define CONTROL_ON (CS8 | CREAD | CLOCAL)

bool line_is_cooked(const struct termios *settings)
{
    return (settings->c_iflag & INPUT_OFF) || (settings->c_oflag & OPOST) || (settings->c_lflag & LOCAL_OFF);
}

void line_make_uncooked(struct termios *settings)
{
    settings->c_iflag &= ~(tcflag_t)INPUT_OFF;
    settings->c_oflag &= ~(tcflag_t)OPOST;
    settings->c_lflag &= ~(tcflag_t)LOCAL_OFF;
}

void line_make_raw(struct termios *settings)
{
    line_make_uncooked(settings);
    settings->c_cflag = (settings->c_cflag & ~(tcflag_t)CONTROL_OFF) | CONTROL_ON;
}

/* SPDX-License-Identifier: MIT */
/* line_raw.h: settings of a terminal that passes bytes as they are. */
#ifndef RKM04_LINE_RAW_H
#define RKM04_LINE_RAW_H

#include <stdbool.h>
#include <termios.h>

/* Does the terminal do more than pass bytes: echo, edit lines, translate, obey XON and XOFF? */
bool line_is_cooked(const struct termios *settings);

/* No longer; all else stays. */
void line_make_uncooked(struct termios *settings);

/* Settings of a raw line with 8N1. Leaves speed and control characters alone. */
void line_make_raw(struct termios *settings);

#endif

/* SPDX-License-Identifier: MIT */
/* bus_pty.h: the pty of a bus, under its names: a link, and a COM port of Wine. */
#ifndef RKM04_BUS_PTY_H
#define RKM04_BUS_PTY_H

#include "bus_options.h"
#include "line/line.h"

struct bus_pty {
    struct link_path link; /* to the pty */
    struct wine_link wine; /* to `link` */
    uint32_t group, mode;  /* of the pty that is gone; its successor gets them; mode 0: there was none */
};

/* No names yet. bus_pty_release() is due from then on. */
void bus_pty_prepare(struct bus_pty *pty);

/* Take the names that the options ask for, for bus `number`. Failures are reported. Returns false if one cannot be had. */
bool bus_pty_claim(struct bus_pty *pty, const struct bus_options *options, unsigned number);

/* Let the names lead to the pty `line`. Failures are reported. Returns false if it did not work. */
bool bus_pty_publish(struct bus_pty *pty, const struct bus_options *options, const struct line *line);

/* The pty `line` goes away: remove its link, and remember for whom it was. */
void bus_pty_hide(struct bus_pty *pty, const struct line *line);

/* The new pty `line` is for whom the one before was for. */
void bus_pty_restore_access(const struct bus_pty *pty, const struct line *line);

/* Remove the names. */
void bus_pty_release(struct bus_pty *pty);

#endif

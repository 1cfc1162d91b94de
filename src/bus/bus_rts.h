/* SPDX-License-Identifier: MIT */
/* bus_rts.h: RTS of a serial device, which is on while the units send: it is switched off when the bytes are out. */
#ifndef RKM04_BUS_RTS_H
#define RKM04_BUS_RTS_H

#include <uv.h>

#include "line/line.h"

struct bus_rts {
    struct line *line;
    unsigned baud;       /* of the line */
    struct wake_timer timer;
    uint64_t sent_until; /* ns at which the device will have sent all */
};

/* Make the timer. *rts must be zero. Returns false if it did not work (reported). bus_rts_end() is due in either case. */
bool bus_rts_begin(struct bus_rts *rts, struct line *line, unsigned baud, uv_loop_t *loop);

/* RTS is on, `length` bytes have been written: switch it off when they are out. */
void bus_rts_lower_after(struct bus_rts *rts, size_t length);

/* Close the timer; RTS stays as it is. */
void bus_rts_end(struct bus_rts *rts);

#endif

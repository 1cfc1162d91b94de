/* SPDX-License-Identifier: MIT */
#include "bus_rts.h"

#define NS_PER_SECOND UINT64_C(1000000000)
#define BITS_PER_BYTE 10u
#define NS_PER_LOOK 200000u /* between two looks whether the device has sent all */

static void on_timer(void *context)
{
    struct bus_rts *rts = context;
    if (rts->line->raised && !line_serial_lower(rts->line))
        wake_timer_set(&rts->timer, uv_hrtime() + NS_PER_LOOK);
}

bool bus_rts_begin(struct bus_rts *rts, struct line *line, unsigned baud, uv_loop_t *loop)
{
    rts->line = line;
    rts->baud = baud;
    return wake_timer_open(&rts->timer, loop, on_timer, rts);
}

void bus_rts_lower_after(struct bus_rts *rts, size_t length)
{
    uint64_t now = uv_hrtime();
    if (rts->sent_until < now)
        rts->sent_until = now;
    rts->sent_until += (length * BITS_PER_BYTE * NS_PER_SECOND + rts->baud - 1u) / rts->baud;
    wake_timer_set(&rts->timer, rts->sent_until);
}

void bus_rts_end(struct bus_rts *rts)
{
    wake_timer_close(&rts->timer);
}

/* SPDX-License-Identifier: MIT */
/* Events are reported to the watchers of a sim. */
#include <stdarg.h>
#include <stdio.h>

#include "sim.h"

void sim_report(struct sim *sim, enum watch_phase phase, const struct watch_event *event)
{
    watch_add(&sim->watch, phase, event);
}

void sim_report_text(struct sim *sim, enum watch_phase phase, const struct watch_event *event, const char *format, ...)
{
    struct watch_event copy = *event;
    va_list list;
    if ((sim->watch.kinds & WATCH_BIT(event->kind)) == 0)
        return;
    va_start(list, format);
    char *text;
    int length = vasprintf(&text, format, list);
    va_end(list);
    if (length < 0)
        return;
    copy.text = text;
    watch_add(&sim->watch, phase, &copy);
}

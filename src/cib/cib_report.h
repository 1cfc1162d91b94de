/* SPDX-License-Identifier: MIT */
/* cib_report.h: what a unit reports to its port. */
#ifndef RKM04_CIB_CIB_REPORT_H
#define RKM04_CIB_CIB_REPORT_H

#include "cib.h"

static inline void report_event(const struct cib_unit *unit, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    if (unit->port->event)
        unit->port->event(unit->context, tick, axis, what, value);
}

static inline unsigned axis_of(const struct cib_unit *unit, const struct cib_drive *drive)
{
    return drive == unit->drive ? 1 : 2;
}

#endif

/* SPDX-License-Identifier: MIT */
/* reading.h: the readings of a unit (specification section 10). */
#ifndef RKM04_SRC_READING_H
#define RKM04_SRC_READING_H

#include <rkm04/unit.h>

/* The value of a reading; in a port without readings always the default, so that the other one costs nothing. */
#define READING(unit, name) (RKM04_READINGS ? (unit)->config.readings.name : 0u)

#endif

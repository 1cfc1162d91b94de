/* SPDX-License-Identifier: MIT */
/* reading.h: the readings of a unit (specification section 10). */
#ifndef RKM04_SRC_READING_H
#define RKM04_SRC_READING_H

#include <rkm04/unit.h>

/* The value of a reading, 0: the default; in a port without readings always the default, so that the other one costs nothing. Of
 * a reading with two values it is the condition for what the other one does: a comparison with its name costs flash. */
#define READING(unit, name) (RKM04_READINGS ? (unit)->config.readings.name : 0u)

#endif

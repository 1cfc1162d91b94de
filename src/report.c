/* SPDX-License-Identifier: MIT */
#include "report.h"

void report_single_steps(const struct rkm04_unit *unit, const struct rkm04_motor *motor, const uint64_t *tick, size_t count)
{
    void (*step)(void *, uint64_t, unsigned, int32_t) = unit->port->step;
    void *context = unit->context;
    uint32_t position = (uint32_t)motor->position, way = motor->motion.forward ? 1 : UINT32_MAX;
    unsigned number = motor_number(unit, motor);
    const uint64_t *const end = tick + count;
    for (ptrdiff_t i = -(ptrdiff_t)count; i != 0; i++) /* up to 0: no comparison a pulse */
        step(context, end[i], number, (int32_t)(position += way));
}

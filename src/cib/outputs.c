/* SPDX-License-Identifier: MIT */
#include "outputs.h"

#include "phase.h"
#include "pwm.h"

static const uint8_t mask_of_use[CIB_USES] = {0x03, 0x0c, 0xf0};

static unsigned outputs_with(const struct cib_unit *unit, enum cib_use use)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < CIB_USES; i++)
        if (unit->setup.use[i] == use)
            mask |= mask_of_use[i];
    return mask;
}

bool cib_has_drive(const struct cib_unit *unit, unsigned drive)
{
    return unit->setup.use[2 * drive] == CIB_USE_DRIVE;
}

enum cib_use cib_use_of(const struct cib_unit *unit, unsigned output)
{
    return (enum cib_use)unit->setup.use[output < 4 ? output / 2 : 2];
}

/* Pattern of a drive, at its place. */
static unsigned pattern_of(const struct cib_unit *unit, unsigned at)
{
    const struct cib_drive *drive = &unit->drive[at];
    if (!cib_has_drive(unit, at) || !drive->started || drive->off)
        return 0;
    const uint16_t mode = unit->setup.drive[at].mode;
    return (unsigned)phase_pattern(mode, drive->row == 0 ? phase_rows(mode) : drive->row) << 4 * at;
}

/* DO and drives. */
static unsigned steady_outputs(const struct cib_unit *unit)
{
    const unsigned on = (unsigned)(unit->outputs ^ unit->buttons) & outputs_with(unit, CIB_USE_DO);
    return on | pattern_of(unit, 0) | pattern_of(unit, 1);
}

static unsigned pwm_outputs(const struct cib_unit *unit, uint64_t tick)
{
    unsigned bipolar = 0;
    const unsigned mask = outputs_with(unit, CIB_USE_PWM);
    if (mask == 0)
        return 0;
    for (unsigned i = 0; i < CIB_USES; i++)
        if ((unit->setup.bipolar >> i & 1) != 0)
            bipolar |= mask_of_use[i];
    const unsigned levels = pwm_levels(unit, tick);
    return (levels & mask) | (~levels & mask & bipolar) << 8;
}

uint16_t outputs_at(const struct cib_unit *unit, uint64_t tick)
{
    return (uint16_t)(steady_outputs(unit) | pwm_outputs(unit, tick));
}

uint16_t cib_driven(const struct cib_unit *unit)
{
    return outputs_at(unit, unit->now);
}

void outputs_changed(struct cib_unit *unit, uint64_t tick)
{
    if (!unit->port->outputs)
        return;
    const uint16_t steady = (uint16_t)steady_outputs(unit);
    if (steady == unit->steady)
        return;
    unit->steady = steady;
    unit->port->outputs(unit->context, tick, (uint16_t)(steady | pwm_outputs(unit, tick)));
}

void outputs_find_edge(struct cib_unit *unit, uint64_t tick)
{
    unit->edge = unit->port->edges ? pwm_next_edge(unit, tick) : CIB_NEVER;
}

void outputs_attach(struct cib_unit *unit)
{
    unit->steady = (uint16_t)steady_outputs(unit);
    outputs_find_edge(unit, unit->now);
}

void outputs_pass_edge(struct cib_unit *unit, uint64_t tick)
{
    unit->port->edges(unit->context, tick, outputs_at(unit, tick + 1));
    outputs_find_edge(unit, tick + 1);
}

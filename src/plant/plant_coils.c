/* SPDX-License-Identifier: MIT */
/* plant_coils.c: a rotor that follows the field of its two coils.
 *
 * The rotor turns to where the field points, if that is less than half a turn away. Opposite to it there is no torque, and it
 * stands. So a motor with swapped leads turns back or stops, and one with a missing lead moves to and fro. */
#include "plant_model.h"

/* The field of coil currents -1, 0, 1 in eighths of a turn. */
static unsigned field_of(int a, int b)
{
    static const uint8_t fields[3][3] = {{5, 4, 3}, {6, PLANT_NO_FIELD, 2}, {7, 0, 1}};
    return fields[a + 1][b + 1];
}

/* The field of the motor's leads when those of the device have these levels, the first in bit 0. */
static unsigned field_at(const struct plant_motor *motor, unsigned levels)
{
    int lead[4];
    for (unsigned i = 0; i < 4; i++)
        lead[i] = motor->lead[i] > 0 ? (int)(levels >> (motor->lead[i] - 1u) & 1u) : 0;
    return field_of(lead[0] - lead[2], lead[1] - lead[3]);
}

static unsigned levels_of(const struct device_coils *coils, uint32_t outputs)
{
    unsigned levels = 0;
    for (unsigned i = 0; i < 4; i++)
        levels |= (outputs >> (coils->output[i] - 1u) & 1u) << i;
    return levels;
}

void coils_begin(struct plant_motor *motor, const struct device_coils *coils, uint32_t outputs)
{
    unsigned rest = field_at(motor, coils->rest), field = field_at(motor, levels_of(coils, outputs));
    motor->eighths = coils->eighths;
    motor->part = 0;
    motor->field = (uint8_t)field;
    motor->angle = (uint8_t)(field != PLANT_NO_FIELD ? field : rest != PLANT_NO_FIELD ? rest : 0);
}

int coils_turn(const struct plant_motor *motor, unsigned field, bool *opposite)
{
    int turn = field == PLANT_NO_FIELD ? 0 : (int)((field + 4u - motor->angle) & 7u) - 4;
    *opposite = turn == -4;
    return *opposite ? 0 : turn;
}

void plant_outputs(struct plant *plant, uint64_t tick, unsigned number, const struct device_coils *coils, uint32_t outputs)
{
    struct plant_motor *motor = &plant->motor[number - 1u];
    if (!motor->present)
        return;
    unsigned field = field_at(motor, levels_of(coils, outputs));
    motor->eighths = coils->eighths;
    if (field == motor->field)
        return;
    motor->field = (uint8_t)field;
    plant_queue(plant, tick, number, field);
}

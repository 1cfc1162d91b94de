/* SPDX-License-Identifier: MIT */
#include "phase.h"

#define BIPOLAR 1u /* bit of a mode (BT1) */
#define HALF_STEP 32u

bool phase_has_mode(uint16_t mode)
{
    const unsigned table = mode & ~BIPOLAR;
    return table == 16 || table == 20 || table == HALF_STEP;
}

unsigned phase_rows(uint16_t mode)
{
    return mode >= HALF_STEP ? 8 : 4;
}

uint16_t phase_pattern(uint16_t mode, unsigned row)
{
    /* The rows of the half step: the odd ones have one phase, the even ones two. */
    static const uint8_t half_step[] = {1, 3, 2, 6, 4, 12, 8, 9};
    const unsigned at = mode >= HALF_STEP ? row - 1 : 2 * (row - 1) + (mode >= 20);
    const unsigned on = half_step[at];
    return (uint16_t)(mode & BIPOLAR ? on | (15 - on) << 8 : on);
}

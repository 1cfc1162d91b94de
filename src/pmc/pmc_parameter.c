/* SPDX-License-Identifier: MIT */
/* The parameters of an axis (AP1). */
#include "pmc.h"

const struct pmc_parameter_row pmc_parameter_rows[PMC_PARAMETERS] = {
    [PMC_MULTIPLIER] = {"multiplier", 1, 500, 10, {0x044E, 0x0460}, false, false},
    [PMC_ACCELERATION] = {"acceleration", 1, 8000, 400, {0x044F, 0x0461}, false, false},
    [PMC_DECELERATION] = {"deceleration", 1, 8000, 400, {0x0450, 0x0462}, false, false},
    [PMC_START_SPEED] = {"start_speed", 1, 8000, 50, {0x0451, 0x0463}, false, false},
    [PMC_SPEED1] = {"speed1", 1, 8000, 10, {0x0452, 0x0464}, false, false},
    [PMC_SPEED2] = {"speed2", 1, 8000, 100, {0x0453, 0x0465}, false, false},
    [PMC_SPEED3] = {"speed3", 1, 8000, 1000, {0x0454, 0x0466}, false, false},
    [PMC_SPEED4] = {"speed4", 1, 8000, 8000, {0x0455, 0x0467}, false, false},
    [PMC_HOME_LOW] = {"home_low", 1, 8000, 20, {0x0480, 0x0488}, false, false},
    [PMC_HOME_HIGH] = {"home_high", 1, 8000, 1000, {0x0481, 0x0489}, false, false},
    [PMC_SOFT_PLUS] = {"limit_plus", -8388608, 8388607, 8388607, {0x0459, 0x046B}, true, false},
    [PMC_SOFT_MINUS] = {"limit_minus", -8388608, 8388607, -8388607, {0x045B, 0x046D}, true, false},
    [PMC_NUMERATOR] = {"numerator", 1, 65535, 1000, {0x045E, 0x0470}, false, false},
    [PMC_DENOMINATOR] = {"denominator", 1, 65535, 1000, {0x045F, 0x0471}, false, false},
    [PMC_TIMER1] = {"timer1", 0, 65535, 0, {0x0456, 0x0468}, false, false},
    [PMC_TIMER2] = {"timer2", 0, 65535, 0, {0x0457, 0x0469}, false, false},
    [PMC_TIMER3] = {"timer3", 0, 65535, 0, {0x0458, 0x046A}, false, false},
    [PMC_HOME_OFFSET] = {"home_offset", 0, 8388607, 0, {0x0482, 0x048A}, true, false},
    [PMC_FLAGS] = {"flags", 0, 0x01FF, 0x0123, {0x041C, 0x0421}, false, true},
    [PMC_STEPS] = {"steps", 0, 0x1FFF, 0x1F03, {0x041D, 0x0422}, false, true},
    [PMC_END_PULSE_WIDTH] = {"end_pulse_width", 1, 65535, 1, {0x045D, 0x046F}, false, false},
    [PMC_JERK] = {"jerk", 1, 65535, 1, {0x0472, 0x0473}, false, false},
};

void pmc_parameters_clear(struct pmc_parameters *parameters)
{
    for (unsigned i = 0; i < PMC_PARAMETERS; i++)
        parameters->value[i] = pmc_parameter_rows[i].standard;
}

int32_t pmc_parameter(const struct pmc_parameters *parameters, enum pmc_parameter which)
{
    if (which == PMC_DECELERATION && !(parameters->value[PMC_FLAGS] & PMC_FLAG_DECELERATION))
        which = PMC_ACCELERATION;
    return parameters->value[which];
}

bool pmc_parameter_put(struct pmc_parameters *parameters, enum pmc_parameter which, int32_t value)
{
    if ((unsigned)which >= PMC_PARAMETERS || value < pmc_parameter_rows[which].low || value > pmc_parameter_rows[which].high)
        return false;
    if (which == PMC_FLAGS && (value & PMC_FLAG_DECELERATION)) /* set where it followed: it keeps its present value */
        parameters->value[PMC_DECELERATION] = pmc_parameter(parameters, PMC_DECELERATION);
    parameters->value[which] = value;
    if (which == PMC_DECELERATION)
        parameters->value[PMC_FLAGS] |= PMC_FLAG_DECELERATION;
    return true;
}

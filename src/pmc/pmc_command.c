/* SPDX-License-Identifier: MIT */
/* What a program register may hold, and its units. */
#include "pmc.h"

#define VALUE_MIN (-83886080) /* tenths of a unit (AC1) */
#define VALUE_MAX 83886070
#define NUMBER_MAX 1          /* of inputs and outputs */

static bool is_between(int32_t value, int32_t low, int32_t high)
{
    return value >= low && value <= high;
}

bool pmc_command_valid(const struct pmc_command *command)
{
    if (command->op >= PMC_OPS)
        return false;
    const unsigned operands = pmc_command_rows[command->op].operands;
    const bool value = operands & PMC_OPERAND_VALUE, dwell = operands & PMC_OPERAND_DWELL;
    const bool number = operands & (PMC_OPERAND_INPUT | PMC_OPERAND_OUTPUT), wait = operands & PMC_OPERAND_WAIT;
    int32_t argument_low = 0, argument_high = 0, ms_low = 0, ms_high = 0;
    if (operands & PMC_OPERAND_STATE)
        argument_high = 1;
    if (operands & PMC_OPERAND_TARGET)
        argument_high = PMC_REGISTERS - 1;
    if (operands & PMC_OPERAND_COUNT)
        argument_low = 1, argument_high = UINT8_MAX;
    if (operands & PMC_OPERAND_MS)
        ms_low = 1, ms_high = UINT16_MAX;
    if (dwell && command->number == 0)
        ms_high = UINT16_MAX;
    return is_between(command->value, value ? VALUE_MIN : 0, value ? VALUE_MAX : 0) &&
           is_between(command->speed, value ? 1 : 0, value ? 4 : 0) && is_between(command->ms, ms_low, ms_high) &&
           is_between(command->argument, argument_low, argument_high) &&
           is_between(command->number, 0, dwell ? 3 : number ? NUMBER_MAX : 0) && (wait || !command->wait);
}

/* |number| * factor / divisor, rounded to the nearest, ties away from zero. */
static int64_t rounded(int64_t number, int64_t factor, int64_t divisor)
{
    const int64_t size = number < 0 ? -number : number, result = (2 * size * factor + divisor) / (2 * divisor);
    return number < 0 ? -result : result;
}

int64_t pmc_pulses_of(const struct pmc_parameters *parameters, int64_t tenths)
{
    return rounded(tenths, parameters->value[PMC_NUMERATOR], 10 * (int64_t)parameters->value[PMC_DENOMINATOR]);
}

int64_t pmc_tenths_of(const struct pmc_parameters *parameters, int64_t pulses)
{
    return rounded(pulses, 10 * (int64_t)parameters->value[PMC_DENOMINATOR], parameters->value[PMC_NUMERATOR]);
}

/* SPDX-License-Identifier: MIT */
#include "modbus_map.h"

#include "modbus/modbus.h"

#define COMMAND 0x0000u
#define BLOCK 0x0001u
#define BLOCK_END 0x0009u
#define SPEED 0x0484u      /* fifth speed of X; START follows */
#define START 0x0485u
#define Y_VALUES 8u        /* Y's are so much further */
#define PROGRAM 0x1000u
#define PROGRAM_AXIS 0x200u /* words of the registers of an axis */
#define INPUT_AXIS 0x10u
#define INPUT_WORDS 13u

static bool find_parameter(unsigned axes, uint16_t address, struct pmc_place *place)
{
    for (unsigned index = 0; index < PMC_PARAMETERS; index++) {
        const struct pmc_parameter_row *row = &pmc_parameter_rows[index];
        unsigned words = row->is_wide ? 2 : 1;
        for (unsigned axis = 0; axis < axes; axis++) {
            unsigned word = (unsigned)address - row->address[axis];
            if (word >= words)
                continue;
            *place = (struct pmc_place){PMC_PLACE_PARAMETER, (uint8_t)axis, (uint8_t)index, (uint8_t)word, (uint8_t)words};
            return true;
        }
    }
    return false;
}

static struct pmc_place program_place(unsigned address)
{
    unsigned at = address - PROGRAM, axis = at / PROGRAM_AXIS, index = at % PROGRAM_AXIS / PMC_REGISTER_WORDS;
    return (struct pmc_place){PMC_PLACE_REGISTER, (uint8_t)axis, (uint8_t)index, (uint8_t)(at % PMC_REGISTER_WORDS),
                              PMC_REGISTER_WORDS};
}

struct pmc_place pmc_holding_place(const struct pmc_unit *unit, uint16_t address)
{
    unsigned axes = unit->config.axes;
    struct pmc_place place = {.kind = PMC_PLACE_NONE, .words = 1};
    if (address == COMMAND)
        place.kind = PMC_PLACE_COMMAND;
    else if (address <= BLOCK_END)
        place.kind = PMC_PLACE_BLOCK;
    else if (address >= PROGRAM && address < PROGRAM + axes * PROGRAM_AXIS)
        return program_place(address);
    else if (find_parameter(axes, address, &place))
        return place;
    for (unsigned axis = 0; axis < axes; axis++) {
        place.axis = (uint8_t)axis;
        if (address == SPEED + axis * Y_VALUES)
            place.kind = PMC_PLACE_SPEED;
        else if (address == START + axis * Y_VALUES)
            place.kind = PMC_PLACE_START;
        else
            continue;
        return place;
    }
    return place;
}

/* ---- Values ------------------------------------------------------------------------------------------------------------- */

static uint16_t high_or_low(uint32_t value, unsigned word, unsigned words)
{
    return (uint16_t)(word + 1u < words ? value >> 16 : value);
}

static uint16_t command_word(const struct pmc_command *command, unsigned word)
{
    const uint16_t words[PMC_REGISTER_WORDS] = {
        command->op, (uint16_t)((uint32_t)command->value >> 16), (uint16_t)command->value, command->speed,
        command->ms, command->argument, command->number, command->wait ? 1 : 0};
    return words[word];
}

uint16_t pmc_read_holding(const struct pmc_unit *unit, const struct pmc_place *place)
{
    const struct pmc_axis *axis = &unit->axis[place->axis];
    uint32_t value;
    switch ((enum pmc_place_kind)place->kind) {
    case PMC_PLACE_PARAMETER:
        value = (uint32_t)pmc_parameter(&axis->parameters, (enum pmc_parameter)place->index);
        return high_or_low(value, place->word, place->words);
    case PMC_PLACE_SPEED:
        return axis->speed;
    case PMC_PLACE_START:
        return unit->start[place->axis];
    case PMC_PLACE_REGISTER:
        return command_word(&axis->program[place->index], place->word);
    default:
        return 0; /* AB4: reads 0 */
    }
}

int32_t pmc_signed_words(const uint8_t *words)
{
    uint32_t value = (uint32_t)modbus_word(words) << 16 | modbus_word(words + 2);
    return value <= INT32_MAX ? (int32_t)value : -(int32_t)(UINT32_MAX - value) - 1;
}

static int32_t value_of(const struct pmc_place *place, const uint8_t *words)
{
    return place->words == 1 ? modbus_word(words) : pmc_signed_words(words);
}

/* A program register from its words. Returns false if a word is more than its member can be. */
static bool command_of(const uint8_t *words, struct pmc_command *command)
{
    uint16_t op = modbus_word(words), speed = modbus_word(words + 6), argument = modbus_word(words + 10);
    uint16_t number = modbus_word(words + 12), flags = modbus_word(words + 14);
    *command = (struct pmc_command){
        .op = (uint8_t)op, .value = pmc_signed_words(words + 2), .speed = (uint8_t)speed, .ms = modbus_word(words + 8),
        .argument = (uint8_t)argument, .number = (uint8_t)number, .wait = flags == 1};
    return op <= UINT8_MAX && speed <= UINT8_MAX && argument <= UINT8_MAX && number <= UINT8_MAX && flags <= 1;
}

bool pmc_is_holding_value(const struct pmc_place *place, const uint8_t *words)
{
    const struct pmc_parameter_row *row;
    struct pmc_command command;
    int32_t value = value_of(place, words);
    switch ((enum pmc_place_kind)place->kind) {
    case PMC_PLACE_PARAMETER:
        row = &pmc_parameter_rows[place->index];
        return value >= row->low && value <= row->high;
    case PMC_PLACE_SPEED:
        return value >= 1 && value <= PMC_SPEED_MAX;
    case PMC_PLACE_START:
        return value < (int32_t)PMC_REGISTERS;
    default:
        return command_of(words, &command) && pmc_command_valid(&command);
    }
}

enum pmc_answer pmc_write_holding(struct pmc_unit *unit, const struct pmc_place *place, const uint8_t *words)
{
    struct pmc_command command;
    struct pmc_request request = {.kind = PMC_SET_SPEED, .axes = (uint8_t)(1u << place->axis)};
    switch ((enum pmc_place_kind)place->kind) {
    case PMC_PLACE_PARAMETER:
        return pmc_set_parameter(unit, place->axis, (enum pmc_parameter)place->index, value_of(place, words));
    case PMC_PLACE_SPEED:
        request.value[place->axis] = modbus_word(words);
        return pmc_request(unit, &request);
    case PMC_PLACE_START:
        unit->start[place->axis] = (uint8_t)modbus_word(words);
        return PMC_OK;
    default:
        (void)command_of(words, &command);
        return pmc_set_command(unit, place->axis, place->index, &command);
    }
}

/* ---- Input registers (AB6) ---------------------------------------------------------------------------------------------- */

bool pmc_has_input(const struct pmc_unit *unit, uint16_t address)
{
    return address / INPUT_AXIS < unit->config.axes && address % INPUT_AXIS < INPUT_WORDS;
}

uint16_t pmc_read_input(const struct pmc_unit *unit, uint16_t address)
{
    struct pmc_axis_state state;
    pmc_axis_state(unit, address / INPUT_AXIS, &state);
    const uint16_t words[INPUT_WORDS] = {
        high_or_low((uint32_t)state.commanded, 0, 2), high_or_low((uint32_t)state.commanded, 1, 2),
        high_or_low((uint32_t)state.actual, 0, 2), high_or_low((uint32_t)state.actual, 1, 2),
        high_or_low(state.speed, 0, 2), high_or_low(state.speed, 1, 2),
        (uint16_t)state.state, (uint16_t)state.reg, state.errors, state.inputs, state.outputs,
        (uint16_t)((state.homed ? 1u : 0u) + (state.not_homed ? 2u : 0u) + (state.moving ? 4u : 0u)), state.repetitions};
    return words[address % INPUT_AXIS];
}

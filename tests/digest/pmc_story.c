/* SPDX-License-Identifier: MIT */
/* The dice are thrown at most once in a list of arguments or values: compilers work those out in any order. */
#include "pmc_story.h"

#include "text.h"

#define ACTS_MAX 40u
#define PROGRAM_LENGTH 20u
#define SLOT ((uint64_t)PMC_SLOT_TICKS)

/* What is done to the unit at a tick. */
struct act {
    uint64_t tick;
    uint16_t inputs;
    bool stores; /* axis X */
    struct pmc_request request;
};

static struct pmc_unit unit, copy;
static struct pmc_digest *digest;
static struct act act[ACTS_MAX];
static unsigned acts;
static uint64_t dice, cut_dice, end_tick, quiet_until;
static uint8_t flash[PMC_FLASH_BLOCKS][PMC_FLASH_BLOCK_SIZE];

/* splitmix64 */
static uint64_t draw_from(uint64_t *state, uint64_t below)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return (z ^ z >> 31) % below;
}

static uint32_t draw(uint32_t below)
{
    return (uint32_t)draw_from(&dice, below);
}

/* ---- What the unit does -------------------------------------------------------------------------------------------------- */

static void add(uint64_t *lane, uint64_t tick, unsigned what, uint32_t value)
{
    mix(lane, tick << 8 | what);
    mix(lane, value);
    digest->reports++;
    digest->early += tick < quiet_until;
}

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context;
    uint32_t place = (uint32_t)position;
    for (size_t i = 0; i < count; i++, place += forward ? 1 : UINT32_MAX)
        add(&digest->axis[axis], tick[i], 1, place);
    digest->pulses += (uint32_t)count;
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    (void)context;
    add(&digest->axis[axis], tick, 2, forward);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    add(&digest->outputs, tick, 3, mask);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum pmc_event what, uint32_t value)
{
    (void)context;
    add(&digest->axis[axis], tick, 4 + (unsigned)what, value);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    uint8_t *to = data;
    (void)context;
    for (unsigned i = 0; i < length; i++)
        to[i] = flash[block][offset + i];
    return 0;
}

static int on_flash_erase(void *context, unsigned block)
{
    (void)context;
    for (unsigned i = 0; i < PMC_FLASH_BLOCK_SIZE; i++)
        flash[block][i] = 0xFF;
    return 0;
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const uint8_t *from = data;
    (void)context;
    for (unsigned i = 0; i < length; i++) {
        flash[block][offset + i] &= from[i];
        mix(&digest->flash, (uint64_t)offset << 32 | i << 8 | flash[block][offset + i]);
    }
    return 0;
}

static const struct pmc_port
    loud = {on_steps, on_direction, on_outputs, on_event, on_flash_read, on_flash_erase, on_flash_program},
    quiet = {NULL, on_direction, on_outputs, on_event, on_flash_read, on_flash_erase, on_flash_program};

/* ---- A story --------------------------------------------------------------------------------------------------------------- */

static struct pmc_command random_command(void)
{
    struct pmc_command command = {.op = (uint8_t)draw(PMC_OPS)};
    const unsigned operands = pmc_command_rows[command.op].operands;
    if (operands & PMC_OPERAND_VALUE)
        command.value = (int32_t)draw(4000) - 2000;
    if (operands & PMC_OPERAND_SPEED)
        command.speed = (uint8_t)(1 + draw(4));
    if (operands & (PMC_OPERAND_MS | PMC_OPERAND_DWELL))
        command.ms = (uint16_t)(1 + draw(20));
    if (operands & PMC_OPERAND_STATE)
        command.argument = (uint8_t)draw(2);
    if (operands & PMC_OPERAND_TARGET)
        command.argument = (uint8_t)draw(PROGRAM_LENGTH);
    if (operands & PMC_OPERAND_COUNT)
        command.argument = (uint8_t)(1 + draw(4));
    if (operands & (PMC_OPERAND_INPUT | PMC_OPERAND_OUTPUT))
        command.number = (uint8_t)draw(2);
    return command;
}

static void make_request(struct pmc_request *request)
{
    request->kind = (uint8_t)draw(PMC_RESET + 1);
    if (request->kind == PMC_RESET && draw(4) != 0)
        request->kind = PMC_SET_SPEED;
    request->axes = (uint8_t)(1 + draw(3));
    for (unsigned i = 0; i < PMC_AXES; i++) {
        request->value[i] = (int32_t)draw(2000) - 1000;
        if (request->kind == PMC_RUN)
            request->value[i] = (int32_t)draw(10);
        if (request->kind == PMC_SET_SPEED)
            request->value[i] = 1 + (int32_t)draw(draw(2) != 0 ? 100 : 4000);
    }
}

static void make_acts(void)
{
    uint64_t tick = 0;
    acts = 5 + draw(ACTS_MAX - 5);
    for (unsigned i = 0; i < acts; i++) {
        tick += draw(3) != 0 ? draw(60 * PMC_SLOT_TICKS) : SLOT * draw(9);
        if (draw(4) == 0) /* next to a slot */
            tick = (tick + SLOT - 1) / SLOT * SLOT + draw(3);
        act[i].tick = tick;
        act[i].inputs = (uint16_t)draw(1u << 15);
        act[i].inputs &= (uint16_t)draw(1u << 15);
        act[i].inputs &= (uint16_t)draw(1u << 15);
        if (draw(4) != 0)
            act[i].inputs &= (uint16_t)~PMC_EMG;
        act[i].stores = draw(8) == 0;
        make_request(&act[i].request);
    }
    end_tick = tick + 300 * SLOT;
}

static void set_up(struct pmc_axis *axis)
{
    int32_t *value = axis->parameters.value;
    value[PMC_MULTIPLIER] = 1 + (int32_t)draw(40);
    value[PMC_START_SPEED] = 1 + (int32_t)draw(400);
    value[PMC_ACCELERATION] = 1 + (int32_t)draw(3000);
    if (draw(2) != 0)
        pmc_parameter_put(&axis->parameters, PMC_DECELERATION, 1 + (int32_t)draw(3000));
    value[PMC_FLAGS] ^= (int32_t)draw(4);
    value[PMC_FLAGS] ^= draw(2) != 0 ? PMC_FLAG_SOFT_LIMITS : 0;
    value[PMC_SOFT_PLUS] = (int32_t)draw(3000);
    value[PMC_NUMERATOR] = 1 + (int32_t)draw(2000);
    value[PMC_STEPS] = 0x1F00 + (int32_t)draw(256);
    value[PMC_HOME_OFFSET] = (int32_t)draw(100);
    for (unsigned i = 0; i < PROGRAM_LENGTH; i++)
        axis->program[i] = random_command();
}

/* ---- Runs ------------------------------------------------------------------------------------------------------------ */

static void advance_to(uint64_t tick, enum pmc_way way)
{
    while (pmc_now(&unit) < tick) {
        const uint64_t most = tick - pmc_now(&unit);
        uint64_t ticks = most;
        quiet_until = 0;
        if (way == PMC_WAY_IN_PIECES)
            ticks = 1 + draw_from(&cut_dice, draw_from(&cut_dice, 3) != 0 ? 20000 : 3);
        if (way == PMC_WAY_BY_EVENTS) {
            const uint64_t event = pmc_next_event(&unit);
            digest->early += event < pmc_now(&unit);
            ticks = event > pmc_now(&unit) ? event - pmc_now(&unit) : 1;
            quiet_until = event;
        }
        pmc_advance(&unit, ticks < most ? ticks : most);
        if (way == PMC_WAY_COPIED) {
            copy = unit;
            pmc_init(&unit, &copy.config, copy.port, NULL); /* anything else */
            unit = copy;
        }
    }
}

static void look_at(unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(&unit, axis, &state);
    const uint32_t seen[] = {
        (uint32_t)state.commanded, (uint32_t)state.actual, state.speed, state.made, (uint32_t)state.state, state.driving,
        (uint32_t)state.reg, state.errors, state.inputs, state.outputs, state.homed, state.not_homed,
        state.moving, state.stopping, state.forward, state.endless, state.repetitions, state.fifth,
    };
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++)
        mix(&digest->end, seen[i]);
    for (unsigned i = 0; i < PMC_PARAMETERS; i++)
        mix(&digest->end, (uint32_t)pmc_parameter(&unit.axis[axis].parameters, (enum pmc_parameter)i));
}

void pmc_story(unsigned number, enum pmc_way way, struct pmc_digest *to)
{
    const struct pmc_config config = {.axes = 2, .passes = number % 2 != 0, .refuse = number % 3 == 0};
    digest = to;
    *digest = (struct pmc_digest){.pulses = 0};
    dice = number;
    cut_dice = 1000000 + number;
    quiet_until = 0;
    for (unsigned block = 0; block < PMC_FLASH_BLOCKS; block++)
        on_flash_erase(NULL, block);
    make_acts();
    pmc_init(&unit, &config, way == PMC_WAY_UNSEEN ? &quiet : &loud, NULL);
    for (unsigned i = 0; i < PMC_AXES; i++)
        set_up(&unit.axis[i]);
    for (unsigned i = 0; i < acts; i++) {
        advance_to(act[i].tick, way);
        pmc_set_inputs(&unit, act[i].inputs);
        mix(&digest->end, (uint64_t)pmc_request(&unit, &act[i].request));
        if (act[i].stores)
            mix(&digest->end, (uint64_t)pmc_store(&unit, 0));
    }
    advance_to(end_tick, way);
    for (unsigned i = 0; i < PMC_AXES; i++)
        look_at(i);
}

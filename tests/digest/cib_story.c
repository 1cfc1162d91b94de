/* SPDX-License-Identifier: MIT */
/* The dice are thrown at most once in a list of arguments or values: compilers work those out in any order. */
#include "cib_story.h"

#include "text.h"

#define ACTS_MAX 40
#define DRIVE_A 0x10
#define DRIVE_B 0x20

static struct cib_unit unit;
static struct cib_digest *digest;
static uint64_t dice, cut_dice;
static enum cib_cut how;
static enum cib_seen seen;

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

static uint32_t between(uint32_t least, uint32_t most)
{
    return least + draw(most - least + 1);
}

/* ---- What the unit does -------------------------------------------------------------------------------------------------- */

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context;
    uint32_t place = (uint32_t)position;
    for (size_t i = 0; i < count; i++, place += forward ? 1 : UINT32_MAX) {
        mix(&digest->drive[axis - 1], tick[i]);
        mix(&digest->drive[axis - 1], place);
    }
    digest->pulses += (uint32_t)count;
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    (void)context;
    mix(&digest->drive[axis - 1], tick << 1 | forward);
}

static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    (void)context;
    mix(&digest->outputs, tick);
    mix(&digest->outputs, driven);
}

static void on_edges(void *context, uint64_t tick, uint16_t driven)
{
    on_outputs(context, tick, driven);
    digest->edges++;
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    (void)context;
    const bool of_drive = axis > 0 && what != CIB_EVENT_DUTY;
    uint64_t *lane = of_drive ? &digest->drive[axis - 1] : &digest->unit;
    mix(lane, tick << 8 | (uint64_t)axis << 4 | (uint64_t)what);
    mix(lane, value);
}

static const struct cib_port all = {on_steps, on_direction, on_outputs, NULL, on_event};
static const struct cib_port all_edges = {on_steps, on_direction, on_outputs, on_edges, on_event};
static const struct cib_port steps = {on_steps, on_direction, NULL, NULL, on_event};
static const struct cib_port reports = {NULL, on_direction, NULL, NULL, on_event};

static const struct cib_port *port_of(bool edges)
{
    if (seen == CIB_SEEN_ALL)
        return edges ? &all_edges : &all;
    return seen == CIB_SEEN_STEPS ? &steps : &reports;
}

/* ---- Time ---------------------------------------------------------------------------------------------------------- */

static void pass_events(uint64_t until)
{
    while (cib_now(&unit) < until) {
        const uint64_t next = seen == CIB_SEEN_REPORTS ? cib_next_report(&unit) : cib_next_event(&unit);
        cib_advance(&unit, next < until ? next + 1 - cib_now(&unit) : until - cib_now(&unit));
    }
}

static void pass(uint64_t ticks)
{
    const uint64_t until = cib_now(&unit) + ticks;
    if (how == CIB_CUT_EVENTS) {
        pass_events(until);
        return;
    }
    while (how == CIB_CUT_RANDOM && cib_now(&unit) < until) {
        const uint64_t left = until - cib_now(&unit), most = left < 60000 ? left : 60000;
        cib_advance(&unit, 1 + draw_from(&cut_dice, most));
    }
    cib_advance(&unit, until - cib_now(&unit));
}

/* Zero, a few ticks, to a slot, or up to a second. */
static uint64_t draw_pause(void)
{
    const uint32_t kind = draw(8);
    if (kind == 0)
        return 0;
    if (kind == 1)
        return CIB_SLOT_TICKS - cib_now(&unit) % CIB_SLOT_TICKS;
    return draw(kind < 4 ? 3000 : kind < 6 ? 60000 : 700000);
}

/* ---- Acts ---------------------------------------------------------------------------------------------------------- */

static void write(uint16_t address, uint16_t value)
{
    mix(&digest->unit, (uint64_t)cib_write(&unit, address, &value, 1));
}

static void give_command(void)
{
    static const uint16_t numbers[] = {101, 101, 102, 102, 105, 105, 105, 108, 109, 9, 11, 12, 13, 14, 100, 0, 7};
    static const uint16_t speeds[] = {5, 50, 97, 100, 300, 500, 1000, 1001, 4};
    const uint16_t address = draw(3) == 0 ? DRIVE_B : DRIVE_A, number = numbers[draw(sizeof numbers / sizeof *numbers)];
    const uint16_t speed = speeds[draw(draw(4) == 0 ? 9 : 7)];
    const bool back = draw(2) == 0;
    uint32_t p1 = draw(number == 100 || draw(20) == 0 ? UINT32_MAX : 700);
    if (number == 105)
        p1 = draw(8) == 0 ? 0 : speed;
    else if (number == 9)
        p1 = draw(5) == 0 ? 0 : 1;
    else if (number == 11)
        p1 = speed;
    else if (number > 11 && number < 15)
        p1 = between(4, 241);
    if (number >= 100 && back)
        p1 = 0 - p1;
    const uint16_t words[] = {(uint16_t)(cib_read(&unit, CIB_OUTPUT_ZONE, address) + 1), number, (uint16_t)(p1 >> 16),
                              (uint16_t)p1, speed};
    mix(&digest->unit, (uint64_t)cib_write(&unit, address, words, 5));
}

/* Write a random value to one of a few registers. */
static void write_one(uint16_t first, uint16_t stride, uint32_t registers, uint32_t least, uint32_t most)
{
    const uint32_t at = draw(registers);
    const uint32_t value = between(least, most);
    write((uint16_t)(first + stride * at), (uint16_t)value);
}

static void change_setup(void)
{
    static const uint16_t modes[] = {16, 17, 20, 21, 32, 33, 18};
    const uint16_t first = (uint16_t)draw(3);
    const uint16_t second = first == 2 ? 2 : (uint16_t)draw(2);
    const uint16_t uses[] = {first, second, (uint16_t)draw(3)};
    mix(&digest->unit, (uint64_t)cib_write(&unit, 0x101, uses, 3));
    write_one(0x104, 2, 3, 0, 15);
    write_one(0x105, 2, 3, 100, 50000);
    write_one(0x10a, 1, 1, 0, 7);
    write_one(0x10b, 1, 1, 0, 255);
    write_one(0x111, 0x10, 2, 5, 300);
    const uint16_t drive = (uint16_t)(0x110 + 0x10 * draw(2));
    write(drive, modes[draw(7)]);
    write(0x100, 1);
}

static void watch_edges(void)
{
    cib_attach(&unit, port_of(true), NULL);
    pass(draw(4000));
    cib_attach(&unit, port_of(false), NULL);
}

static void do_act(void)
{
    switch (draw(16)) {
    case 0:
        change_setup();
        break;
    case 1:
        cib_set_inputs(&unit, (uint8_t)draw(256));
        break;
    case 2:
        cib_set_buttons(&unit, (uint8_t)draw(256));
        break;
    case 3:
        write(0, (uint16_t)draw(256));
        break;
    case 4: {
        const uint8_t mask = (uint8_t)draw(256);
        cib_write_coils(&unit, mask, (uint8_t)draw(256));
        break;
    }
    case 5: {
        const uint16_t output = (uint16_t)between(1, 8);
        write(output, (uint16_t)draw(10002));
        break;
    }
    case 6:
        watch_edges();
        break;
    default:
        give_command();
    }
    if (draw(3) != 0)
        cib_note_request(&unit);
}

/* ---- A story ------------------------------------------------------------------------------------------------------- */

static void mix_registers(void)
{
    for (uint16_t address = 0; address < 0x130; address++) {
        mix(&digest->end, cib_read(&unit, CIB_OUTPUT_ZONE, address));
        mix(&digest->end, cib_read(&unit, CIB_INPUT_ZONE, address));
    }
    mix(&digest->end, cib_now(&unit));
    if (seen != CIB_SEEN_REPORTS)
        mix(&digest->end, cib_next_event(&unit));
}

void cib_story(unsigned number, enum cib_cut cut, enum cib_seen what, struct cib_digest *into)
{
    static const int8_t errors[] = {0, 0, 0, 10, -10, 20, -20, 1};
    struct cib_config config = cib_default_config;
    *into = (struct cib_digest){.pulses = 0};
    digest = into;
    how = cut;
    seen = what;
    dice = number;
    cut_dice = number + UINT64_C(1000000);
    config.firmware = draw(5) == 0 ? CIB_FIRMWARE_1_1 : CIB_FIRMWARE_1_2;
    config.idle_off = draw(3) == 0 ? between(1, 300) : 0;
    config.comm_timeout = draw(3) == 0 ? between(100, 1500) : 0;
    config.acc_unit = draw(4) == 0 ? 100 : 1;
    config.brake_error = errors[draw(8)];
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        config.setup.drive[i].deceleration_max = (uint16_t)between(20, 240);
    cib_begin(&unit, &config, port_of(false), NULL);
    for (unsigned acts = between(5, ACTS_MAX); acts > 0; acts--) {
        do_act();
        pass(draw_pause());
        mix(&digest->end, cib_driven(&unit));
    }
    mix_registers();
}

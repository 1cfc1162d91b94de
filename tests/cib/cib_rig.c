/* SPDX-License-Identifier: MIT */
#include "cib_rig.h"

#include <check.h>
#include <inttypes.h>

#define PULSES_MAX 600000
#define CHANGES_MAX 20000
#define KINDS (CIB_EVENT_TIMEOUT + 1)

struct change {
    uint64_t tick;
    uint32_t value;
};

struct changes {
    unsigned count;
    struct change change[CHANGES_MAX];
};

struct cib_unit cib;
const struct cib_config cib_example = {.setup = {.use = {CIB_USE_DRIVE, CIB_USE_DRIVE, CIB_USE_DRIVE},
                                                 .period = {1000, 1000, 1000},
                                                 .active = 0xff,
                                                 .drive = {{20, 100, 1000, 200, 100, 1}, {20, 100, 1000, 200, 100, 1}}},
                                       .firmware = CIB_FIRMWARE_1_2,
                                       .acc_unit = 1};

static struct {
    uint64_t tick;
    int32_t position;
    uint16_t driven;
} pulse[PULSES_MAX];
static unsigned count;
static struct changes status, driven, edge;
static unsigned happened[KINDS];
static uint32_t last_value[KINDS];
static uint64_t last_tick;

static void keep(struct changes *changes, uint64_t tick, uint32_t value)
{
    ck_assert_uint_lt(changes->count, CHANGES_MAX);
    changes->change[changes->count++] = (struct change){tick, value};
}

/* Everything comes in the order of ticks. */
static void keep_order(uint64_t tick)
{
    ck_assert_uint_le(last_tick, tick);
    last_tick = tick;
}

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t steps, int32_t first, bool forward)
{
    (void)context;
    keep_order(tick[0]);
    for (size_t i = 0; axis == 1 && i < steps; i++) {
        const uint32_t on = (uint32_t)i;
        ck_assert_uint_lt(count, PULSES_MAX);
        pulse[count].tick = tick[i];
        pulse[count].driven = 0;
        pulse[count++].position = (int32_t)(forward ? (uint32_t)first + on : (uint32_t)first - on);
    }
}

static void on_outputs(void *context, uint64_t tick, uint16_t now)
{
    (void)context;
    keep_order(tick);
    if (count > 0 && pulse[count - 1].tick == tick)
        pulse[count - 1].driven = now;
    if (driven.count < CHANGES_MAX)
        keep(&driven, tick, now);
}

static void on_edges(void *context, uint64_t tick, uint16_t now)
{
    (void)context;
    keep_order(tick);
    keep(&edge, tick, now);
}

static void on_event(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    (void)context;
    keep_order(tick);
    happened[what]++;
    last_value[what] = value;
    if (what == CIB_EVENT_STATUS && axis == 1)
        keep(&status, tick, value);
}

static const struct cib_port all = {.steps = on_steps, .outputs = on_outputs, .edges = on_edges, .event = on_event},
                             steps_only = {.steps = on_steps, .event = on_event}, nothing = {.steps = NULL};

void cib_see(enum seen seen)
{
    cib_attach(&cib, seen == SEEN_ALL ? &all : seen == SEEN_STEPS ? &steps_only : &nothing, NULL);
}

void cib_power_up(const struct cib_config *config)
{
    count = status.count = driven.count = edge.count = 0;
    last_tick = 0;
    for (unsigned i = 0; i < KINDS; i++)
        happened[i] = last_value[i] = 0;
    cib_begin(&cib, config, &all, NULL);
}

void cib_advance_to(uint64_t tick)
{
    ck_assert_uint_ge(tick, cib_now(&cib));
    cib_advance(&cib, tick - cib_now(&cib));
    ck_assert_uint_eq(cib_now(&cib), tick);
}

void at(int64_t t)
{
    cib_advance_to((uint64_t)(BASE + t));
}

uint16_t in(uint16_t address)
{
    ck_assert(cib_has_register(CIB_INPUT_ZONE, address));
    return cib_read(&cib, CIB_INPUT_ZONE, address);
}

uint16_t out(uint16_t address)
{
    ck_assert(cib_has_register(CIB_OUTPUT_ZONE, address));
    return cib_read(&cib, CIB_OUTPUT_ZONE, address);
}

int32_t position(void)
{
    return (int32_t)((uint32_t)in(0x13) << 16 | in(0x14));
}

void set(uint16_t address, uint16_t value)
{
    ck_assert_int_eq(cib_write(&cib, address, &value, 1), CIB_DONE);
}

void command(enum drive_name drive, uint16_t number, int32_t p1, uint16_t p2)
{
    const uint16_t address = drive == A ? 0x10 : 0x20;
    const uint16_t words[] = {(uint16_t)(out(address) + 1), number, (uint16_t)((uint32_t)p1 >> 16), (uint16_t)p1, p2};
    ck_assert_int_eq(cib_write(&cib, address, words, 5), CIB_DONE);
    ck_assert_uint_eq(in(address), words[0]); /* ACK */
}

/* ---- What has been kept ---- */

unsigned pulses(void)
{
    return count;
}

static void expect_tick(const char *what, int64_t number, uint64_t tick, int64_t t, int64_t late)
{
    const int64_t came = (int64_t)tick - BASE;
    if (came < t - late || came > t + late)
        ck_abort_msg("%s %" PRId64 " came at %" PRId64 ", expected %" PRId64, what, number, came, t);
}

void expect_pulse(unsigned number, int64_t t, int64_t late)
{
    ck_assert_uint_le(number, count);
    expect_tick("pulse", number, pulse[number - 1].tick, t, late);
}

void expect_reached(int32_t place, int64_t t, int64_t late)
{
    unsigned i = count;
    while (i > 0 && pulse[i - 1].position != place)
        i--;
    ck_assert_msg(i > 0, "position %" PRId32 " was never reached", place);
    expect_tick("position", place, pulse[i - 1].tick, t, late);
}

void expect_position(int64_t t, int32_t place)
{
    int32_t then = 0;
    for (unsigned i = 0; i < count && pulse[i].tick <= (uint64_t)(BASE + t); i++)
        then = pulse[i].position;
    ck_assert_int_eq(then, place);
}

static uint32_t value_at(const struct changes *changes, int64_t t, uint32_t before)
{
    for (unsigned i = 0; i < changes->count && changes->change[i].tick <= (uint64_t)(BASE + t); i++)
        before = changes->change[i].value;
    return before;
}

void expect_status(int64_t t, unsigned expected)
{
    const unsigned then = value_at(&status, t, CIB_RAMP);
    if (then != expected)
        ck_abort_msg("MCSTAT at %" PRId64 " is %02X, expected %02X", t, then, expected);
}

void expect_driven(int64_t t, unsigned expected)
{
    ck_assert_uint_eq(value_at(&driven, t, 0), expected);
}

void expect_speed(int32_t speed)
{
    struct cib_drive_state state;
    cib_drive_state(&cib, A, &state);
    ck_assert_int_eq(state.speed, speed);
}

unsigned driven_at_pulse(unsigned number)
{
    ck_assert_uint_le(number, count);
    return pulse[number - 1].driven;
}

unsigned edges(void)
{
    return edge.count;
}

uint64_t edge_tick(unsigned n)
{
    ck_assert_uint_lt(n, edge.count);
    return edge.change[n].tick;
}

uint16_t edge_driven(unsigned n)
{
    ck_assert_uint_lt(n, edge.count);
    return (uint16_t)edge.change[n].value;
}

unsigned events(enum cib_event what)
{
    return happened[what];
}

uint32_t last_event(enum cib_event what)
{
    return last_value[what];
}

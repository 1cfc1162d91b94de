/* SPDX-License-Identifier: MIT */
#include "motion_rig.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char what[1200];
static uint64_t *ticks;

/* ---- Port --------------------------------------------------------------------------------------------------------- */

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    struct motion_rig *rig = context;
    int32_t before = rig->forward ? (int32_t)((uint32_t)position - 1) : (int32_t)((uint32_t)position + 1);
    if (motor != 1 || before != rig->position)
        rig->torn = true;
    rig->position = position;
    if (rig->steps > 0 && tick - rig->last < rig->spacing)
        rig->spacing = tick - rig->last;
    rig->last = tick;
    rig->steps++;
    if (!rig->wanted) {
        motion_check(rig->steps <= MOTION_ROOM, "more than %u pulses; %s", MOTION_ROOM, what);
        rig->tick[rig->steps - 1] = tick;
    } else if (rig->wanted_next < rig->wanted_count && rig->wanted[rig->wanted_next] == rig->steps) {
        rig->tick[rig->wanted_next++] = tick;
    }
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    struct motion_rig *rig = context;
    (void)motor;
    rig->turned = tick;
    rig->turns++;
    rig->forward = forward;
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    struct motion_rig *rig = context;
    rig->outputs = mask;
    rig->outputs_tick = tick;
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event event, uint32_t value)
{
    struct motion_rig *rig = context;
    if (motor != 1 || event != RKM04_EVENT_MOTION)
        return;
    if (value == 1) {
        rig->begin = tick;
        rig->begins++;
    } else {
        rig->end = tick;
        rig->ends++;
    }
}

static const struct rkm04_port port = {.step = on_step, .direction = on_direction, .outputs = on_outputs, .event = on_event};

static const struct rkm04_port deaf_port = {.direction = on_direction, .outputs = on_outputs, .event = on_event};

/* ---- Driving ------------------------------------------------------------------------------------------------------ */

void motion_start(struct motion_rig *rig, uint16_t speed_change_latency)
{
    const struct rkm04_config config = {.node = 1, .readings.speed_change = speed_change_latency};
    if (!ticks)
        ticks = malloc(MOTION_ROOM * sizeof *ticks);
    ck_assert_ptr_nonnull(ticks);
    memset(rig, 0, sizeof *rig);
    rig->tick = ticks;
    rig->spacing = UINT64_MAX;
    rkm04_init(&rig->unit, &config, &port, rig);
}

void motion_want(struct motion_rig *rig, const uint64_t *wanted, size_t count)
{
    ck_assert_uint_le(count, MOTION_ROOM);
    rig->wanted = wanted;
    rig->wanted_count = count;
}

void motion_listen(struct motion_rig *rig, bool listen)
{
    struct rkm04_motor_state state;
    motion_check(rkm04_motor_state(&rig->unit, 1, &state), "there is no motor 1");
    rig->unit.port = listen ? &port : &deaf_port;
    rig->steps = state.steps;
    rig->position = state.position;
    rig->spacing = UINT64_MAX;
    rig->last = 0;
    while (rig->wanted && rig->wanted_next < rig->wanted_count && rig->wanted[rig->wanted_next] <= rig->steps)
        rig->tick[rig->wanted_next++] = 0;
}

void motion_send(struct motion_rig *rig, const char *text)
{
    int flag = rkm04_set_command(&rig->unit, '1', text, strlen(text), NULL);
    motion_check(flag == 0, "\"%s\" was answered with flag %d; %s", text, flag, what);
}

void motion_to(struct motion_rig *rig, uint64_t tick)
{
    uint64_t now = rkm04_now(&rig->unit);
    motion_check(now <= tick, "the test goes back in time, from %" PRIu64 " to %" PRIu64 "; %s", now, tick, what);
    rkm04_advance(&rig->unit, tick - now);
}

const char *motion_table(struct motion_rig *rig)
{
    static char answer[1024];
    size_t length = rkm04_exchange(&rig->unit, (const uint8_t *)"\6" "1", 2, (uint8_t *)answer, sizeof answer - 1);
    motion_check(length >= 2 && length < sizeof answer, "message 6 answers %zu bytes; %s", length, what);
    answer[length] = '\0';
    return answer + 2;
}

enum rkm04_state motion_state(const struct motion_rig *rig)
{
    struct rkm04_motor_state state;
    motion_check(rkm04_motor_state(&rig->unit, 1, &state), "there is no motor 1");
    return state.state;
}

void motion_single(struct motion_rig *rig, unsigned start_speed, const struct ref_segment *motion, bool back)
{
    char text[80];
    uint64_t now = rkm04_now(&rig->unit), first = (now / RKM04_SLOT_TICKS + (now % RKM04_SLOT_TICKS != 0)) * RKM04_SLOT_TICKS;
    if (first == 0)
        first = RKM04_SLOT_TICKS;
    snprintf(text, sizeof text, "S%u V%u A%u %c%u R", start_speed, motion->speed, motion->acceleration, back ? 'B' : 'F',
             (unsigned)motion->steps);
    motion_send(rig, text);
    rig->begin = first + 4 * RKM04_SLOT_TICKS;
}

uint64_t motion_compound(struct motion_rig *rig, unsigned start_speed, const struct ref_segment *segment, unsigned segments)
{
    char text[600];
    int length = snprintf(text, sizeof text, "S%u", start_speed);
    for (unsigned i = 0; i < segments; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, " A%u V%u F%u Y", segment[i].acceleration,
                           segment[i].speed, (unsigned)segment[i].steps);
    snprintf(text + length, sizeof text - (size_t)length, " R");
    uint64_t now = rkm04_now(&rig->unit);
    motion_check(now % RKM04_SLOT_TICKS == 0, "not in a slot; %s", what);
    motion_send(rig, text);
    return (now ? now : RKM04_SLOT_TICKS) + (4 * segments + 1) * RKM04_SLOT_TICKS;
}

/* ---- Judging ------------------------------------------------------------------------------------------------------ */

void motion_trying(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
}

void motion_trying_segments(unsigned start_speed, const struct ref_segment *segment, unsigned segments)
{
    size_t length = strlen(what);
    length += (size_t)snprintf(what + length, sizeof what - length, " S%u", start_speed);
    for (unsigned i = 0; i < segments && length < sizeof what; i++)
        length += (size_t)snprintf(what + length, sizeof what - length, " A%u V%u F%" PRIu64 "%s", segment[i].acceleration,
                                   segment[i].speed, segment[i].steps, segments > 1 ? " Y" : "");
}

const char *motion_what(void)
{
    return what;
}

static uint64_t pulses_compared, pulses_off;

void motion_expect(const struct motion_rig *rig, const struct ref_track *track, uint64_t begin, uint64_t first, uint64_t from,
                   unsigned slack)
{
    motion_check(rig->steps == first + track->steps, "%" PRIu64 " steps, expected %" PRIu64 " + %" PRIu64 "; %s", rig->steps,
                 first, track->steps, what);
    motion_check(!rig->torn, "the position does not follow the pulses; %s", what);
    for (uint64_t k = from; k <= track->steps; k++) {
        uint64_t due = begin + ref_tick(track, k), tick = rig->tick[first + k - 1];
        motion_check(tick + slack >= due && tick <= due + slack,
                     "pulse %" PRIu64 " at %" PRIu64 ", expected %" PRIu64 " (slack %u); %s", k, tick - begin, due - begin, slack,
                     what);
        pulses_off += tick != due;
    }
    pulses_compared += track->steps + 1 - from;
}

void motion_expect_few_off(void)
{
    motion_check(pulses_off <= pulses_compared / 10000, "%" PRIu64 " of %" PRIu64 " pulses a tick off", pulses_off,
                 pulses_compared);
}

/* ---- Random parameters -------------------------------------------------------------------------------------------- */

static uint64_t random_state;

uint64_t motion_seed(void)
{
    const char *text = getenv("RKM04_TEST_SEED");
    return text ? strtoull(text, NULL, 0) : 20090306;
}

unsigned motion_count(unsigned normal)
{
    const char *text = getenv("RKM04_TEST_SCALE");
    double count = normal * (text ? strtod(text, NULL) : 1.0);
    return count < 1 ? 1 : (unsigned)count;
}

/* splitmix64 */
static uint64_t mixed(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

void motion_randomize(uint64_t run)
{
    random_state = mixed(motion_seed() + 1) + mixed(run + UINT64_C(0x9e3779b97f4a7c15));
}

uint64_t motion_random(uint64_t below)
{
    random_state += UINT64_C(0x9e3779b97f4a7c15);
    return mixed(random_state) % below;
}

unsigned motion_pick(unsigned low, unsigned high)
{
    uint64_t way = motion_random(10);
    if (way < 2)
        return way == 0 ? low : high;
    double part = (double)motion_random(1u << 30) / (1u << 30);
    return (unsigned)(low * pow((double)high / low, part) + 0.5);
}

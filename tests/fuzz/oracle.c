/* SPDX-License-Identifier: MIT */
#include "oracle.h"

#include <math.h>
#include <string.h>

#include "fuzz.h"

/* A pulse comes at the first tick at or after the moment at which the position reaches it. So a time that is measured between two
 * pulses is right to less than a tick either way. */
#define TICK 1.0
#define SMALL 1e-6 /* what the arithmetic of the oracle itself may be off */

uint64_t oracle_mix(uint64_t digest, uint64_t value)
{
    digest = (digest ^ value) * UINT64_C(0x9E3779B97F4A7C15);
    return digest ^ digest >> 29;
}

static struct oracle_motor *seen_of(struct oracle *oracle, unsigned motor)
{
    return &oracle->motor[motor - 1];
}

/* ---- Limits of a motion ----------------------------------------------------------------------------------------------- */

struct limits {
    double fastest, acceleration;
};

/* Of the segments in which the steps first..last of the motion lie. */
static struct limits limits_of(const struct oracle_motor *seen, const struct rkm04_motion *motion, uint64_t first, uint64_t last)
{
    struct limits limits = {0, 0};
    uint64_t end = 0;
    for (unsigned i = 0; i < motion->segments; i++) {
        uint64_t begin = end;
        end += motion->kind == RKM04_MOTION_STEPS ? motion->segment[i].steps : UINT32_MAX;
        if (begin >= last || end < first)
            continue;
        limits.fastest = fmax(limits.fastest, seen->fastest[i]);
        limits.acceleration = fmax(limits.acceleration, motion->segment[i].acceleration);
    }
    return limits;
}

/* Changes of speed (C4) show in the segments. */
static void look_at_changes(struct oracle_motor *seen, const struct rkm04_motion *motion)
{
    for (unsigned i = 0; i < motion->segments; i++) {
        uint16_t old = seen->speed[i], now = motion->segment[i].speed;
        if (old == now)
            continue;
        seen->jumps = seen->jumps || old <= motion->start_speed || now <= motion->start_speed;
        seen->speed[i] = now;
        if (now > seen->fastest[i])
            seen->fastest[i] = now;
        if (now < seen->slowest)
            seen->slowest = now;
    }
}

/* Ticks between two of the last pulses, `n` and `m` pulses ago. */
static double ticks_between(const struct oracle_motor *seen, uint32_t n, uint32_t m)
{
    return (double)(seen->pulse[(seen->count - m) % ORACLE_PULSES] - seen->pulse[(seen->count - n) % ORACLE_PULSES]);
}

/* The last 2n pulses: speeds within [S, V], and their change within A. */
static void check_window(const struct oracle_motor *seen, const struct rkm04_motion *motion, uint32_t n)
{
    uint64_t last = (uint64_t)seen->begin_done + seen->count;
    struct limits limits = limits_of(seen, motion, last - n + 1, last);
    double time = ticks_between(seen, n, 0), before, change;
    FUZZ_CHECK(n * 1e6 / (time + TICK) <= limits.fastest + SMALL, "R1: %u steps in %.0f us at %.0f steps/s, step %llu", n, time,
               limits.fastest, (unsigned long long)last);
    FUZZ_CHECK(time <= TICK || n * 1e6 / (time - TICK) >= seen->slowest - SMALL, "R1: %u steps in %.0f us, not slower than %u", n,
               time, seen->slowest);
    if (2 * n > seen->count || seen->jumps)
        return;
    limits = limits_of(seen, motion, last - 2 * n + 1, last);
    before = ticks_between(seen, 2 * n, n);
    change = n * 1e6 / (fmin(time, before) + TICK) - n * 1e6 / (fmax(time, before) - TICK); /* at least */
    FUZZ_CHECK(change <= limits.acceleration * (time + before + 2 * TICK) / 2e6 + SMALL,
               "R1: %u steps in %.0f us, then %u in %.0f us, A%.0f, step %llu", n, before, n, time, limits.acceleration,
               (unsigned long long)last);
}

/* From standstill: no faster than S and A allow. */
static void check_start(const struct oracle_motor *seen, const struct rkm04_motion *motion)
{
    struct limits limits = limits_of(seen, motion, seen->begin_done + UINT64_C(1), (uint64_t)seen->begin_done + seen->count);
    double time = (double)(seen->pulse[seen->count % ORACLE_PULSES] - seen->begin) / 1e6;
    FUZZ_CHECK(seen->count <= motion->start_speed * time + limits.acceleration * time * time / 2 + SMALL,
               "R1: %u steps in the first %.6f s at S%u A%.0f", seen->count, time, motion->start_speed, limits.acceleration);
}

/* To standstill, likewise. */
static void check_end(const struct oracle_motor *seen, const struct rkm04_motion *motion)
{
    uint64_t last = (uint64_t)seen->begin_done + seen->count;
    for (uint32_t n = 1; n <= seen->count && n < ORACLE_PULSES && !seen->jumps; n *= 2) {
        struct limits limits = limits_of(seen, motion, last - n + 1, last);
        double time = (ticks_between(seen, n, 0) + TICK) / 1e6;
        FUZZ_CHECK(n <= motion->start_speed * time + limits.acceleration * time * time / 2 + SMALL,
                   "R1: %u steps in the last %.6f s at S%u A%.0f", n, time, motion->start_speed, limits.acceleration);
    }
}

/* ---- R1 in closed form ------------------------------------------------------------------------------------------------ */

/* T(k) in us of a motion of n steps from rest to rest; n 0: endless. */
static long double moment_of(long double s, long double v, long double a, long double n, long double k)
{
    if (v <= s)
        return 1e6L * k / v;
    long double way = (v * v - s * s) / (2 * a), time = (v - s) / a, end;
    if (n > 0 && 2 * way > n) {
        long double peak = sqrtl(s * s + a * n);
        way = n / 2;
        time = (peak - s) / a;
        end = 2 * time;
    } else {
        end = 2 * time + (n - 2 * way) / v;
    }
    if (k <= way)
        return 1e6L * 2 * k / (sqrtl(s * s + 2 * a * k) + s);
    if (n == 0 || k <= n - way)
        return 1e6L * (time + (k - way) / v);
    return 1e6L * (end - 2 * (n - k) / (sqrtl(s * s + 2 * a * (n - k)) + s));
}

/* A single motion that nothing has come between is exact to the tick (R1, R2). */
static void check_exact(const struct oracle_motor *seen, const struct rkm04_motion *motion, uint64_t tick)
{
    const struct rkm04_segment *segment = &motion->segment[0];
    if (motion->segments != 1 || motion->changed || motion->stopping)
        return;
    long double steps = motion->kind == RKM04_MOTION_STEPS ? motion->total - seen->begin_done : 0;
    long double exact = moment_of(motion->start_speed, segment->speed, segment->acceleration, steps, seen->count);
    long double came = (long double)(tick - seen->begin);
    FUZZ_CHECK(came >= exact - 1e-6L && came < exact + 1 + 1e-6L, "R1: pulse %u of %.0Lf came after %.0Lf us, due after %.6Lf",
               seen->count, steps, came, exact);
}

/* ---- The port --------------------------------------------------------------------------------------------------------- */

static void see_step(void *context, uint64_t tick, unsigned number, int32_t position)
{
    struct oracle *oracle = context;
    struct oracle_motor *seen = seen_of(oracle, number);
    const struct rkm04_motion *motion = &oracle->unit.motor[number - 1].motion;
    int32_t expected = (int32_t)((uint32_t)seen->position + (motion->forward ? 1u : UINT32_MAX));
    oracle->calls++;
    FUZZ_CHECK(seen->moving, "a pulse of motor %u without a motion", number);
    FUZZ_CHECK(!oracle->unit.simulation, "C11: a pulse of motor %u", number);
    FUZZ_CHECK(tick > seen->begin && tick >= seen->last_pulse + 62, "motor %u: a pulse at %llu, the one before at %llu", number,
               (unsigned long long)tick, (unsigned long long)seen->last_pulse);
    FUZZ_CHECK(tick >= seen->turned + 20, "R7: motor %u turned round at %llu, pulse at %llu", number,
               (unsigned long long)seen->turned, (unsigned long long)tick);
    FUZZ_CHECK(!seen->known || position == expected, "motor %u: position %d instead of %d", number, position, expected);
    seen->steps = oracle_mix(oracle_mix(seen->steps, tick), (uint32_t)position);
    seen->position = position;
    seen->known = true;
    seen->last_pulse = tick;
    seen->count++;
    seen->pulse[seen->count % ORACLE_PULSES] = tick;
    if (!seen->whole)
        return;
    look_at_changes(seen, motion);
    if (seen->count < ORACLE_PULSES && !motion->changed)
        check_start(seen, motion);
    for (uint32_t n = 1; n <= seen->count && n <= ORACLE_PULSES / 4; n *= 2)
        check_window(seen, motion, n);
    check_exact(seen, motion, tick);
}

static void see_direction(void *context, uint64_t tick, unsigned number, bool forward)
{
    struct oracle *oracle = context;
    struct oracle_motor *seen = seen_of(oracle, number);
    oracle->calls++;
    seen->rest = oracle_mix(oracle_mix(seen->rest, tick), 100u + forward);
    if (tick == oracle->switched) /* C41: at once */
        return;
    FUZZ_CHECK(seen->last_pulse == 0 || tick >= seen->last_pulse + 10, "R7: motor %u turns round at %llu, last pulse at %llu",
               number, (unsigned long long)tick, (unsigned long long)seen->last_pulse);
    seen->turned = tick;
}

static void see_outputs(void *context, uint64_t tick, uint8_t mask)
{
    struct oracle *oracle = context;
    oracle->calls++;
    oracle->common = oracle_mix(oracle_mix(oracle->common, tick), 1000u + mask);
}

static void begin_motion(struct oracle *oracle, unsigned number, uint64_t tick)
{
    struct oracle_motor *seen = seen_of(oracle, number);
    const struct rkm04_motor *motor = &oracle->unit.motor[number - 1];
    FUZZ_CHECK(!seen->moving, "motor %u begins a motion in a motion", number);
    seen->moving = true;
    seen->whole = oracle->unit.port->step && !oracle->unit.simulation;
    seen->begin = tick;
    seen->begin_position = motor->position;
    seen->begin_done = motor->motion.done;
    seen->count = 0;
    seen->jumps = false;
    seen->pulse[0] = tick;
    seen->slowest = motor->motion.start_speed;
    for (unsigned i = 0; i < motor->motion.segments; i++) {
        seen->speed[i] = seen->fastest[i] = motor->motion.segment[i].speed;
        if (seen->speed[i] < seen->slowest)
            seen->slowest = seen->speed[i];
    }
    seen->guard_m = motor->guard_m;
    seen->guard_n = motor->guard_n;
}

/* Pulses counted = change of position; a motion ends with exactly its steps unless something has stopped it. */
static void end_motion(struct oracle *oracle, unsigned number)
{
    struct oracle_motor *seen = seen_of(oracle, number);
    const struct rkm04_motor *motor = &oracle->unit.motor[number - 1];
    const struct rkm04_motion *motion = &motor->motion;
    uint32_t done = motion->done - seen->begin_done, way = (uint32_t)motor->position - (uint32_t)seen->begin_position;
    FUZZ_CHECK(seen->moving, "motor %u ends a motion that has not begun", number);
    seen->moving = false;
    FUZZ_CHECK(way == (motion->forward ? done : 0u - done), "motor %u: %u steps, from %d to %d", number, done,
               seen->begin_position, motor->position);
    FUZZ_CHECK(!seen->whole || done == seen->count, "motor %u: %u steps, %u pulses", number, done, seen->count);
    if (oracle->in_message) /* C1 */
        return;
    if (seen->whole)
        check_end(seen, motion);
    if (motion->kind != RKM04_MOTION_STEPS || motion->done == motion->total)
        return;
    bool guarded = (seen->guard_m && !motor->guard_m) || (seen->guard_n && !motor->guard_n);
    FUZZ_CHECK(motion->done < motion->total && (guarded || motor->after != RKM04_AFTER_GO_ON),
               "motor %u: a motion of %u steps ends after %u", number, motion->total, motion->done);
}

static bool writes(struct rkm04_command command, uint32_t low, uint32_t high)
{
    return (command.op == 'T' || command.op == 'C') && command.argument >= low && command.argument <= high;
}

static void see_command(struct oracle *oracle, unsigned number, uint64_t tick)
{
    struct oracle_motor *seen = seen_of(oracle, number);
    struct rkm04_command command = oracle->unit.motor[number - 1].command;
    FUZZ_CHECK(tick >= oracle->held_up, "P6: motor %u executes a command at %llu, held up until %llu", number,
               (unsigned long long)tick, (unsigned long long)oracle->held_up);
    if (command.op == '=' || (command.op == 'C' && command.argument == 100)) {
        seen->position = command.op == '=' ? (int32_t)command.argument : 0;
        seen->known = true;
    }
    if (writes(command, 41, 41)) {
        oracle->switched = tick;
        for (unsigned i = 0; i < RKM04_MOTORS; i++)
            oracle->motor[i].known = oracle->motor[i].whole = false;
    }
    if (writes(command, 41, 41) || writes(command, 80, 95))
        oracle->writers |= (uint8_t)(1u << (number - 1));
}

static void see_event(void *context, uint64_t tick, unsigned number, enum rkm04_event what, uint32_t value)
{
    struct oracle *oracle = context;
    uint64_t *digest = number > 0 ? &seen_of(oracle, number)->rest : &oracle->common;
    oracle->calls++;
    *digest = oracle_mix(oracle_mix(*digest, tick), 10000u + (uint64_t)what * 100000u + value);
    if (what == RKM04_EVENT_MOTION && value)
        begin_motion(oracle, number, tick);
    else if (what == RKM04_EVENT_MOTION)
        end_motion(oracle, number);
    else if (what == RKM04_EVENT_COMMAND && value > 0)
        see_command(oracle, number, tick);
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    memcpy(data, &((struct oracle *)context)->flash[block][offset], length);
    return 0;
}

static int flash_erase(void *context, unsigned block)
{
    memset(((struct oracle *)context)->flash[block], 0xff, RKM04_FLASH_BLOCK_SIZE);
    return 0;
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    memcpy(&((struct oracle *)context)->flash[block][offset], data, length);
    return 0;
}

static const struct rkm04_port seeing = {see_step,  NULL,       see_direction, see_outputs,
                                        see_event, flash_read, flash_erase,   flash_program};
static const struct rkm04_port skipping = {NULL,      NULL,       see_direction, see_outputs,
                                          see_event, flash_read, flash_erase,   flash_program};

/* ---- What happens to a unit ------------------------------------------------------------------------------------------- */

void oracle_power_up(struct oracle *oracle, const struct rkm04_config *config, bool seen)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        struct oracle_motor *motor = &oracle->motor[i];
        *motor = (struct oracle_motor){.steps = oracle_mix(motor->steps, 1), .rest = oracle_mix(motor->rest, 1), .known = seen};
    }
    oracle->switched = RKM04_NEVER;
    oracle->held_up = 0;
    rkm04_init(&oracle->unit, config, seen ? &seeing : &skipping, oracle);
}

void oracle_see_pulses(struct oracle *oracle, bool seen)
{
    oracle->unit.port = seen ? &seeing : &skipping;
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        oracle->motor[i].known = oracle->motor[i].whole = false;
}

void oracle_advance(struct oracle *oracle, uint64_t ticks)
{
    rkm04_advance(&oracle->unit, ticks);
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        struct oracle_motor *seen = &oracle->motor[i];
        if (oracle->unit.simulation || !oracle->unit.port->step)
            seen->known = false;
        FUZZ_CHECK(!seen->known || seen->position == oracle->unit.motor[i].position, "motor %u: counter %d, reckoned %d", i + 1,
                   oracle->unit.motor[i].position, seen->position);
        FUZZ_CHECK(seen->moving == oracle->unit.motor[i].motion.moving, "motor %u: moving", i + 1);
        if (seen->moving && seen->whole) /* also where several come between two pulses */
            look_at_changes(seen, &oracle->unit.motor[i].motion);
    }
}

bool oracle_is_store(const uint8_t *message, size_t length)
{
    return length > 1 && message[0] == 3 && message[1] >= '0' && message[1] <= '4';
}

/* Store Flash holds up all motors (reading `store-time`). */
static void see_store(struct oracle *oracle)
{
    uint64_t now = rkm04_now(&oracle->unit), slot = now == 0 ? 1 : (now + RKM04_SLOT_TICKS - 1) / RKM04_SLOT_TICKS;
    if (oracle->unit.config.readings.store_time > 0)
        oracle->held_up = (slot + oracle->unit.config.readings.store_time) * RKM04_SLOT_TICKS;
}

size_t oracle_exchange(struct oracle *oracle, const uint8_t *message, size_t length, uint64_t *into)
{
    static uint8_t answer[9300];
    size_t n;
    bool simulation = oracle->unit.simulation;
    if (oracle_is_store(message, length))
        see_store(oracle);
    oracle->in_message = true;
    n = rkm04_exchange(&oracle->unit, message, length, answer, sizeof answer);
    oracle->in_message = false;
    if (simulation && !oracle->unit.simulation && message[1] != '0') /* by `\` (reading `reset-t41`) */
        oracle->writers |= (uint8_t)(1u << (message[1] - '1'));
    for (size_t i = 0; i < n; i++)
        *into = oracle_mix(*into, answer[i]);
    return n;
}

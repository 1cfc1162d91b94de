/* SPDX-License-Identifier: MIT */
#include "rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct rkm04_config as_delivered = {.node = 1};

void rig_power_up(struct rig *rig, const struct rkm04_config *config)
{
    flash_fake_init(&rig->flash);
    recorder_clear(&rig->record);
    rig->record.flash = &rig->flash;
    rkm04_init(&rig->unit, config ? config : &as_delivered, &recorder_flash_port, &rig->record);
}

void rig_power_cycle(struct rig *rig)
{
    struct rkm04_config config = rig->unit.config;
    recorder_clear(&rig->record);
    rkm04_init(&rig->unit, &config, &recorder_flash_port, &rig->record);
}

void rig_free(struct rig *rig)
{
    recorder_free(&rig->record);
}

int rig_set(struct rig *rig, char motor, const char *text)
{
    return rkm04_set_command(&rig->unit, motor, text, strlen(text), NULL);
}

void rig_accept(struct rig *rig, char motor, const char *text)
{
    int flag = rig_set(rig, motor, text);
    ck_assert_msg(flag == 0, "flag %d for \"%s\"", flag, text);
}

void rig_to(struct rig *rig, uint64_t tick)
{
    uint64_t now = rkm04_now(&rig->unit);
    ck_assert_msg(now <= tick, "the test wants tick %llu, the unit is at %llu", (unsigned long long)tick,
                  (unsigned long long)now);
    rkm04_advance(&rig->unit, tick - now);
    ck_assert_uint_eq(rkm04_now(&rig->unit), tick);
}

void rig_input_at(struct rig *rig, uint64_t tick, unsigned input, bool level)
{
    rig_to(rig, tick);
    unsigned mask = rkm04_inputs(&rig->unit), bit = 1u << (input - 1);
    rkm04_set_inputs(&rig->unit, (uint8_t)(level ? mask | bit : mask & ~bit));
}

void rig_accept_at(struct rig *rig, uint64_t tick, const char *text)
{
    rig_to(rig, tick);
    rig_accept(rig, '1', text);
}

struct rkm04_motor_state rig_motor(const struct rig *rig, unsigned motor)
{
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(&rig->unit, motor, &state));
    return state;
}

void rig_expect_state(const struct rig *rig, unsigned motor, enum rkm04_state state)
{
    ck_assert_str_eq(rkm04_state_name(rig_motor(rig, motor).state), rkm04_state_name(state));
}

const char *rig_ask(struct rig *rig, uint8_t message, unsigned motor)
{
    static char text[10000];
    uint8_t request[2] = {message, (uint8_t)('0' + motor)};
    size_t length = rkm04_exchange(&rig->unit, request, 2, (uint8_t *)text, sizeof text - 1);
    ck_assert_uint_ge(length, 2);
    ck_assert_uint_lt(length, sizeof text);
    ck_assert_uint_eq((uint8_t)text[0], message);
    ck_assert_int_eq(text[1], request[1]);
    text[length] = 0;
    return text + 2;
}

const char *rig_program(struct rig *rig, unsigned motor)
{
    return rig_ask(rig, 5, motor);
}

uint64_t rig_ran(const struct rig *rig, unsigned place, size_t n)
{
    const struct record *record = recorder_event(&rig->record, 1, RKM04_EVENT_COMMAND, place, n);
    return record ? record->tick : RKM04_NEVER;
}

uint64_t rig_outputs_became(const struct rig *rig, uint8_t mask, size_t n)
{
    for (size_t i = 0; i < rig->record.count; i++) {
        const struct record *record = &rig->record.list[i];
        if (record->kind == RECORD_OUTPUTS && record->value == mask && --n == 0)
            return record->tick;
    }
    return RKM04_NEVER;
}

size_t rig_motions(const struct rig *rig, unsigned motor)
{
    size_t n = 0;
    while (recorder_event(&rig->record, motor, RKM04_EVENT_MOTION, 1, n + 1))
        n++;
    return n;
}

static void expect_motion(const struct rig *rig, unsigned motor, size_t n, uint64_t begin, uint64_t end, size_t steps,
                          bool forward, uint64_t tolerance)
{
    const struct record *first = recorder_event(&rig->record, motor, RKM04_EVENT_MOTION, 1, n);
    const struct record *last = recorder_event(&rig->record, motor, RKM04_EVENT_MOTION, 0, n);
    ck_assert_msg(first != NULL, "motor %u: motion %zu never began", motor, n);
    ck_assert_msg(first->tick == begin, "motor %u: motion %zu began at %llu, not %llu", motor, n, (unsigned long long)first->tick,
                  (unsigned long long)begin);
    ck_assert_msg(last != NULL, "motor %u: motion %zu never ended", motor, n);
    ck_assert_msg(last->tick + tolerance >= end && last->tick <= end + tolerance, "motor %u: motion %zu ended at %llu, not %llu",
                  motor, n, (unsigned long long)last->tick, (unsigned long long)end);
    size_t pulses = 0;
    uint64_t pulse = 0;
    int64_t from = 0, to = 0;
    for (size_t i = 0; i < rig->record.count; i++) {
        const struct record *record = &rig->record.list[i];
        if (record->kind != RECORD_STEP || record->motor != motor || record->tick <= begin || record->tick > last->tick)
            continue;
        if (pulses++ == 0)
            from = record->value;
        to = record->value;
        ck_assert_msg(record->tick > pulse, "motor %u: pulse %zu of motion %zu at %llu is not later than the one before", motor,
                      pulses, n, (unsigned long long)record->tick);
        pulse = record->tick;
    }
    ck_assert_msg(pulses == steps, "motor %u: motion %zu has %zu pulses, not %zu", motor, n, pulses, steps);
    ck_assert_msg(steps == 0 || pulse == last->tick, "motor %u: motion %zu: last pulse at %llu, end at %llu", motor, n,
                  (unsigned long long)pulse, (unsigned long long)last->tick);
    int64_t way = forward ? to - from : from - to;
    ck_assert_msg(steps < 2 || way == (int64_t)steps - 1, "motor %u: motion %zu went from %lld to %lld", motor, n,
                  (long long)from, (long long)to);
}

void rig_expect_motion(const struct rig *rig, unsigned motor, size_t n, uint64_t begin, uint64_t end, size_t steps, bool forward)
{
    expect_motion(rig, motor, n, begin, end, steps, forward, 0);
}

void rig_expect_motion_near(const struct rig *rig, unsigned motor, size_t n, uint64_t begin, uint64_t end, size_t steps,
                            bool forward)
{
    expect_motion(rig, motor, n, begin, end, steps, forward, 1);
}

/* Smallest t with (a t + 10^6 s)^2 >= 10^12 (s^2 + b): the time, in ticks, at which a speed of sqrt(s^2 + b) is reached. */
static uint64_t ticks_to_square(uint64_t s, uint64_t a, uint64_t b)
{
    unsigned __int128 goal = (unsigned __int128)1000000000000u * (s * s + b);
    uint64_t low = 0, high = UINT64_C(1) << 46;
    while (low < high) {
        uint64_t middle = (low + high) / 2;
        unsigned __int128 speed = (unsigned __int128)a * middle + (unsigned __int128)1000000u * s;
        if (speed * speed >= goal)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

uint64_t rise_ticks(uint64_t s, uint64_t a, uint64_t k)
{
    return ticks_to_square(s, a, 2 * a * k);
}

uint64_t move_ticks(uint64_t s, uint64_t v, uint64_t a, uint64_t steps)
{
    if (v <= s) /* R3: T = N / v */
        return (SECOND * steps + v - 1) / v;
    if (v * v - s * s <= a * steps) /* T = 2(v-s)/a + (N - (v^2-s^2)/a)/v = ((v-s)^2 + N a) / (a v) */
        return (uint64_t)(((unsigned __int128)SECOND * ((v - s) * (v - s) + a * steps) + a * v - 1) / (a * v));
    /* T = 2(p-s)/a, p^2 = s^2 + a N: as if at half the acceleration up to p */
    unsigned __int128 goal = (unsigned __int128)4000000000000u * (s * s + a * steps);
    uint64_t low = 0, high = UINT64_C(1) << 46;
    while (low < high) {
        uint64_t middle = (low + high) / 2;
        unsigned __int128 speed = (unsigned __int128)a * middle + (unsigned __int128)2000000u * s;
        if (speed * speed >= goal)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

uint64_t slot_behind(uint64_t end)
{
    return (end + 10 + MS - 1) / MS * MS;
}

int rig_run(Suite *suite, const char *program)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone (a case is named between the second and third colon): CK_RUN_CASE=CASE %s\n", program);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

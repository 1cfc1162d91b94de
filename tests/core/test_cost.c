/* SPDX-License-Identifier: MIT */
/* What a pulse costs a microcontroller: the basic blocks of the core that are passed, counted by the compiler (-O0, so that they
 * are those of the source). They are the same on every run and machine; time is not. The limits are a fiftieth above what was
 * counted: with a bad guess of the next interval (ramp.c) the pulses stay exact to the tick, and only here it shows. */
#include <check.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#define SECOND UINT64_C(1000000)
#define DAY (24 * 3600 * SECOND)

void __sanitizer_cov_trace_pc(void);

static struct rkm04_unit unit;
static uint64_t blocks, pulses;

/* Called at each basic block of the core. */
void __sanitizer_cov_trace_pc(void)
{
    blocks++;
}

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)tick, (void)motor, (void)position;
    pulses++;
}

static const struct rkm04_port watched = {.step = on_step}, unwatched = {.step = NULL};

static void begin(const struct rkm04_port *port, const char *text)
{
    const struct rkm04_config config = {.node = 1};
    rkm04_init(&unit, &config, port, NULL);
    ck_assert_int_eq(rkm04_set_command(&unit, '1', text, strlen(text), NULL), 0);
    pulses = 0;
    blocks = 0;
}

static uint64_t blocks_of_advance(uint64_t ticks)
{
    uint64_t before = blocks;
    rkm04_advance(&unit, ticks);
    return blocks - before;
}

/* ---- Pulses on the average ---- */

/* Blocks per pulse times 100 between two ticks, in one call. */
static const struct {
    const char *text;
    uint64_t from, to;
    uint64_t pulses, most;
} averages[] = {
    {"\\ S100 V16000 A20000 G+", 2 * SECOND, 12 * SECOND, 160000, 491}, /* constant, a whole speed */
    {"\\ S2000 V3000 A9000 G+", 2 * SECOND, 12 * SECOND, 30000, 492}, /* the same after a ramp that ends within a tick */
    {"\\ S100 V16000 A20000 F12500 R", 5000, 2 * SECOND, 12500, 941}, /* a triangle */
    {"\\ S1 V16000 A60000 F4000 R", 5000, 2 * SECOND, 4000, 1347}, /* as steep as can be */
    {"\\ S1 V16000 A100 F10000 R", 5000, 60 * SECOND, 10000, 1286}, /* gentle */
    {"\\ S1 V300 A1 F20000 R", 5000, 900 * SECOND, 20000, 1222}, /* hardly at all */
    {"\\ S333 A1234 V15000 F700 Y V900 F3000 Y V800 F900 Y R", 12000, 9 * SECOND, 4600, 1119}, /* no whole speed */
};

START_TEST(R1_a_pulse_costs_little_on_the_average)
{
    begin(&watched, averages[_i].text);
    rkm04_advance(&unit, averages[_i].from);
    pulses = 0;
    uint64_t spent = blocks_of_advance(averages[_i].to - averages[_i].from), mean = pulses > 0 ? 100 * spent / pulses : 0;
    ck_assert_msg(pulses == averages[_i].pulses && mean <= averages[_i].most,
                  "%s: %" PRIu64 " pulses, each %" PRIu64 "/100 blocks, expected %" PRIu64 ", at most %" PRIu64 "/100",
                  averages[_i].text, pulses, mean, averages[_i].pulses, averages[_i].most);
}
END_TEST

/* ---- A host that goes from slot to slot ---- */

static const struct {
    const char *text;
    uint64_t slots, most;
} slotwise[] = {
    {"\\ S100 V16000 A20000 F12500 R", 2000, 3282}, /* a triangle */
    {"\\ S1 V16000 A60000 F4000 R", 2000, 7200}, /* as steep as can be */
    {"\\ S2000 V9000 A1500 F40000 R", 8000, 3857}, /* gentle, and 9 pulses a slot */
};

/* What has been worked out for a slot serves the next one, too. */
START_TEST(K3_slot_by_slot_a_pulse_costs_little_more)
{
    begin(&watched, slotwise[_i].text);
    uint64_t spent = 0;
    for (uint64_t i = 0; i < slotwise[_i].slots; i++)
        spent += blocks_of_advance(RKM04_SLOT_TICKS);
    ck_assert_msg(pulses > 0 && spent <= slotwise[_i].most * pulses / 100,
                  "%s: %" PRIu64 " pulses, each %" PRIu64 "/100 blocks, expected at most %" PRIu64 "/100", slotwise[_i].text,
                  pulses, pulses > 0 ? 100 * spent / pulses : 0, slotwise[_i].most);
}
END_TEST

/* ---- The worst of single pulses ---- */

/* Motions from event to event: the most that a pulse between slots costs, and a slot. */
static const struct {
    const char *text;
    uint64_t pulse, slot;
} worst[] = {
    {"\\ S1 V16000 A60000 F3000 R B3000 R", 1042, 1587},
    {"\\ S1 V16000 A1 F3000 R", 1082, 1771},
    {"\\ S1 V2 A60000 F10 R", 678, 1268},
    {"\\ S333 A1234 V15000 F700 Y V900 F3000 Y V1 F2 Y V800 F900 Y R", 952, 2695},
    {"\\ S1 V16000 A60000 F1 Y F2 Y F3 Y F4 Y F5 Y F6 Y F7 Y F8 Y F9 Y F10 Y R", 942, 4499},
};

START_TEST(K3_no_pulse_and_no_slot_costs_much_more_than_others)
{
    uint64_t pulse = 0, slot = 0;
    begin(&watched, worst[_i].text);
    for (uint64_t event; (event = rkm04_next_event(&unit)) != RKM04_NEVER;) {
        uint64_t spent = blocks_of_advance(event - rkm04_now(&unit) + 1);
        uint64_t *most = event % RKM04_SLOT_TICKS == 0 ? &slot : &pulse;
        *most = spent > *most ? spent : *most;
    }
    ck_assert_uint_gt(pulses, 0);
    ck_assert_msg(pulse <= worst[_i].pulse && slot <= worst[_i].slot,
                  "%s: a pulse %" PRIu64 " blocks, a slot %" PRIu64 ", expected at most %" PRIu64 " and %" PRIu64, worst[_i].text,
                  pulse, slot, worst[_i].pulse, worst[_i].slot);
}
END_TEST

/* ---- Pulses that no watcher sees ---- */

static const struct {
    const char *text;
    uint64_t days;
    uint32_t position;
    uint64_t most;
} leaps[] = {
    {"\\ S100 V16000 A20000 G+", 1, 1382393615, 4044},
    {"\\ S1 V16000 A1 G+", 100, 673062463, 708209}, /* past 2^32 steps */
    {"\\ S1 V16000 A1 F16000000 R", 1, 16000000, 19273}, /* ramps of hours */
    {"\\ T55 S100 V16000 A20000 F16000000 YYYYYYYYYY R", 1, 160000000, 31063}, /* an output at its last border */
    {"\\ S1 V1 =-2000000000 G2000000000", 50000, 2000000000, 2985},
};

START_TEST(K3_pulses_that_nobody_sees_cost_nothing_each)
{
    struct rkm04_motor_state state;
    begin(&unwatched, leaps[_i].text);
    uint64_t spent = blocks_of_advance(leaps[_i].days * DAY);
    ck_assert(rkm04_motor_state(&unit, 1, &state));
    ck_assert_msg((uint32_t)state.position == leaps[_i].position && spent <= leaps[_i].most,
                  "%s: %" PRIu64 " blocks to %" PRIu32 ", expected at most %" PRIu64 " to %" PRIu32, leaps[_i].text, spent,
                  (uint32_t)state.position, leaps[_i].most, leaps[_i].position);
}
END_TEST

/* As a bus goes, from byte to byte. */
START_TEST(K3_steps_of_a_byte_cost_little_while_nobody_sees_the_pulses)
{
    const uint64_t steps = 1000, most = 183;
    begin(&unwatched, "\\ S100 V16000 A20000 G+");
    rkm04_advance(&unit, 2 * SECOND);
    uint64_t spent = 0;
    for (uint64_t i = 0; i < steps; i++)
        spent += blocks_of_advance(521);
    ck_assert_msg(spent <= most * steps, "%" PRIu64 " blocks, expected at most %" PRIu64, spent, most * steps);
}
END_TEST

/* ---- Time in which nothing happens ---- */

static const struct {
    const char *text;
    uint64_t most; /* in an hour */
} waits[] = {{"\\", 102}, {"\\ X01 M02 O03", 102}, {"\\ W3000000", 405}};

START_TEST(K3_an_hour_of_waiting_costs_no_more_than_a_slot)
{
    begin(&watched, waits[_i].text);
    rkm04_advance(&unit, 10 * RKM04_SLOT_TICKS);
    uint64_t spent = blocks_of_advance(3600 * SECOND);
    ck_assert_msg(spent <= waits[_i].most, "%s: %" PRIu64 " blocks, expected at most %" PRIu64, waits[_i].text, spent,
                  waits[_i].most);
}
END_TEST

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

int main(void)
{
    Suite *suite = suite_create("cost");
    TCase *one = tcase_create("cost");
    tcase_set_timeout(one, 60);
    tcase_add_loop_test(one, R1_a_pulse_costs_little_on_the_average, 0, COUNT(averages));
    tcase_add_loop_test(one, K3_slot_by_slot_a_pulse_costs_little_more, 0, COUNT(slotwise));
    tcase_add_loop_test(one, K3_no_pulse_and_no_slot_costs_much_more_than_others, 0, COUNT(worst));
    tcase_add_loop_test(one, K3_pulses_that_nobody_sees_cost_nothing_each, 0, COUNT(leaps));
    tcase_add_test(one, K3_steps_of_a_byte_cost_little_while_nobody_sees_the_pulses);
    tcase_add_loop_test(one, K3_an_hour_of_waiting_costs_no_more_than_a_slot, 0, COUNT(waits));
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

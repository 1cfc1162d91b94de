/* SPDX-License-Identifier: MIT */
/* Pulses in blocks (port.steps) are those that come one by one (port.step), however time is cut into pieces (K3). */
#include <stdio.h>
#include <string.h>

#include "motion_rig.h"

#define PULSES_MAX 400000

struct pulse {
    uint64_t tick;
    int32_t position;
};

static struct seen {
    struct rkm04_unit unit;
    unsigned count[RKM04_MOTORS], blocks;
    struct pulse pulse[RKM04_MOTORS][PULSES_MAX];
} one, many;

static void on_event(struct seen *seen, uint64_t tick, unsigned motor, int32_t position)
{
    unsigned *count = &seen->count[motor - 1];
    motion_check(*count < PULSES_MAX, "too many pulses; %s", motion_what());
    seen->pulse[motor - 1][(*count)++] = (struct pulse){tick, position};
}

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    on_event(context, tick, motor, position);
}

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    struct seen *seen = context;
    motion_check(count > 0, "an empty block; %s", motion_what());
    seen->blocks++;
    for (size_t i = 0; i < count; i++) {
        on_event(seen, tick[i], motor, position);
        position = (int32_t)(forward ? (uint32_t)position + 1 : (uint32_t)position - 1);
    }
}

static void never_on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)motor, (void)position;
    ck_abort_msg("step was called at %" PRIu64 " though there is steps", tick);
}

static const struct rkm04_port single = {.step = on_step}, blocks = {.steps = on_steps},
                               both = {.step = never_on_step, .steps = on_steps};

static void start(struct seen *seen, const struct rkm04_port *port)
{
    const struct rkm04_config config = {.node = 1};
    memset(seen->count, 0, sizeof seen->count);
    seen->blocks = 0;
    rkm04_init(&seen->unit, &config, port, seen);
}

static void send(char motor, const char *text)
{
    int a = rkm04_set_command(&one.unit, motor, text, strlen(text), NULL);
    int b = rkm04_set_command(&many.unit, motor, text, strlen(text), NULL);
    motion_check(a == b, "%s is answered with %d and %d", text, a, b);
}

/* Both units to the same tick, the second one in pieces of any size. */
static void advance(uint64_t ticks)
{
    rkm04_advance(&one.unit, ticks);
    while (ticks > 0) {
        uint64_t piece = motion_random(3) == 0 ? 1 + motion_random(200) : 1 + motion_random(400000);
        piece = piece < ticks ? piece : ticks;
        rkm04_advance(&many.unit, piece);
        ticks -= piece;
    }
}

static void expect_same(void)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        motion_check(one.count[i] == many.count[i], "motor %u: %u pulses and %u; %s", i + 1, one.count[i], many.count[i],
                     motion_what());
        for (unsigned k = 0; k < one.count[i]; k++) {
            const struct pulse *a = &one.pulse[i][k], *b = &many.pulse[i][k];
            motion_check(a->tick == b->tick && a->position == b->position,
                         "motor %u, pulse %u: %" PRIu64 " to %d and %" PRIu64 " to %d; %s", i + 1, k + 1, a->tick, a->position,
                         b->tick, b->position, motion_what());
        }
        motion_check(one.unit.motor[i].position == many.unit.motor[i].position, "motor %u: counter; %s", i + 1, motion_what());
    }
}

static void random_program(char *text, size_t room)
{
    unsigned s = motion_pick(1, 2000), v = motion_pick(1, 16000), a = motion_pick(1, 60000);
    switch (motion_random(4)) {
    case 0:
        snprintf(text, room, "\\ S%u V%u A%u F%u R W3 B%u R", s, v, a, motion_pick(1, 20000), motion_pick(1, 20000));
        break;
    case 1:
        snprintf(text, room, "\\ S%u V%u A%u F%u Y V%u A%u F%u Y V%u F%u Y T55 R", s, v, a, motion_pick(1, 9000),
                 motion_pick(1, 16000), motion_pick(1, 60000), motion_pick(1, 9000), motion_pick(1, 16000), motion_pick(1, 9000));
        break;
    case 2:
        snprintf(text, room, "\\ S%u V%u A%u G-", s, v, a);
        break;
    default:
        snprintf(text, room, "\\ S%u V%u A%u L9 F%u R B%u R E", s, v, a, motion_pick(1, 900), motion_pick(1, 900));
    }
}

/* Something that acts on motions under way, or not. */
static void send_request(void)
{
    static const char *const requests[] = {"K", "C75", "X01", "M02", "C41", "T41"};
    char text[20];
    if (motion_random(2)) {
        snprintf(text, sizeof text, "V%u", motion_pick(1, 16000));
        send('0', text);
    } else {
        send('0', requests[motion_random(6)]);
    }
}

START_TEST(K3_blocks_of_pulses_are_the_pulses_that_come_one_by_one)
{
    char text[200];
    for (unsigned i = 0; i < motion_count(400); i++) {
        motion_randomize(i);
        motion_trying("story %u of seed %" PRIu64, i, motion_seed());
        start(&one, &single);
        start(&many, i % 2 ? &blocks : &both);
        for (unsigned motor = 1; motor <= RKM04_MOTORS; motor += 1 + (unsigned)motion_random(3)) {
            random_program(text, sizeof text);
            send((char)('0' + motor), text);
        }
        for (unsigned piece = 0; piece < 12 && one.count[0] < PULSES_MAX / 20; piece++) {
            advance(1 + motion_random(motion_random(2) ? 3000 : 900000));
            send_request();
        }
        expect_same();
    }
}
END_TEST

START_TEST(R8_a_block_counts_on_over_the_end_of_the_counter)
{
    motion_trying("wrap");
    start(&one, &single);
    start(&many, &blocks);
    send('1', "S2000 V16000 A60000 G-");
    one.unit.motor[0].position = many.unit.motor[0].position = INT32_MIN + 700;
    advance(400000);
    expect_same();
    ck_assert_uint_gt(one.count[0], 4000);
    ck_assert_int_gt(one.unit.motor[0].position, 0);
}
END_TEST

START_TEST(K3_a_second_of_pulses_comes_in_few_blocks)
{
    motion_trying("few");
    start(&many, &blocks);
    ck_assert_int_eq(rkm04_set_command(&many.unit, '1', "S100 V16000 A60000 G+", 21, NULL), 0);
    rkm04_advance(&many.unit, 1000000);
    ck_assert_uint_gt(many.count[0], 13000);
    ck_assert_uint_lt(many.blocks, many.count[0] / 40);
}
END_TEST

START_TEST(C11_no_block_comes_in_simulation_mode)
{
    motion_trying("T41");
    start(&many, &blocks);
    ck_assert_int_eq(rkm04_set_command(&many.unit, '1', "T41 S100 V16000 A60000 F5000 R", 30, NULL), 0);
    rkm04_advance(&many.unit, 10000000);
    ck_assert_uint_eq(many.blocks, 0);
    ck_assert_int_eq(many.unit.motor[0].position, 5000);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("port_steps");
    TCase *one_case = tcase_create("port_steps");
    tcase_set_timeout(one_case, 100);
    tcase_add_test(one_case, K3_blocks_of_pulses_are_the_pulses_that_come_one_by_one);
    tcase_add_test(one_case, R8_a_block_counts_on_over_the_end_of_the_counter);
    tcase_add_test(one_case, K3_a_second_of_pulses_comes_in_few_blocks);
    tcase_add_test(one_case, C11_no_block_comes_in_simulation_mode);
    suite_add_tcase(suite, one_case);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

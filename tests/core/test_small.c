/* SPDX-License-Identifier: MIT */
/* A unit with the compile-time figures of a small chip (limits.h; tests/CMakeLists.txt sets them): less of everything, and
 * the rest as specified. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/link.h>
#include <rkm04/unit.h>

#define SECOND UINT64_C(1000000)
#define TEXT_MAX (5 * RKM04_PROGRAM_MAX + 200)

static struct rkm04_unit unit;
static uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
static uint64_t last_step;

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)motor, (void)position;
    last_step = tick;
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    ck_assert_uint_lt(block, RKM04_FLASH_BLOCKS);
    memcpy(data, flash[block] + offset, length);
    return 0;
}

static int flash_erase(void *context, unsigned block)
{
    (void)context;
    memset(flash[block], 0xFF, RKM04_FLASH_BLOCK_SIZE);
    return 0;
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    memcpy(flash[block] + offset, data, length);
    return 0;
}

static const struct rkm04_port port = {
    .step = on_step, .flash_read = flash_read, .flash_erase = flash_erase, .flash_program = flash_program};

static void power_up(void)
{
    static const struct rkm04_config config = {.node = 1};
    rkm04_init(&unit, &config, &port, NULL);
}

static void setup(void)
{
    memset(flash, 0xFF, sizeof flash);
    power_up();
}

static int set(char motor, const char *text)
{
    return rkm04_set_command(&unit, motor, text, strlen(text), NULL);
}

static struct rkm04_motor_state state_of(unsigned motor)
{
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(&unit, motor, &state));
    return state;
}

static void repeat(char text[TEXT_MAX], const char *command, unsigned count)
{
    text[0] = '\0';
    while (count-- > 0)
        strcat(text, command);
}

START_TEST(P4_a_motor_that_is_not_there_is_refused)
{
    struct rkm04_motor_state state;
    uint8_t answer[64], character;
    ck_assert_int_eq(rkm04_set_command(&unit, '1' + RKM04_MOTORS, "F1 R", 4, &character), 1);
    ck_assert_uint_eq(character, '1' + RKM04_MOTORS);
    ck_assert(!rkm04_motor_state(&unit, RKM04_MOTORS + 1, &state));
    ck_assert_int_eq(set('0', "F7 R"), 0);
    rkm04_advance(&unit, SECOND);
    size_t length = rkm04_exchange(&unit, (const uint8_t *)"\4" "0", 2, answer, sizeof answer);
    size_t field = answer[2] + 1u;
    ck_assert_uint_eq(length, 2 + RKM04_MOTORS * field);
    for (unsigned motor = 0; motor < RKM04_MOTORS; motor++)
        ck_assert_uint_eq(answer[2 + (motor + 1) * field - 1], '7');
}
END_TEST

START_TEST(P1_one_command_too_many_for_the_memory_is_flag_3)
{
    char text[TEXT_MAX];
    repeat(text, "W1 ", RKM04_PROGRAM_MAX);
    ck_assert_int_eq(set('1', text), 0);
    ck_assert_uint_eq(state_of(1).commands, RKM04_PROGRAM_MAX);
    ck_assert_int_eq(set('1', "W1"), 3);
    ck_assert_uint_eq(state_of(1).commands, RKM04_PROGRAM_MAX);
    rkm04_advance(&unit, 300 * SECOND);
    ck_assert_int_eq(state_of(1).state, RKM04_IDLE);
}
END_TEST

/* Offer a frame with a message of this length. Returns the frames that were dropped. */
static uint32_t offer(size_t length)
{
    struct rkm04_sender sender = {0};
    uint8_t out[RKM04_FRAME_EDGE_MAX];
    static const char head[] = "\2" "1V5 ";
    rkm04_receive(&unit, out, rkm04_hdlc.begin(&sender, 1, 0, length, false, out));
    for (size_t i = 0; i < length; i++)
        rkm04_receive(&unit, out, rkm04_hdlc.put(&sender, (uint8_t)(i < sizeof head - 1 ? head[i] : ' '), out));
    rkm04_receive(&unit, out, rkm04_hdlc.end(&sender, out));
    return rkm04_counters(&unit).dropped;
}

START_TEST(L4_a_request_longer_than_the_figure_is_dropped)
{
    uint8_t byte[64];
    ck_assert_uint_eq(offer(RKM04_MESSAGE_MAX), 0);
    ck_assert_uint_eq(rkm04_counters(&unit).requests, 1);
    while (rkm04_send(&unit, byte, sizeof byte) > 0)
        continue;
    ck_assert_uint_eq(offer(RKM04_MESSAGE_MAX + 1), 1);
    ck_assert_uint_eq(rkm04_counters(&unit).requests, 1);
}
END_TEST

START_TEST(E1_a_segment_too_many_is_a_fault)
{
    char text[TEXT_MAX];
    repeat(text, "F300 V3000 Y F200 V4000 Y F100 V1000 Y F400 V2000 Y ", RKM04_SEGMENTS_MAX / 4);
    ck_assert_int_eq(set('1', strcat(text, "R")), 0);
    rkm04_advance(&unit, 10 * SECOND);
    ck_assert_int_eq(state_of(1).position, 1000 * (RKM04_SEGMENTS_MAX / 4));
    ck_assert_int_eq(state_of(1).fault, RKM04_FAULT_NONE);
    repeat(text, "F10 Y ", RKM04_SEGMENTS_MAX + 1);
    ck_assert_int_eq(set('1', strcat(text, "R")), 0);
    rkm04_advance(&unit, 10 * SECOND);
    ck_assert_int_eq(state_of(1).fault, RKM04_FAULT_MOTION);
    ck_assert_int_eq(state_of(1).position, 1000 * (RKM04_SEGMENTS_MAX / 4));
}
END_TEST

/* As in a unit of full size: from 5 ms on 0.98 s of ramp, 5002 steps at V, 0.98 s of ramp. The last pulse comes at the end. */
START_TEST(R1_a_motion_takes_the_time_of_its_closed_form)
{
    ck_assert_int_eq(set('1', "S100 V5000 A5000 F10000 R"), 0);
    rkm04_advance(&unit, 10 * SECOND);
    ck_assert_int_eq(state_of(1).position, 10000);
    ck_assert_uint_eq(last_step, 2965400);
}
END_TEST

START_TEST(U5_a_program_is_found_in_flash_again)
{
    uint8_t answer[64];
    char text[TEXT_MAX];
    repeat(text, "F1 R ", RKM04_PROGRAM_MAX / 2);
    ck_assert_int_eq(set('0' + RKM04_MOTORS, text), 0);
    const char store[] = {0x03, '0' + RKM04_MOTORS};
    ck_assert_uint_gt(rkm04_exchange(&unit, (const uint8_t *)store, sizeof store, answer, sizeof answer), 0);
    power_up();
    ck_assert_int_eq(state_of(RKM04_MOTORS).slot, RKM04_SLOT_LOADED);
    rkm04_advance(&unit, 10 * SECOND);
    ck_assert_int_eq(state_of(RKM04_MOTORS).position, RKM04_PROGRAM_MAX / 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("small");
    TCase *one = tcase_create("small");
    tcase_add_checked_fixture(one, setup, NULL);
    tcase_add_test(one, P4_a_motor_that_is_not_there_is_refused);
    tcase_add_test(one, P1_one_command_too_many_for_the_memory_is_flag_3);
    tcase_add_test(one, L4_a_request_longer_than_the_figure_is_dropped);
    tcase_add_test(one, E1_a_segment_too_many_is_a_fault);
    tcase_add_test(one, R1_a_motion_takes_the_time_of_its_closed_form);
    tcase_add_test(one, U5_a_program_is_found_in_flash_again);
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* test_paced_unit.c: a unit on a line of 19200 baud (U7, K4, P10). One test alone: CK_RUN_CASE=line ./test_paced_unit */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "../src/host/paced_unit.h"

#define BYTES_MAX 20000
#define REQUEST_MAX 16
#define SECOND UINT64_C(1000000)

/* What has reached the host, and when. */
static struct {
    uint8_t byte[BYTES_MAX];
    uint64_t tick[BYTES_MAX];
    size_t count;
} host;
static struct paced_unit paced;

static void keep(void *context, const uint8_t *bytes, size_t length)
{
    (void)context;
    for (size_t i = 0; i < length && host.count < BYTES_MAX; i++) {
        host.byte[host.count] = bytes[i];
        host.tick[host.count++] = rkm04_now(&paced.unit);
    }
}

static void power_up(bool with_pace)
{
    static const struct rkm04_port nothing;
    const struct rkm04_config config = {.node = 1};
    host.count = 0;
    paced.paced = with_pace;
    paced.out = keep;
    paced_unit_begin(&paced, &config, &nothing, NULL);
}

/* The frame of a request to node 1. Returns its length. */
static size_t frame(const char *message, size_t length, uint8_t *out)
{
    struct rkm04_sender sender = {0};
    size_t n = rkm04_hdlc.begin(&sender, 1, 0, length, false, out);
    for (size_t i = 0; i < length; i++)
        n += rkm04_hdlc.put(&sender, (uint8_t)message[i], out + n);
    return n + rkm04_hdlc.end(&sender, out + n);
}

/* Hand over a request at a tick to which the unit is brought first. Returns its length on the line. */
static size_t ask(const char *message, size_t length, uint64_t tick)
{
    uint8_t bytes[2 * REQUEST_MAX + 2 * RKM04_FRAME_EDGE_MAX];
    size_t n = frame(message, length, bytes);
    paced_unit_advance(&paced, tick);
    paced_unit_take(&paced, bytes, n, tick);
    return n;
}

static uint64_t bytes_take(size_t bytes)
{
    return (bytes * 3125 + 5) / 6;
}

/* The number of answers with message number `number` that the host has got whole and well. */
static unsigned answers(uint8_t number)
{
    struct rkm04_receiver receiver = {0};
    uint8_t buffer[RKM04_MESSAGE_MAX];
    unsigned found = 0;
    for (size_t i = 0; i < host.count; i++)
        if (rkm04_hdlc.receive(&receiver, host.byte[i], host.tick[i], buffer, sizeof buffer) && buffer[0] == number)
            found++;
    return found;
}

START_TEST(U7_each_byte_of_request_and_answer_takes_its_ten_bits)
{
    power_up(true);
    size_t length = ask("\1", 1, 7777);
    paced_unit_advance(&paced, SECOND);
    ck_assert_uint_eq(answers(1), 1);
    for (size_t i = 0; i < host.count; i++) {
        uint64_t request = 7777 + bytes_take(length);
        ck_assert_uint_eq(host.tick[i], (request * 6 + (i + 1) * 3125 + 5) / 6);
    }
}
END_TEST

START_TEST(K4_a_request_acts_when_its_last_byte_has_passed)
{
    power_up(true);
    size_t length = ask("\0021W1000", 7, 0);
    uint64_t tick = bytes_take(length);
    struct rkm04_motor_state state;
    paced_unit_advance(&paced, tick - 1);
    rkm04_motor_state(&paced.unit, 1, &state);
    ck_assert_uint_eq(state.commands, 0);
    paced_unit_advance(&paced, tick);
    rkm04_motor_state(&paced.unit, 1, &state);
    ck_assert_uint_eq(state.commands, 1);
}
END_TEST

START_TEST(U7_six_thousand_bytes_take_their_time_to_the_tick)
{
    static const uint8_t noise[100] = {0};
    power_up(true);
    for (uint64_t i = 0; i < 60; i++) {
        paced_unit_advance(&paced, i * 1000);
        while (paced_unit_room(&paced) < sizeof noise)
            paced_unit_advance(&paced, paced_unit_due(&paced));
        paced_unit_take(&paced, noise, sizeof noise, rkm04_now(&paced.unit));
    }
    uint64_t last = 0;
    while (paced_unit_due(&paced) != RKM04_NEVER) {
        last = paced_unit_due(&paced);
        paced_unit_advance(&paced, last);
    }
    ck_assert_uint_eq(last, 6000 / 6 * 3125);
}
END_TEST

START_TEST(U7_how_the_time_is_cut_makes_no_difference)
{
    power_up(true);
    ask("\1", 1, 100);
    ask("\0040", 2, 100);
    paced_unit_advance(&paced, SECOND);
    static uint64_t ticks[BYTES_MAX];
    size_t count = host.count;
    memcpy(ticks, host.tick, sizeof ticks);

    power_up(true);
    ask("\1", 1, 100);
    ask("\0040", 2, 100);
    for (uint64_t tick = 100; tick < SECOND; tick += 333)
        paced_unit_advance(&paced, tick);
    ck_assert_uint_eq(host.count, count);
    ck_assert_mem_eq(host.tick, ticks, count * sizeof ticks[0]);
}
END_TEST

START_TEST(P10_requests_in_one_go_are_all_answered_one_after_the_other)
{
    power_up(_i == 0);
    for (unsigned i = 0; i < 10; i++) {
        ask("\0040", 2, 0);
        ask("\1", 1, 0);
    }
    paced_unit_advance(&paced, 10 * SECOND);
    ck_assert_uint_eq(answers(4), 10);
    ck_assert_uint_eq(answers(1), 10);
    ck_assert_uint_eq(paced_unit_due(&paced), RKM04_NEVER);
    ck_assert_uint_eq(paced_unit_room(&paced), PACED_UNIT_ROOM);
}
END_TEST

START_TEST(without_pace_the_answer_comes_in_the_tick_of_the_request)
{
    power_up(false);
    ask("\1", 1, 4321);
    paced_unit_advance(&paced, 4321);
    ck_assert_uint_eq(answers(1), 1);
    ck_assert_uint_eq(host.tick[host.count - 1], 4321);
}
END_TEST

START_TEST(a_frame_is_open_until_its_last_byte)
{
    uint8_t bytes[32];
    power_up(false);
    size_t length = frame("\1", 1, bytes);
    paced_unit_take(&paced, bytes, length - 1, 0);
    paced_unit_advance(&paced, 0);
    ck_assert(paced.in_frame);
    paced_unit_take(&paced, bytes + length - 1, 1, 0);
    paced_unit_advance(&paced, 0);
    ck_assert(!paced.in_frame);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("paced_unit");
    TCase *line = tcase_create("line");
    tcase_add_test(line, U7_each_byte_of_request_and_answer_takes_its_ten_bits);
    tcase_add_test(line, K4_a_request_acts_when_its_last_byte_has_passed);
    tcase_add_test(line, U7_six_thousand_bytes_take_their_time_to_the_tick);
    tcase_add_test(line, U7_how_the_time_is_cut_makes_no_difference);
    tcase_add_loop_test(line, P10_requests_in_one_go_are_all_answered_one_after_the_other, 0, 2);
    tcase_add_test(line, without_pace_the_answer_comes_in_the_tick_of_the_request);
    tcase_add_test(line, a_frame_is_open_until_its_last_byte);
    suite_add_tcase(suite, line);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* SPDX-License-Identifier: MIT */
/* line_load.c: a full line at its hardest: sixteen units with four motors each at 16 000 steps/s, polled as fast as 19200 baud
 * allow, for more than ten minutes of virtual time. No step and no answer is lost, and every answer is right to the step.
 * One case alone: CK_RUN_CASE=load ./line_load */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "wire/segment.h"

#define UNITS SEGMENT_UNITS
#define STEPS INT64_C(9700000)
#define SPEED 16000
#define RAMP 2100              /* steps, from S2000 to V16000 at A60000: (16000^2 - 2000^2) / 120000 */
#define RAMP_THIRDS 700000     /* thirds of a tick: 14000 / 60000 s */
#define DURATION (UINT64_C(610) * RKM04_TICKS_PER_SECOND)
#define BYTE_TWELFTHS 6250u    /* of a tick */
#define PROGRAM "\2" "0\\C100 A60000 S2000 V16000 F9700000 R"

static struct segment line;

static struct {
    uint64_t begun;            /* tick at which the motions began */
    uint64_t pulses[RKM04_MOTORS]; /* of unit 1 */
    uint64_t last[RKM04_MOTORS];   /* of them */
    uint64_t lost;             /* pulses that the counter did not follow */
    struct rkm04_receiver receiver;
    uint8_t message[RKM04_MESSAGE_MAX];
    bool answered;
    uint64_t polls, right, bytes;
} load;

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context;
    (void)forward;
    load.lost += position != (int32_t)load.pulses[motor - 1] + 1; /* an assertion each would cost more than the pulses */
    load.pulses[motor - 1] += count;
    load.last[motor - 1] = tick[count - 1];
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum device_event what, uint32_t value)
{
    (void)context;
    if (what == DEVICE_EVENT_MOTION && value == 1 && motor == 1)
        load.begun = tick;
}

static const struct device_port watched = {.steps = on_steps, .event = on_event}, unwatched = {0};

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    (void)context;
    load.bytes += length;
    for (size_t i = 0; i < length; i++)
        load.answered |= rkm04_hdlc.receive(&load.receiver, bytes[i], 0, load.message, sizeof load.message);
}

static void send(uint8_t node, const char *message, size_t length)
{
    struct rkm04_sender sender = {0};
    uint8_t frame[128];
    size_t at = rkm04_hdlc.begin(&sender, node, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, (uint8_t)message[i], frame + at);
    at += rkm04_hdlc.end(&sender, frame + at);
    segment_queue_bytes(&line, frame, at, segment_now(&line));
    load.bytes += at;
}

/* Steps that R1 has done by the tick of a request, in the part with constant speed and after the end (K2: bytes come before the
 * pulses of their tick). */
static int64_t expected_steps(uint64_t tick)
{
    int64_t thirds = 3 * (int64_t)(tick - load.begun - 1) - RAMP_THIRDS;
    return RAMP + thirds * 2 / 375; /* 62.5 ticks a step */
}

static void check_answer(uint64_t asked, uint8_t node)
{
    static const size_t field = 11;
    ck_assert_uint_eq(load.receiver.snode, node);
    ck_assert_uint_eq(load.receiver.length, 2 + RKM04_MOTORS * field);
    for (size_t motor = 0; motor < RKM04_MOTORS; motor++) {
        char text[11] = "";
        memcpy(text, load.message + 2 + motor * field + 1, field - 1);
        int64_t position = strtol(text, NULL, 10);
        bool ramp = asked < load.begun + RAMP_THIRDS / 3 + 1 || position > STEPS - RAMP;
        ck_assert_msg(position <= STEPS && (ramp || position == expected_steps(asked)),
                      "unit %u, motor %zu: %lld steps at tick %llu, expected %lld", node, motor + 1, (long long)position,
                      (unsigned long long)asked, (long long)expected_steps(asked));
    }
    load.right++;
}

/* One request and its answer. */
static void poll_unit(uint8_t node)
{
    load.answered = false;
    load.polls++;
    send(node, "\4" "0", 2);
    uint64_t arrived = 0;
    while (!load.answered && segment_due(&line) != RKM04_NEVER) {
        segment_advance(&line, segment_due(&line));
        if (arrived == 0 && rkm04_sending(rkm04_of(segment_unit(&line, node))))
            arrived = segment_now(&line);
    }
    ck_assert(load.answered);
    check_answer(arrived, node);
}

START_TEST(U3_U7_sixteen_units_at_full_speed_polled_without_a_pause_lose_no_step_and_no_answer)
{
    segment_begin(&line, &(struct segment_config){.timed = true, .turnaround = SEGMENT_TURNAROUND, .out = hear});
    for (unsigned node = 1; node <= UNITS; node++)
        segment_add_unit(&line, &(struct device_config){.node = (uint8_t)node}, node == 1 ? &watched : &unwatched, NULL);
    send(0, PROGRAM, sizeof PROGRAM - 1);
    segment_advance(&line, 100 * RKM04_TICKS_PER_SECOND / 1000);
    uint64_t start = segment_now(&line);
    load.bytes = 0;
    for (uint8_t node = 1; segment_now(&line) < DURATION; node = (uint8_t)(node % UNITS + 1))
        poll_unit(node);
    uint64_t bytes_time = (load.bytes * BYTE_TWELFTHS + 11) / 12, took = segment_now(&line) - start;
    ck_assert_uint_eq(load.right, load.polls);
    ck_assert_uint_eq(load.lost, 0);
    ck_assert_msg(took < bytes_time + load.polls * (SEGMENT_TURNAROUND + 2), "the line stood idle: %llu ticks for %llu bytes",
                  (unsigned long long)took, (unsigned long long)load.bytes);
    ck_assert_uint_ge(load.polls, 18000);
    for (unsigned node = 1; node <= UNITS; node++)
        for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
            struct rkm04_motor_state state;
            rkm04_motor_state(rkm04_of(segment_unit(&line, node)), motor, &state);
            ck_assert_int_eq(state.position, STEPS);
        }
    for (unsigned motor = 0; motor < RKM04_MOTORS; motor++) {
        ck_assert_uint_eq(load.pulses[motor], STEPS);
        /* T_end = 2 t_a + (N - 2 d_a) / v */
        uint64_t sixths = 4 * RAMP_THIRDS + (STEPS - 2 * RAMP) * 375;
        ck_assert_uint_eq(load.last[motor], load.begun + (sixths + 5) / 6);
    }
    struct segment_counters counters = segment_counters(&line);
    ck_assert_uint_eq(counters.collisions, 0);
    ck_assert_uint_eq(counters.overruns, 0);
    ck_assert_uint_eq(counters.framing_errors, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("line_load");
    TCase *load_case = tcase_create("load");
    tcase_set_timeout(load_case, 500);
    tcase_add_test(load_case, U3_U7_sixteen_units_at_full_speed_polled_without_a_pause_lose_no_step_and_no_answer);
    suite_add_tcase(suite, load_case);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* SPDX-License-Identifier: MIT */
/* test_unit_line.c: the unit on its line, in both framings: addresses, silence, answers byte by byte, requests that come too
 * early: L1-L4, P10, U4 of the specification. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "rig.h"

#define WIRE_MAX (2 * RKM04_MESSAGE_MAX + 64)

static struct rig rig;
static const struct rkm04_framing *framing;

static void plug_in(const struct rkm04_framing *with, uint8_t node)
{
    framing = with;
    rig_power_up(&rig, &(struct rkm04_config){.node = node, .framing = with});
}

static void setup(void)
{
    plug_in(&rkm04_hdlc, 1);
}

static void teardown(void)
{
    rig_free(&rig);
}

static size_t frame(uint8_t dnode, uint8_t snode, const void *message, size_t length, bool answer, uint8_t *out)
{
    struct rkm04_sender sender;
    size_t n = framing->begin(&sender, dnode, snode, length, answer, out);
    for (size_t i = 0; i < length; i++)
        n += framing->put(&sender, ((const uint8_t *)message)[i], out + n);
    return n + framing->end(&sender, out + n);
}

/* Everything there is to send. */
static size_t drain(uint8_t *out, size_t room)
{
    size_t n = 0;
    while (n < room && rkm04_send(&rig.unit, out + n, 1) == 1)
        n++;
    ck_assert(!rkm04_sending(&rig.unit));
    return n;
}

/* One request as a string literal. Returns the length of what the unit sends. */
static size_t send_text(uint8_t dnode, uint8_t snode, const char *message, size_t length, uint8_t *answer, size_t room)
{
    uint8_t wire[256];
    size_t n = frame(dnode, snode, message, length, false, wire);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, n), n);
    return drain(answer, room);
}

static void expect_answer(uint8_t dnode, uint8_t snode, const char *message, size_t length, uint8_t to, uint8_t from,
                          const char *answer, size_t answer_length)
{
    uint8_t got[512], wanted[512];
    size_t n = send_text(dnode, snode, message, length, got, sizeof got);
    size_t m = frame(to, from, answer, answer_length, true, wanted);
    ck_assert_uint_eq(n, m);
    ck_assert_mem_eq(got, wanted, n);
}

#define EXPECT_ANSWER(dnode, snode, message, to, from, answer) \
    expect_answer(dnode, snode, message, sizeof(message) - 1, to, from, answer, sizeof(answer) - 1)

static void expect_silence(uint8_t dnode, uint8_t snode, const char *message)
{
    uint8_t got[16];
    ck_assert_uint_eq(send_text(dnode, snode, message, strlen(message), got, sizeof got), 0);
}


START_TEST(U4_a_unit_answers_to_its_own_node_and_to_no_other)
{
    for (size_t f = 0; rkm04_framings[f]; f++)
        for (uint8_t node = 1; node <= 16; node++) {
            plug_in(rkm04_framings[f], node);
            for (uint8_t dnode = 1; dnode <= 16; dnode++)
                if (dnode != node)
                    expect_silence(dnode, 0, "\x02" "1T01");
            ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
            EXPECT_ANSWER(node, 0, "\x02" "1T01", 0, node, "\x02" "1\0\0");
            ck_assert_uint_eq(rig_motor(&rig, 1).commands, 1);
            ck_assert_uint_eq(rkm04_counters(&rig.unit).requests, 1);
            ck_assert_uint_eq(rkm04_counters(&rig.unit).answers, 1);
        }
}
END_TEST

START_TEST(L1_nodes_above_16_are_not_ours)
{
    for (unsigned dnode = 17; dnode < 256; dnode++)
        expect_silence((uint8_t)dnode, 0, "\x02" "1T01");
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
}
END_TEST

START_TEST(L1_a_frame_from_node_1_to_16_is_another_units_answer_and_is_ignored)
{
    plug_in(&rkm04_hdlc, 3);
    for (uint8_t snode = 1; snode <= 16; snode++) {
        expect_silence(3, snode, "\x02" "1T01");
        expect_silence(0, snode, "\x02" "1T01"); /* an answer to the host */
    }
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
    ck_assert_uint_eq(rkm04_counters(&rig.unit).requests, 0);
    ck_assert_uint_eq(rkm04_counters(&rig.unit).others, 32);
}
END_TEST

START_TEST(L1_the_answer_goes_to_the_node_that_has_asked)
{
    plug_in(&rkm04_hdlc, 5);
    EXPECT_ANSWER(5, 0, "\x04" "1", 0, 5, "\x04" "1\x0A" "         0");
    EXPECT_ANSWER(5, 17, "\x04" "1", 17, 5, "\x04" "1\x0A" "         0");
    EXPECT_ANSWER(5, 255, "\x04" "1", 255, 5, "\x04" "1\x0A" "         0");
}
END_TEST

START_TEST(L1_the_answer_of_one_unit_disturbs_no_other)
{
    uint8_t answer[64];
    plug_in(&rkm04_hdlc, 1);
    size_t n = send_text(1, 0, "\x02" "1T01", 5, answer, sizeof answer);
    ck_assert_uint_gt(n, 0);
    plug_in(&rkm04_hdlc, 2);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, answer, n), n);
    ck_assert(!rkm04_sending(&rig.unit));
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
    EXPECT_ANSWER(2, 0, "\x01", 0, 2, "\x01\x10" "01.02,06.03.2009");
}
END_TEST

START_TEST(L1_a_frame_with_one_bit_wrong_is_dropped_and_counted)
{
    uint8_t wire[64];
    size_t n = frame(1, 0, "\x02" "1T01", 6, false, wire);
    wire[5] ^= 0x10;
    ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, n), n);
    ck_assert(!rkm04_sending(&rig.unit));
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
    ck_assert_uint_eq(rkm04_counters(&rig.unit).dropped, 1);
}
END_TEST

START_TEST(L2_a_plain_answer_carries_the_units_own_node)
{
    plug_in(&rkm04_plain, 7);
    uint8_t got[64];
    ck_assert_uint_eq(rkm04_receive(&rig.unit, (const uint8_t *)"\x07\x00\x02\x04" "1", 5), 5);
    ck_assert_uint_eq(drain(got, sizeof got), 16);
    ck_assert_mem_eq(got, "\x07\x00\x0D\x04" "1\x0A" "         0", 16);
}
END_TEST


START_TEST(L3_a_broadcast_is_obeyed_and_not_answered)
{
    for (size_t f = 0; rkm04_framings[f]; f++) {
        plug_in(rkm04_framings[f], 9);
        expect_silence(0, 0, "\x02" "0T80");
        rig_to(&rig, 10 * MS);
        ck_assert_uint_eq(rkm04_variables(&rig.unit), 1);
        ck_assert_uint_eq(rkm04_counters(&rig.unit).answers, 0);
        ck_assert_uint_eq(rkm04_counters(&rig.unit).requests, 1);
    }
}
END_TEST

START_TEST(L3_a_broadcast_store_is_obeyed_and_not_answered)
{
    expect_silence(0, 0, "\x02" "2W9");
    expect_silence(0, 0, "\x03" "2");
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 2), "W9");
}
END_TEST

START_TEST(L3_a_broadcast_with_an_error_is_not_answered_either)
{
    expect_silence(0, 0, "\x02" "1Q");
    expect_silence(0, 0, "\x02" "9T01");
    expect_silence(0, 0, "\x02");
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_uint_eq(rig_motor(&rig, motor).commands, 0);
}
END_TEST

START_TEST(P10_a_broadcast_question_does_nothing)
{
    static const char *const question[] = {"\x01", "\x04" "1", "\x05" "1", "\x06" "1", "\x07" "1", "\x08", "\xFF"};
    for (size_t i = 0; i < sizeof question / sizeof *question; i++)
        expect_silence(0, 0, question[i]);
}
END_TEST


START_TEST(L4_get_command_answers_a_full_memory_of_the_longest_commands)
{
    static uint8_t message[9216], wire[WIRE_MAX], got[WIRE_MAX], wanted[9101];
    size_t length = 2, n = 2;
    memcpy(message, "\x02" "1", 2);
    memcpy(wanted, "\x05" "1", 2);
    for (int i = 0; i < 700; i++) {
        length += (size_t)sprintf((char *)message + length, "=-2000000000%s", i < 699 ? " " : "");
        n += i ? 1 : 0;
        wanted[n - 1] = i ? ' ' : '1';
        memcpy(wanted + n, "=-2000000000", 12);
        n += 12;
    }
    ck_assert_uint_eq(length, 9101);
    ck_assert_uint_eq(n, 9101);
    for (size_t f = 0; rkm04_framings[f]; f++) {
        plug_in(rkm04_framings[f], 1);
        size_t out = frame(1, 0, message, length, false, wire);
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, out), out);
        drain(got, sizeof got);
        size_t asked = frame(1, 0, "\x05" "1", 2, false, wire);
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, asked), asked);
        size_t answered = drain(got, sizeof got);
        ck_assert_uint_eq(answered, frame(0, 1, wanted, 9101, true, wire));
        ck_assert_mem_eq(got, wire, answered);
    }
}
END_TEST

START_TEST(L4_the_longest_request_is_9216_bytes)
{
    static uint8_t message[RKM04_MESSAGE_MAX + 1], wire[WIRE_MAX], got[64];
    for (size_t f = 0; rkm04_framings[f]; f++) {
        plug_in(rkm04_framings[f], 1);
        memset(message, ' ', sizeof message);
        memcpy(message, "\x02" "1", 2);
        message[RKM04_MESSAGE_MAX - 1] = 'U';
        size_t n = frame(1, 0, message, RKM04_MESSAGE_MAX, false, wire);
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, n), n);
        ck_assert_uint_gt(drain(got, sizeof got), 0);
        ck_assert_str_eq(rig_program(&rig, 1), "U");
        n = frame(1, 0, message, RKM04_MESSAGE_MAX + 1, false, wire);
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, n), n);
        ck_assert_uint_eq(drain(got, sizeof got), 0);
        ck_assert_uint_eq(rig_motor(&rig, 1).commands, 1);
        rig_to(&rig, 1 * SECOND); /* the silence ends what plain was still skipping */
        EXPECT_ANSWER(1, 0, "\x04" "1", 0, 1, "\x04" "1\x0A" "         0");
    }
}
END_TEST

/* The same answer whatever room is given for its pieces. */
START_TEST(L4_an_answer_is_the_same_in_pieces_of_any_size)
{
    static uint8_t whole[1024], got[1024];
    rig_accept(&rig, '1', "@7 A500 M05 I01H20 T01 C80 T55 '3 '4 G+ G- G5 =-2000000000 =0 )08 (08 . W1 [ ] O03 Z95 C100 C07");
    uint8_t wire[64];
    size_t asked = frame(1, 0, "\x05" "1", 2, false, wire), length = 0;
    for (size_t room = sizeof whole; room > 0; room = room > 64 ? 64 : room - 1) {
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, asked), asked);
        size_t n = 0, piece;
        while ((piece = rkm04_send(&rig.unit, got + n, room < sizeof got - n ? room : sizeof got - n)) > 0) {
            ck_assert_uint_le(piece, room);
            n += piece;
        }
        ck_assert(!rkm04_sending(&rig.unit));
        if (length == 0) {
            length = n;
            memcpy(whole, got, n);
        }
        ck_assert_uint_eq(n, length);
        ck_assert_mem_eq(got, whole, n);
    }
}
END_TEST

START_TEST(L4_no_room_fetches_nothing)
{
    uint8_t byte, wire[64];
    ck_assert_uint_eq(rkm04_send(&rig.unit, &byte, 1), 0);
    size_t asked = frame(1, 0, "\x01", 1, false, wire);
    rkm04_receive(&rig.unit, wire, asked);
    ck_assert(rkm04_sending(&rig.unit));
    ck_assert_uint_eq(rkm04_send(&rig.unit, &byte, 0), 0);
    ck_assert(rkm04_sending(&rig.unit));
}
END_TEST

START_TEST(P10_an_answer_has_the_content_of_the_tick_of_its_request)
{
    static const char *const question[] = {"\x04" "1", "\x06" "1", "\x07" "1", "\x05" "1"};
    for (size_t i = 0; i < sizeof question / sizeof *question; i++) {
        uint8_t wire[64], wanted[256], got[256];
        plug_in(&rkm04_hdlc, 1);
        rig_accept(&rig, '1', "F1000 R C100 F5 R");
        rig_to(&rig, 1 * SECOND);
        struct rkm04_unit then = rig.unit;
        size_t asked = frame(1, 0, question[i], 2, false, wire);
        rkm04_receive(&rig.unit, wire, asked);
        size_t n = drain(wanted, sizeof wanted), m = 0; /* at once */
        rig.unit = then;
        rkm04_receive(&rig.unit, wire, asked);
        while (rkm04_send(&rig.unit, got + m, 1) == 1) { /* and slowly, while the motion ends and another one runs */
            m++;
            rkm04_advance(&rig.unit, 29 * MS + 7);
        }
        ck_assert_uint_eq(m, n);
        ck_assert_mem_eq(got, wanted, n);
    }
}
END_TEST


START_TEST(P10_requests_in_one_piece_are_answered_in_turn)
{
    for (size_t f = 0; rkm04_framings[f]; f++) {
        uint8_t wire[256], got[512], wanted[512];
        plug_in(rkm04_framings[f], 1);
        size_t a = frame(1, 0, "\x01", 1, false, wire);
        size_t b = a + frame(1, 0, "\x02" "1F7", 4, false, wire + a);
        size_t c = b + frame(1, 0, "\x05" "1", 2, false, wire + b);
        size_t n = 0, taken = 0;
        for (int i = 0; i < 1000 && (taken < c || rkm04_sending(&rig.unit)); i++) {
            taken += rkm04_receive(&rig.unit, wire + taken, c - taken);
            n += rkm04_send(&rig.unit, got + n, 3);
        }
        size_t m = frame(0, 1, "\x01\x10" "01.02,06.03.2009", 18, true, wanted);
        m += frame(0, 1, "\x02" "1\0\0", 4, true, wanted + m);
        m += frame(0, 1, "\x05" "1F7", 4, true, wanted + m);
        ck_assert_uint_eq(taken, c);
        ck_assert_uint_eq(n, m);
        ck_assert_mem_eq(got, wanted, n);
        ck_assert_uint_eq(rkm04_counters(&rig.unit).requests, 3);
        ck_assert_uint_eq(rkm04_counters(&rig.unit).answers, 3);
    }
}
END_TEST

START_TEST(P10_a_request_after_another_is_held_until_its_answer_has_gone)
{
    for (size_t f = 0; rkm04_framings[f]; f++) {
        uint8_t wire[256], got[64];
        plug_in(rkm04_framings[f], 1);
        size_t a = frame(1, 0, "\x04" "1", 2, false, wire);
        size_t b = a + frame(1, 0, "\x02" "1T01", 5, false, wire + a);
        size_t c = b + frame(1, 0, "\x04" "2", 2, false, wire + b);
        uint8_t answer[64];
        size_t length = frame(0, 1, "\x04" "1\x0A" "         0", 13, true, answer);
        size_t taken = rkm04_receive(&rig.unit, wire, c);
        ck_assert_uint_eq(taken, b); /* the second is complete and waits, the third stays outside */
        ck_assert_uint_eq(rkm04_receive(&rig.unit, wire + taken, c - taken), 0);
        rig_to(&rig, 5 * MS + 1);
        ck_assert_uint_eq(rkm04_send(&rig.unit, got, length - 1), length - 1);
        rig_to(&rig, 10 * MS + 1);
        ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
        ck_assert_uint_eq(rkm04_send(&rig.unit, got + length - 1, 1), 1);
        ck_assert_mem_eq(got, answer, length);
        uint8_t first;
        ck_assert_uint_eq(rkm04_send(&rig.unit, &first, 1), 1); /* of the second answer */
        ck_assert_uint_eq(rig_motor(&rig, 1).commands, 1);
        rig_to(&rig, 20 * MS);
        ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 11 * MS);
    }
}
END_TEST

START_TEST(P10_a_question_that_had_to_wait_is_answered_with_what_is_true_when_it_is_taken)
{
    uint8_t wire[64], got[64], wanted[64];
    rig_accept(&rig, '1', "S1000 F900 R");
    rig_to(&rig, 103 * MS + 1); /* 100 steps */
    size_t a = frame(1, 0, "\x04" "1", 2, false, wire);
    size_t b = a + frame(1, 0, "\x04" "1", 2, false, wire + a);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, b), b);
    size_t length = frame(0, 1, "\x04" "1\x0A" "       100", 13, true, wanted);
    rig_to(&rig, 203 * MS + 1);
    ck_assert_uint_eq(rkm04_send(&rig.unit, got, length), length);
    ck_assert_mem_eq(got, wanted, length);
    length = frame(0, 1, "\x04" "1\x0A" "       200", 13, true, wanted);
    ck_assert_uint_eq(drain(got, sizeof got), length);
    ck_assert_mem_eq(got, wanted, length);
}
END_TEST

START_TEST(P10_a_broadcast_after_a_request_waits_too)
{
    uint8_t wire[64], got[64];
    rig_accept(&rig, '1', "W1 W2 W3 W4 W5");
    size_t a = frame(1, 0, "\x05" "1", 2, false, wire);
    size_t b = a + frame(0, 0, "\x02" "0\\T01", 6, false, wire + a);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, b), b);
    rig_to(&rig, 5 * MS);
    uint8_t wanted[64];
    size_t length = frame(0, 1, "\x05" "1W1 W2 W3 W4 W5", 16, true, wanted);
    ck_assert_uint_eq(drain(got, sizeof got), length);
    ck_assert_mem_eq(got, wanted, length);
    ck_assert_str_eq(rig_program(&rig, 1), "T01");
}
END_TEST

START_TEST(P10_frames_for_others_and_broken_frames_do_not_wait)
{
    uint8_t wire[128], got[64];
    size_t n = frame(1, 0, "\x01", 1, false, wire);
    n += frame(2, 0, "\x02" "1T01", 5, false, wire + n);
    n += frame(0, 3, "\x02" "1T01", 5, false, wire + n);
    size_t broken = n;
    n += frame(1, 0, "\x02" "1T01", 5, false, wire + n);
    wire[broken + 4] ^= 1;
    n += frame(1, 0, "\x02" "1T08", 5, false, wire + n);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, wire, n), n);
    drain(got, sizeof got);
    ck_assert_str_eq(rig_program(&rig, 1), "T08");
}
END_TEST

static Suite *unit_line_suite(void)
{
    Suite *suite = suite_create("unit_line");

    TCase *addresses = tcase_create("addresses");
    tcase_add_checked_fixture(addresses, setup, teardown);
    tcase_add_test(addresses, U4_a_unit_answers_to_its_own_node_and_to_no_other);
    tcase_add_test(addresses, L1_nodes_above_16_are_not_ours);
    tcase_add_test(addresses, L1_a_frame_from_node_1_to_16_is_another_units_answer_and_is_ignored);
    tcase_add_test(addresses, L1_the_answer_goes_to_the_node_that_has_asked);
    tcase_add_test(addresses, L1_the_answer_of_one_unit_disturbs_no_other);
    tcase_add_test(addresses, L1_a_frame_with_one_bit_wrong_is_dropped_and_counted);
    tcase_add_test(addresses, L2_a_plain_answer_carries_the_units_own_node);
    suite_add_tcase(suite, addresses);

    TCase *broadcast = tcase_create("broadcast");
    tcase_add_checked_fixture(broadcast, setup, teardown);
    tcase_add_test(broadcast, L3_a_broadcast_is_obeyed_and_not_answered);
    tcase_add_test(broadcast, L3_a_broadcast_store_is_obeyed_and_not_answered);
    tcase_add_test(broadcast, L3_a_broadcast_with_an_error_is_not_answered_either);
    tcase_add_test(broadcast, P10_a_broadcast_question_does_nothing);
    suite_add_tcase(suite, broadcast);

    TCase *answers = tcase_create("answers");
    tcase_add_checked_fixture(answers, setup, teardown);
    tcase_add_test(answers, L4_get_command_answers_a_full_memory_of_the_longest_commands);
    tcase_add_test(answers, L4_the_longest_request_is_9216_bytes);
    tcase_add_test(answers, L4_an_answer_is_the_same_in_pieces_of_any_size);
    tcase_add_test(answers, L4_no_room_fetches_nothing);
    tcase_add_test(answers, P10_an_answer_has_the_content_of_the_tick_of_its_request);
    suite_add_tcase(suite, answers);

    TCase *deferred = tcase_create("deferred");
    tcase_add_checked_fixture(deferred, setup, teardown);
    tcase_add_test(deferred, P10_requests_in_one_piece_are_answered_in_turn);
    tcase_add_test(deferred, P10_a_request_after_another_is_held_until_its_answer_has_gone);
    tcase_add_test(deferred, P10_a_question_that_had_to_wait_is_answered_with_what_is_true_when_it_is_taken);
    tcase_add_test(deferred, P10_a_broadcast_after_a_request_waits_too);
    tcase_add_test(deferred, P10_frames_for_others_and_broken_frames_do_not_wait);
    suite_add_tcase(suite, deferred);

    return suite;
}

int main(void)
{
    return rig_run(unit_line_suite(), "./test_unit_line");
}

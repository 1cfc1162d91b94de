/* SPDX-License-Identifier: MIT */
/* test_wire_monitor.c: what passes on the wires, in words: whole messages, and why something was dropped, refused or ignored
 * (L1, L2, P1-P10). One case alone: CK_RUN_CASE=CASE ./test_wire_monitor */
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "device/rkm04_device.h"
#include "wire/wire_words.h"
#include "wire_rig.h"

#define sim (&wire_rig.sim)
#define HDLC &rkm04_hdlc
#define PLAIN &rkm04_plain

/* A message to unit 3, and what is said of it and of the answer. */
static void dialogue(const void *message, size_t length, const char *request, const char *answer)
{
    wire_rig_ask(3, message, length);
    wire_rig_says(request);
    wire_rig_says(answer);
    wire_rig_says_no_more();
}

#define DIALOGUE(message, request, answer) dialogue(message, sizeof(message) - 1, request, answer)

/* ---- Messages in words ---------------------------------------------------------------------------------------------- */

START_TEST(every_message_is_told_in_words)
{
    wire_rig_begin("3", HDLC);
    DIALOGUE("\1", "master > 3: 1 Version", "3 > master: 1 Version -> \"01.02,06.03.2009\"");
    DIALOGUE("\2" "1\\C100 F50 R", "master > 3: 2 Set Command m1 \"\\C100 F50 R\"", "3 > master: 2 Set Command m1 -> flag 0");
    wire_rig_pass(SECOND);
    DIALOGUE("\4" "0", "master > 3: 4 Get Position m0", "3 > master: 4 Get Position m0 -> 50 0 0 0");
    DIALOGUE("\4" "1", "master > 3: 4 Get Position m1", "3 > master: 4 Get Position m1 -> 50");
    DIALOGUE("\5" "1", "master > 3: 5 Get Command m1", "3 > master: 5 Get Command m1 -> \"C100 F50 R\"");
    DIALOGUE("\6" "1", "master > 3: 6 Get Tabul Run m1", "3 > master: 6 Get Tabul Run m1 -> 0;[]");
    DIALOGUE("\7" "1", "master > 3: 7 Get Pozic Run m1", "3 > master: 7 Get Pozic Run m1 -> 0; 0");
    DIALOGUE("\3" "1", "master > 3: 3 Store Flash m1", "3 > master: 3 Store Flash m1 -> written");
}
END_TEST

START_TEST(characters_that_cannot_be_seen_are_told_as_numbers)
{
    wire_rig_begin("3", HDLC);
    DIALOGUE("\2" "1A5\n\xB4" "7", "master > 3: 2 Set Command m1 \"A5<0A><B4>7\"", "3 > master: 2 Set Command m1 -> flag 0");
}
END_TEST

START_TEST(bytes_after_a_request_are_told_too)
{
    wire_rig_begin("3", HDLC);
    DIALOGUE("\4" "1xy", "master > 3: 4 Get Position m1, and 78 79", "3 > master: 4 Get Position m1 -> 0");
}
END_TEST

START_TEST(U7_a_message_has_the_times_of_its_first_and_last_bit)
{
    wire_rig_begin("3", HDLC);
    wire_rig_pass(12345);
    wire_rig_ask(3, "\1", 1);
    const struct wire_message *request = &wire_rig.message[0], *answer = &wire_rig.message[1];
    ck_assert_uint_eq(request->raw_total, 7);
    ck_assert_uint_eq(request->start, 12345);
    ck_assert_uint_eq(request->end, 12345 + (7 * 6250 + 11) / 12);
    ck_assert_uint_eq(answer->start, 12345 + 7 * 6250 / 12 + SEGMENT_TURNAROUND);
}
END_TEST

START_TEST(the_longest_message_is_told_whole)
{
    static char text[RKM04_MESSAGE_MAX];
    memset(text, 0x7E, sizeof text); /* every byte stuffed */
    text[0] = 2;
    text[1] = '1';
    memcpy(text + 2, "F9 {", 4);
    text[sizeof text - 1] = '}';
    wire_rig_begin("3", HDLC);
    wire_rig_ask(3, text, sizeof text);
    ck_assert_uint_eq(wire_rig.lines, 2);
    ck_assert_uint_eq(wire_rig.message[0].length, sizeof text);
    ck_assert_uint_eq(wire_rig.message[0].raw_length, wire_rig.message[0].raw_total);
    ck_assert_ptr_null(wire_rig.message[0].dropped);
}
END_TEST

/* With plain there is no check sum: what noise has made of a message is reported as far as it goes. */
START_TEST(damaged_messages_are_told_in_characters_that_can_be_seen)
{
    uint32_t random = 54321;
    for (unsigned round = 0; round < 20000; round++) {
        uint8_t message[24];
        char words[200];
        size_t length = 1 + round % sizeof message;
        for (size_t i = 0; i < length; i++) {
            random = random * 1664525u + 1013904223u;
            message[i] = (uint8_t)(random >> 24 & (random >> 16 & 1 ? 0xFFu : 0x0Fu));
        }
        message[0] = round % 9 == 8 ? 255 : (uint8_t)(round % 9);
        if (length > 1 && (round & 16) != 0)
            message[1] = (uint8_t)('0' + (round >> 5) % 5);
        struct wire_text text = {.text = words, .room = round % 7 == 0 ? 10 : sizeof words};
        wire_words_message(&text, rkm04_device.words, message, length, round % 2 == 0);
        rkm04_device.words->refusal(&text, message, length);
        size_t seen = 0;
        while (seen < text.length && words[seen] >= ' ' && words[seen] <= '~')
            seen++;
        if (seen == 0 || seen != text.length || text.length > text.room)
            ck_abort_msg("round %u: character %zu of %zu", round, seen, text.length);
    }
}
END_TEST

/* ---- Dropped -------------------------------------------------------------------------------------------------------- */

START_TEST(L1_frames_that_are_none_are_dropped_with_the_reason)
{
    wire_rig_begin("3", HDLC);
    wire_rig_bytes("7E 03 00 01 12 34 7E");
    wire_rig_settle();
    wire_rig_says("master: dropped: wrong FCS");
    wire_rig_bytes("7E 03 00 7D 7E");
    wire_rig_settle();
    wire_rig_says("master: dropped: aborted");
    wire_rig_bytes("7E 03 00 7E");
    wire_rig_settle();
    wire_rig_says("master: dropped: too short");
    wire_rig_says_no_more();
}
END_TEST

START_TEST(L1_empty_frames_are_nothing_and_one_flag_ends_a_frame_and_begins_the_next)
{
    wire_rig_begin("3", HDLC);
    uint8_t frame[64];
    size_t length = wire_rig_frame(0, 0, "\3" "1", 2, frame);
    wire_rig_bytes("7E 7E 7E");
    sim_queue_bytes(sim, frame, length, 0);
    sim_queue_bytes(sim, frame + 1, length - 1, 0);
    wire_rig_settle();
    wire_rig_says("master > all: 3 Store Flash m1");
    wire_rig_says("master > all: 3 Store Flash m1");
    wire_rig_says_no_more();
    ck_assert_uint_eq(wire_rig.message[0].raw_total, length);
    ck_assert_uint_eq(wire_rig.message[1].raw_total, length - 1);
}
END_TEST

START_TEST(L1_bytes_of_a_client_that_knows_no_frames_are_told_as_such)
{
    wire_rig_begin("3", HDLC);
    wire_rig_bytes("03 00 02 34 31"); /* plain */
    wire_rig_settle();
    wire_rig_pass(200 * MS);
    wire_rig_bytes("03");
    wire_rig_settle();
    wire_rig_says("master: dropped: no frame");
    wire_rig_says_no_more();
    ck_assert_uint_eq(wire_rig.message[0].raw_total, 5);
    wire_rig_ask(3, "\1", 1);
    wire_rig_says("master: dropped: no frame");
    wire_rig_says("master > 3: 1 Version");
}
END_TEST

START_TEST(L4_a_request_that_is_too_long_is_told_once)
{
    static uint8_t text[RKM04_MESSAGE_MAX + 1] = {2, '1'};
    wire_rig_begin("3", HDLC);
    memset(text + 2, ' ', sizeof text - 2);
    wire_rig_ask(3, text, sizeof text);
    wire_rig_says("master: dropped: too long");
    wire_rig_says_no_more();
    ck_assert_uint_eq(wire_rig.message[0].raw_total, RKM04_MESSAGE_MAX + 1 + 5); /* the last flag begins the next one */
    wire_rig_ask(3, "\1", 1);
    wire_rig_says("master > 3: 1 Version");
}
END_TEST

START_TEST(L2_plain_frames_that_are_none_are_dropped_with_the_reason)
{
    wire_rig_begin("3", PLAIN);
    wire_rig_bytes("41 42 43 03 00 00");
    wire_rig_settle();
    wire_rig_says("master: dropped: no frame, no address above 16");
    wire_rig_says("master: dropped: impossible length");
    wire_rig_bytes("03 00 02 34");
    wire_rig_settle();
    wire_rig_pass(100 * MS);
    wire_rig_says_no_more();
    wire_rig_bytes("03 00 02 04 31");
    wire_rig_settle();
    wire_rig_says("master: dropped: silence inside");
    wire_rig_says("master > 3: 4 Get Position m1");
    wire_rig_says("3 > master: 4 Get Position m1 -> 0");
    wire_rig_says_no_more();
    ck_assert_uint_eq(wire_rig.message[0].raw_total, 3);
    ck_assert_uint_eq(wire_rig.message[2].raw_total, 4);
}
END_TEST

START_TEST(U7_a_break_is_told_and_damages_the_frame_around_it)
{
    wire_rig_begin("3", HDLC);
    wire_rig_bytes("7E 03 00 01");
    wire_rig_settle();
    sim_break(sim, true);
    wire_rig_pass(2 * MS);
    sim_break(sim, false);
    wire_rig_pass(1 * MS);
    wire_rig_bytes("7E");
    wire_rig_settle();
    wire_rig_says("master: dropped: break");
    wire_rig_says("master: dropped: too short; lost to framing errors: 1 byte");
    wire_rig_says_no_more();
}
END_TEST

START_TEST(what_is_incomplete_at_the_end_is_told)
{
    wire_rig_begin("3", HDLC);
    wire_rig_ask(3, "\1", 1);
    ck_assert_ptr_null(wire_monitor_rest(&sim->monitor, false));
    ck_assert_ptr_null(wire_monitor_rest(&sim->monitor, true));
    wire_rig_bytes("7E 03 00");
    wire_rig_settle();
    struct wire_message *rest = wire_monitor_rest(&sim->monitor, false);
    ck_assert_ptr_nonnull(rest);
    ck_assert_str_eq(rest->dropped, "unfinished");
    ck_assert_uint_eq(rest->raw_total, 3);
    free(rest);
    wire_rig_says("master > 3: 1 Version");
    wire_rig_says("3 > master: 1 Version -> \"01.02,06.03.2009\"");
}
END_TEST

/* ---- Collisions ----------------------------------------------------------------------------------------------------- */

START_TEST(U4_answers_of_two_units_of_one_address_are_a_collision)
{
    wire_rig_begin("5,5", HDLC);
    wire_rig_ask(5, "\1", 1);
    wire_rig_says("master > 5: 1 Version");
    wire_rig_says("5+5-2 > master: 1 Version -> \"01.02,06.03.2009\"; collision: 5+5-2"); /* the same bits */
    sim_power(sim, 2, true);
    wire_rig_ask(5, "\2" "1F7 R", 6);
    wire_rig_says("master > 5: 2 Set Command m1 \"F7 R\"");
    wire_rig_says("5+5-2 > master: 2 Set Command m1 -> flag 0; collision: 5+5-2");
    wire_rig_pass(SECOND);
    sim_power(sim, 1, true);
    wire_rig_ask(5, "\4" "1", 2);
    wire_rig_says("master > 5: 4 Get Position m1");
    wire_rig_says("5+5-2: dropped: wrong FCS; collision: 5+5-2");
    wire_rig_says_no_more();
}
END_TEST

START_TEST(P10_a_request_during_an_answer_collides_with_it_and_both_are_told)
{
    wire_rig_begin("3", HDLC);
    wire_rig_send(3, "\1", 1);
    wire_rig_pass(8 * MS); /* the answer goes out */
    wire_rig_bytes("7E 03 00 04 31");
    wire_rig_settle();
    wire_rig_says("master > 3: 1 Version");
    unsigned damaged = wire_rig.lines - 1;
    ck_assert_str_eq(wire_rig.line[damaged],
                     "master+3: dropped: wrong FCS; lost to framing errors: 4 bytes; collision: master+3");
    for (unsigned at = 1; at < damaged; at++)
        ck_assert_ptr_nonnull(strstr(wire_rig.line[at], ": dropped: framing error"));
    wire_rig_ask(3, "\1", 1); /* its flag ends what the collision has left of the request */
    ck_assert_str_eq(wire_rig.line[damaged + 1],
                     "master+3: dropped: too short; lost to framing errors: 3 bytes; collision: master+3");
    ck_assert_str_eq(wire_rig.line[damaged + 2], "master > 3: 1 Version");
}
END_TEST

/* ---- Ignored -------------------------------------------------------------------------------------------------------- */

START_TEST(L3_a_request_that_no_unit_obeys_is_told_with_the_reason)
{
    uint8_t frame[64];
    wire_rig_begin("3,5", HDLC);
    wire_rig_ask(7, "\1", 1);
    wire_rig_says("master > 7: 1 Version; ignored: there is no unit 7");
    wire_rig_ask(0, "\4" "1", 2);
    wire_rig_says("master > all: 4 Get Position m1; ignored: a request to all units is not answered (P10)");
    sim_power(sim, 1, false);
    wire_rig_ask(3, "\1", 1);
    wire_rig_says("master > 3: 1 Version; ignored: no power at unit 3");
    sim_queue_bytes(sim, frame, wire_rig_frame(5, 4, "\1", 1, frame), sim_now(sim));
    wire_rig_settle();
    wire_rig_says("master as 4 > 5: 1 Version; ignored: by its sender's address it is the answer of a unit (L1)");
    wire_rig_ask(0, "\2" "1F1", 4);
    wire_rig_says("master > all: 2 Set Command m1 \"F1\"");
    sim_power(sim, 2, false);
    wire_rig_ask(0, "\2" "1F1", 4);
    wire_rig_says("master > all: 2 Set Command m1 \"F1\"; ignored: no unit has power");
    wire_rig_says_no_more();
}
END_TEST

START_TEST(P10_a_request_that_comes_while_another_one_waits_is_told_as_lost)
{
    wire_rig_begin_slow("3", HDLC, 100 * MS);
    for (unsigned i = 0; i < 3; i++)
        wire_rig_send(3, "\1", 1);
    wire_rig_settle();
    wire_rig_says("master > 3: 1 Version");
    wire_rig_says("master > 3: 1 Version");
    wire_rig_says("master > 3: 1 Version; ignored: bytes lost, a unit had a request waiting (P10)");
    wire_rig_says("3 > master: 1 Version -> \"01.02,06.03.2009\"");
    wire_rig_says("3 > master: 1 Version -> \"01.02,06.03.2009\"");
    wire_rig_says_no_more();
}
END_TEST

/* ---- Refused -------------------------------------------------------------------------------------------------------- */

START_TEST(P1_refusals_of_Set_Command_are_told_with_the_character)
{
    wire_rig_begin("3", HDLC);
    DIALOGUE("\2" "1V0", "master > 3: 2 Set Command m1 \"V0\"",
             "3 > master: 2 Set Command m1 -> flag 1 'V'; refused: bad value after 'V'");
    DIALOGUE("\2" "1f5", "master > 3: 2 Set Command m1 \"f5\"",
             "3 > master: 2 Set Command m1 -> flag 2 'f'; refused: unknown command 'f'");
    DIALOGUE("\2" "7F5", "master > 3: 2 Set Command m7 \"F5\"",
             "3 > master: 2 Set Command m7 -> flag 1 '7'; refused: there is no motor '7'");
    DIALOGUE("\2", "master > 3: 2 Set Command without motor",
             "3 > master: 2 Set Command m0 -> flag 1 '<00>'; refused: no motor was given");
}
END_TEST

START_TEST(P1_an_overflow_is_told)
{
    char text[2 + RKM04_PROGRAM_MAX + 1] = "\2" "1";
    memset(text + 2, 'D', sizeof text - 2);
    wire_rig_begin("3", HDLC);
    wire_rig_ask(3, text, sizeof text);
    ck_assert_str_eq(wire_rig.line[1], "3 > master: 2 Set Command m1 -> flag 3; refused: program memory overflowed");
}
END_TEST

static int fail_to_erase(void *context, unsigned number, unsigned block)
{
    (void)context, (void)number, (void)block;
    return 1;
}

START_TEST(P4_P5_P6_the_other_refusals_are_told)
{
    wire_rig_begin("3", HDLC);
    DIALOGUE("\3" "9", "master > 3: 3 Store Flash m9", "3 > master: 3 Store Flash m9 -> error 1; refused: there is no motor '9'");
    DIALOGUE("\4" "5", "master > 3: 4 Get Position m5",
             "3 > master: 4 Get Position m5 -> ERROR COMMAND!; refused: there is no motor '5'");
    DIALOGUE("\7" "0", "master > 3: 7 Get Pozic Run m0",
             "3 > master: 7 Get Pozic Run m0 -> ERROR COMMAND!; refused: expected one motor, 1 to 4");
    DIALOGUE("\x08" "1", "master > 3: 8 unknown message, and 31",
             "3 > master: 255 unknown message 8; refused: there is no message 8");
    sim->config.flash.erase = fail_to_erase;
    DIALOGUE("\3" "1", "master > 3: 3 Store Flash m1",
             "3 > master: 3 Store Flash m1 -> error 1; refused: the program could not be written to flash");
}
END_TEST

/* ---- Around --------------------------------------------------------------------------------------------------------- */

START_TEST(a_line_without_time_is_told_like_one_with)
{
    wire_rig_begin_untimed("3,5", PLAIN);
    wire_rig_ask(5, "\4" "0", 2);
    wire_rig_says("master > 5: 4 Get Position m0");
    wire_rig_says("5 > master: 4 Get Position m0 -> 0 0 0 0");
    wire_rig_says_no_more();
}
END_TEST

START_TEST(a_copy_goes_on_with_what_was_half_received)
{
    struct wire_monitor copy;
    wire_rig_begin("3", HDLC);
    ck_assert(wire_monitor_begin(&copy, sim_device(sim), sim->monitor.framing, NULL, (struct wire_monitor_calls){0}));
    wire_rig_bytes("7E 00 00 03 32");
    wire_rig_settle();
    wire_monitor_copy(&copy, &sim->monitor, 0);
    wire_rig_bytes("7E");
    wire_rig_settle();
    wire_rig_says("master: dropped: too short");
    wire_monitor_copy(&sim->monitor, &copy, 1000);
    wire_rig_bytes("6F D6 7E");
    wire_rig_settle();
    ck_assert_uint_eq(wire_rig.message[1].start, 1000);
    ck_assert_uint_eq(wire_rig.message[1].raw_total, 8);
    wire_monitor_end(&copy);
}
END_TEST

/* No bytes of a client may make the monitor stumble, and the counters of the unit agree with what is reported. */
START_TEST(noise_is_told_as_often_as_the_unit_drops_it)
{
    uint32_t random = 12345;
    wire_rig_begin("3", HDLC);
    wire_rig.watcher.kinds = 0;
    for (unsigned round = 0; round < 2; round++) {
        for (unsigned i = 0; i < 20000; i++) {
            random = random * 1664525u + 1013904223u;
            uint8_t byte = random >> 24 < 40 ? 0x7E : random >> 24 < 80 ? 0x7D : (uint8_t)(random >> 16);
            sim_queue_bytes(sim, &byte, 1, sim_now(sim));
            wire_rig_settle();
        }
    }
    const struct rkm04_receiver *monitor = &sim->monitor.requests.receiver, *unit = &rkm04_of(sim_core(sim, 1))->receiver;
    ck_assert_uint_gt(unit->bad_check, 100);
    ck_assert_uint_gt(unit->malformed, 100);
    ck_assert_uint_eq(monitor->bad_check, unit->bad_check);
    ck_assert_uint_eq(monitor->malformed, unit->malformed);
}
END_TEST

static Suite *wire_monitor_suite(void)
{
    Suite *suite = suite_create("wire_monitor");
    TCase *words = tcase_create("words");
    tcase_add_test(words, every_message_is_told_in_words);
    tcase_add_test(words, characters_that_cannot_be_seen_are_told_as_numbers);
    tcase_add_test(words, bytes_after_a_request_are_told_too);
    tcase_add_test(words, U7_a_message_has_the_times_of_its_first_and_last_bit);
    tcase_add_test(words, the_longest_message_is_told_whole);
    tcase_add_test(words, damaged_messages_are_told_in_characters_that_can_be_seen);
    suite_add_tcase(suite, words);
    TCase *dropped = tcase_create("dropped");
    tcase_add_test(dropped, L1_frames_that_are_none_are_dropped_with_the_reason);
    tcase_add_test(dropped, L1_empty_frames_are_nothing_and_one_flag_ends_a_frame_and_begins_the_next);
    tcase_add_test(dropped, L1_bytes_of_a_client_that_knows_no_frames_are_told_as_such);
    tcase_add_test(dropped, L4_a_request_that_is_too_long_is_told_once);
    tcase_add_test(dropped, L2_plain_frames_that_are_none_are_dropped_with_the_reason);
    tcase_add_test(dropped, U7_a_break_is_told_and_damages_the_frame_around_it);
    tcase_add_test(dropped, what_is_incomplete_at_the_end_is_told);
    tcase_add_test(dropped, noise_is_told_as_often_as_the_unit_drops_it);
    suite_add_tcase(suite, dropped);
    TCase *collisions = tcase_create("collisions");
    tcase_add_test(collisions, U4_answers_of_two_units_of_one_address_are_a_collision);
    tcase_add_test(collisions, P10_a_request_during_an_answer_collides_with_it_and_both_are_told);
    suite_add_tcase(suite, collisions);
    TCase *ignored = tcase_create("ignored");
    tcase_add_test(ignored, L3_a_request_that_no_unit_obeys_is_told_with_the_reason);
    tcase_add_test(ignored, P10_a_request_that_comes_while_another_one_waits_is_told_as_lost);
    suite_add_tcase(suite, ignored);
    TCase *refused = tcase_create("refused");
    tcase_add_test(refused, P1_refusals_of_Set_Command_are_told_with_the_character);
    tcase_add_test(refused, P1_an_overflow_is_told);
    tcase_add_test(refused, P4_P5_P6_the_other_refusals_are_told);
    suite_add_tcase(suite, refused);
    TCase *around = tcase_create("around");
    tcase_add_test(around, a_line_without_time_is_told_like_one_with);
    tcase_add_test(around, a_copy_goes_on_with_what_was_half_received);
    suite_add_tcase(suite, around);
    return suite;
}

int main(void)
{
    return rig_run(wire_monitor_suite(), "test_wire_monitor");
}

/* SPDX-License-Identifier: MIT */
/* test_messages.c: every message example of the manual's section 5.3, byte for byte: as a bare message, in an hdlc frame and in
 * a plain one. The frames are written out, check sums and all, so that nothing of the product vouches for itself. */
#include <check.h>
#include <string.h>

#include "core/rig.h"

struct bytes {
    const char *text;
    size_t length;
};

#define BYTES(literal) {literal, sizeof(literal) - 1}

/* The same exchange in three dresses; frames are from the host, node 0, to node 1. */
struct example {
    struct bytes message, reply;
    struct {
        struct bytes request, answer;
    } hdlc, plain;
};

#define FIELD "\x0A" "         0"
#define TABLE                                                                                                                \
    "2 14;[(1;100),(10;500),(901;500),(1045;2000),(1085;2000),(1201;1000),(1401;1000),(1516;2000),(1556;2000),(1701;500),"   \
    "(1801;500),(1829;1000),(2184;1000),(2222;0)]"

static const struct example version = {
    .message = BYTES("\x01"),
    .reply = BYTES("\x01\x10" "01.02,06.03.2009"),
    .hdlc = {BYTES("\x7E\x01\x00\x01" "\x99\x8D\x7E"),
             BYTES("\x7E\x00\x01\x01\x10" "01.02,06.03.2009" "\x8A\xFA\x7E")},
    .plain = {BYTES("\x01\x00\x01\x01"),
              BYTES("\x01\x00\x12\x01\x10" "01.02,06.03.2009")},
};
static const struct example set_command_to_3 = {
    .message = BYTES("\x02" "3C100"),
    .reply = BYTES("\x02" "3" "\x00\x00"),
    .hdlc = {BYTES("\x7E\x01\x00\x02" "3C100" "\xAE\xAB\x7E"),
             BYTES("\x7E\x00\x01\x02" "3" "\x00\x00" "\x77\xAC\x7E")},
    .plain = {BYTES("\x01\x00\x06\x02" "3C100"),
              BYTES("\x01\x00\x04\x02" "3" "\x00\x00")},
};
static const struct example set_command_to_1 = {
    .message = BYTES("\x02" "1C100"),
    .reply = BYTES("\x02" "1" "\x00\x00"),
    .hdlc = {BYTES("\x7E\x01\x00\x02" "1C100" "\x26\xBD\x7E"),
             BYTES("\x7E\x00\x01\x02" "1" "\x00\x00" "\xCF\x19\x7E")},
    .plain = {BYTES("\x01\x00\x06\x02" "1C100"),
              BYTES("\x01\x00\x04\x02" "1" "\x00\x00")},
};
static const struct example store_4 = {
    .message = BYTES("\x03" "4"),
    .reply = BYTES("\x03" "4" "\x00"),
    .hdlc = {BYTES("\x7E\x01\x00\x03" "4" "\xAA\xBD\x7E"),
             BYTES("\x7E\x00\x01\x03" "4" "\x00" "\x6A\xED\x7E")},
    .plain = {BYTES("\x01\x00\x02\x03" "4"),
              BYTES("\x01\x00\x03\x03" "4" "\x00")},
};
static const struct example position_1 = {
    .message = BYTES("\x04" "1"),
    .reply = BYTES("\x04" "1" "\x0A" "         0"),
    .hdlc = {BYTES("\x7E\x01\x00\x04" "1" "\x0F\xA7\x7E"),
             BYTES("\x7E\x00\x01\x04" "1" "\x0A" "         0" "\xB0\x0D\x7E")},
    .plain = {BYTES("\x01\x00\x02\x04" "1"),
              BYTES("\x01\x00\x0D\x04" "1" "\x0A" "         0")},
};
static const struct example position_0 = {
    .message = BYTES("\x04" "0"),
    .reply = BYTES("\x04" "0" FIELD FIELD FIELD FIELD),
    .hdlc = {BYTES("\x7E\x01\x00\x04" "0" "\x86\xB6\x7E"),
             BYTES("\x7E\x00\x01\x04" "0" FIELD FIELD FIELD FIELD "\xE0\xDF\x7E")},
    .plain = {BYTES("\x01\x00\x02\x04" "0"),
              BYTES("\x01\x00\x2E\x04" "0" FIELD FIELD FIELD FIELD)},
};
static const struct example command_2 = {
    .message = BYTES("\x05" "2"),
    .reply = BYTES("\x05" "2C100"),
    .hdlc = {BYTES("\x7E\x01\x00\x05" "2" "\x4C\x8C\x7E"),
             BYTES("\x7E\x00\x01\x05" "2C100" "\x51\xA2\x7E")},
    .plain = {BYTES("\x01\x00\x02\x05" "2"),
              BYTES("\x01\x00\x06\x05" "2C100")},
};
static const struct example command_0 = {
    .message = BYTES("\x05" "0"),
    .reply = BYTES("\x05" "0ERROR COMMAND! "),
    .hdlc = {BYTES("\x7E\x01\x00\x05" "0" "\x5E\xAF\x7E"),
             BYTES("\x7E\x00\x01\x05" "0ERROR COMMAND! " "\x37\xC8\x7E")},
    .plain = {BYTES("\x01\x00\x02\x05" "0"),
              BYTES("\x01\x00\x11\x05" "0ERROR COMMAND! ")},
};
static const struct example table_2 = {
    .message = BYTES("\x06" "2"),
    .reply = BYTES("\x06" TABLE),
    .hdlc = {BYTES("\x7E\x01\x00\x06" "2" "\x24\xA6\x7E"),
             BYTES("\x7E\x00\x01\x06" TABLE "\x60\x25\x7E")},
    .plain = {BYTES("\x01\x00\x02\x06" "2"),
              BYTES("\x01\x00\xA1\x06" TABLE)},
};
static const struct example table_0 = {
    .message = BYTES("\x06" "0"),
    .reply = BYTES("\x06" "0ERROR COMMAND! "),
    .hdlc = {BYTES("\x7E\x01\x00\x06" "0" "\x36\x85\x7E"),
             BYTES("\x7E\x00\x01\x06" "0ERROR COMMAND! " "\x26\xF8\x7E")},
    .plain = {BYTES("\x01\x00\x02\x06" "0"),
              BYTES("\x01\x00\x11\x06" "0ERROR COMMAND! ")},
};
static const struct example progress_4 = {
    .message = BYTES("\x07" "4"),
    .reply = BYTES("\x07" "4 45823; 5"),
    .hdlc = {BYTES("\x7E\x01\x00\x07" "4" "\xCA\xDA\x7E"),
             BYTES("\x7E\x00\x01\x07" "4 45823; 5" "\x5E\xA9\x7E")},
    .plain = {BYTES("\x01\x00\x02\x07" "4"),
              BYTES("\x01\x00\x0B\x07" "4 45823; 5")},
};
static const struct example progress_0 = {
    .message = BYTES("\x07" "0"),
    .reply = BYTES("\x07" "0ERROR COMMAND! "),
    .hdlc = {BYTES("\x7E\x01\x00\x07" "0" "\xEE\x9C\x7E"),
             BYTES("\x7E\x00\x01\x07" "0ERROR COMMAND! " "\x29\xE8\x7E")},
    .plain = {BYTES("\x01\x00\x02\x07" "0"),
              BYTES("\x01\x00\x11\x07" "0ERROR COMMAND! ")},
};
static const struct example unknown_8 = {
    .message = BYTES("\x08"),
    .reply = BYTES("\xFF\x08\x00\x00"),
    .hdlc = {BYTES("\x7E\x01\x00\x08" "\x58\x10\x7E"),
             BYTES("\x7E\x00\x01\xFF\x08\x00\x00" "\xDB\xFF\x7E")},
    .plain = {BYTES("\x01\x00\x01\x08"),
              BYTES("\x01\x00\x04\xFF\x08\x00\x00")},
};

static struct rig rig;

static void setup(void)
{
    rig_power_up(&rig, NULL);
}

static void teardown(void)
{
    ck_assert_uint_eq(rig.flash.misuse, 0);
    rig_free(&rig);
}

static void expect(const char *dress, struct bytes wanted, const uint8_t *got, size_t length)
{
    ck_assert_msg(length == wanted.length, "%s: %zu bytes, not %zu", dress, length, wanted.length);
    for (size_t i = 0; i < length; i++)
        ck_assert_msg(got[i] == (uint8_t)wanted.text[i], "%s: byte %zu is %02X, not %02X", dress, i, got[i],
                      (uint8_t)wanted.text[i]);
}

/* One frame in, the answer out byte by byte. */
static void over_the_line(const struct rkm04_framing *framing, struct bytes request, struct bytes answer)
{
    uint8_t got[512];
    size_t length = 0;
    rig.unit.config.framing = framing;
    memset(&rig.unit.receiver, 0, sizeof rig.unit.receiver); /* nothing received yet in this framing */
    for (size_t i = 0; i < request.length; i++) {
        ck_assert_msg(!rkm04_sending(&rig.unit), "%s: an answer after %zu of %zu bytes", framing->name, i, request.length);
        ck_assert_uint_eq(rkm04_receive(&rig.unit, (const uint8_t *)request.text + i, 1), 1);
    }
    while (length < sizeof got && rkm04_send(&rig.unit, got + length, 1) == 1)
        length++;
    ck_assert(!rkm04_sending(&rig.unit));
    expect(framing->name, answer, got, length);
}

static void talk(const struct example *example)
{
    uint8_t got[512];
    size_t length =
        rkm04_exchange(&rig.unit, (const uint8_t *)example->message.text, example->message.length, got, sizeof got);
    expect("message", example->reply, got, length);
    over_the_line(&rkm04_hdlc, example->hdlc.request, example->hdlc.answer);
    over_the_line(&rkm04_plain, example->plain.request, example->plain.answer);
}

START_TEST(M5_3_1_version_is_answered_with_length_and_text)
{
    talk(&version);
}
END_TEST

START_TEST(M5_3_2_C100_is_sent_to_motor_3)
{
    talk(&set_command_to_3);
    ck_assert_str_eq(rig_program(&rig, 3), "C100 C100 C100");
    for (unsigned motor = 1; motor <= 4; motor++)
        ck_assert_uint_eq(rig_motor(&rig, motor).commands, motor == 3 ? 3 : 0);
}
END_TEST

START_TEST(M5_3_2_motor_1_answers_that_all_is_right)
{
    talk(&set_command_to_1);
}
END_TEST

START_TEST(M5_3_3_motor_4_is_stored_in_flash)
{
    rig_accept(&rig, '4', "W7");
    talk(&store_4);
    rig_power_cycle(&rig);
    ck_assert_str_eq(rig_program(&rig, 4), "W7");
    ck_assert_uint_eq(rig_motor(&rig, 3).commands, 0);
}
END_TEST

START_TEST(M5_3_4_position_of_motor_1_is_ten_characters)
{
    talk(&position_1);
}
END_TEST

START_TEST(M5_3_4_position_of_motor_0_is_four_fields)
{
    talk(&position_0);
}
END_TEST

START_TEST(M5_3_5_the_program_of_motor_2_is_C100)
{
    rig_accept(&rig, '2', "C100");
    talk(&command_2);
    rig_to(&rig, 100 * MS); /* executed, and still in memory */
    talk(&command_2);
}
END_TEST

START_TEST(M5_3_5_the_programs_of_all_motors_cannot_be_asked_for)
{
    talk(&command_0);
}
END_TEST

/* The manual prints the first two points and the last one of fourteen, and the length of the message, 161 bytes. This motion
 * has them: its first ramp ends at d = (500^2 - 100^2) / (2 * 13000) = 9.23, that is at step 10. */
START_TEST(M5_3_6_a_motion_of_fourteen_break_points_is_answered_in_161_bytes)
{
    rig_accept(&rig, '2', "S100 A13000 V500 F900 Y V2000 F300 Y V1000 F200 Y V2000 F300 Y V500 F100 Y V1000 F422 Y R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(table_2.reply.length, 161);
    talk(&table_2);
}
END_TEST

START_TEST(M5_3_6_the_tables_of_all_motors_cannot_be_asked_for)
{
    talk(&table_0);
}
END_TEST

/* R is the fifth command, begins at tick 5000, is at V after 0.45 s and 247.5 steps, and sends pulse 45823 at
 * 5000 + 10^6 (0.45 + (45823 - 247.5) / 1000). */
START_TEST(M5_3_7_motor_4_is_at_step_45823_of_command_5)
{
    rig_accept(&rig, '4', "S100 V1000 A2000 F50000 R");
    rig_to(&rig, 5000 + 450000 + 45575500 + 1);
    talk(&progress_4);
}
END_TEST

START_TEST(M5_3_7_the_progress_of_all_motors_cannot_be_asked_for)
{
    talk(&progress_0);
}
END_TEST

START_TEST(M5_3_8_an_unknown_message_is_answered_with_255_and_its_number)
{
    talk(&unknown_8);
}
END_TEST

static Suite *messages_suite(void)
{
    Suite *suite = suite_create("messages");
    TCase *examples = tcase_create("examples");
    tcase_add_checked_fixture(examples, setup, teardown);
    tcase_add_test(examples, M5_3_1_version_is_answered_with_length_and_text);
    tcase_add_test(examples, M5_3_2_C100_is_sent_to_motor_3);
    tcase_add_test(examples, M5_3_2_motor_1_answers_that_all_is_right);
    tcase_add_test(examples, M5_3_3_motor_4_is_stored_in_flash);
    tcase_add_test(examples, M5_3_4_position_of_motor_1_is_ten_characters);
    tcase_add_test(examples, M5_3_4_position_of_motor_0_is_four_fields);
    tcase_add_test(examples, M5_3_5_the_program_of_motor_2_is_C100);
    tcase_add_test(examples, M5_3_5_the_programs_of_all_motors_cannot_be_asked_for);
    tcase_add_test(examples, M5_3_6_a_motion_of_fourteen_break_points_is_answered_in_161_bytes);
    tcase_add_test(examples, M5_3_6_the_tables_of_all_motors_cannot_be_asked_for);
    tcase_add_test(examples, M5_3_7_motor_4_is_at_step_45823_of_command_5);
    tcase_add_test(examples, M5_3_7_the_progress_of_all_motors_cannot_be_asked_for);
    tcase_add_test(examples, M5_3_8_an_unknown_message_is_answered_with_255_and_its_number);
    suite_add_tcase(suite, examples);
    return suite;
}

int main(void)
{
    return rig_run(messages_suite(), "./test_messages");
}

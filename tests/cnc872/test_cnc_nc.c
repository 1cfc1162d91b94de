/* SPDX-License-Identifier: MIT */
/* NC programs as text (NN1, NN2, NL4). */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "text_rig.h"

static struct cnc_config config;
static struct cnc_nc_program program;

static const struct cnc_nc_block *block(unsigned i)
{
    ck_assert_uint_lt(i, program.block_count);
    return &program.blocks[i];
}

static int64_t target(unsigned i, unsigned axis)
{
    int64_t value = -1;
    ck_assert(cnc_nc_target(&program, block(i), axis, &value));
    return value;
}

static int64_t word(unsigned i, unsigned which)
{
    return cnc_nc_word(&program, block(i), (enum cnc_nc_word)which);
}

static void read_well(const char *text)
{
    bool is_right = text_read_nc(text, &config, &program);
    ck_assert_msg(is_right, "%s", text_reported);
}

START_TEST(nn1_a_line_is_a_block)
{
    cnc_config_clear(&config);
    read_well("\xEF\xBB\xBF( a program )\n\n  ; nothing\nN10\tG1 X10 F1000 (feed)\r\ng0y-2.5z+.25;rapid\nM30");
    ck_assert_uint_eq(program.block_count, 3);
    ck_assert_uint_eq(block(0)->line, 4);
    ck_assert_uint_eq(block(0)->motion, CNC_MOTION_FEED);
    ck_assert_uint_eq(block(0)->axes, 1);
    ck_assert_int_eq(target(0, 0), 655360000);
    ck_assert_int_eq(cnc_nc_value(&program, block(0)->feed), 1000000000);
    ck_assert_uint_eq(block(1)->motion, CNC_MOTION_RAPID);
    ck_assert_int_eq(target(1, 1), -163840000);
    ck_assert_int_eq(target(1, 2), 16384000);
    ck_assert(!cnc_nc_target(&program, block(1), 0, &(int64_t){0}));
    ck_assert_uint_eq(block(2)->motion, CNC_MOTION_NONE);
    ck_assert_uint_eq(block(2)->m[1], 30);
    ck_assert_uint_eq(block(2)->m[2], CNC_NC_NO_M);
    ck_assert_uint_eq(block(2)->feed, block(0)->feed); /* modal */
}
END_TEST

START_TEST(nn1_letters_in_either_case)
{
    ck_assert(text_read_config("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Z\"/><Axis Name=\"4\"/></ChannelConfig>", &config));
    read_well("n5 g1 x1 z3 a4=4 f100 s500 l600 t7 h8 m3 i0=9 r1=10 g4 p0.5");
    ck_assert_uint_eq(block(0)->axes, 1u | 1u << 2 | 1u << 3);
    ck_assert_int_eq(target(0, 3), INT64_C(4) * CNC_U_PER_MM);
    ck_assert_int_eq(cnc_nc_value(&program, block(0)->feed), 100000000);
    ck_assert_int_eq(cnc_nc_value(&program, block(0)->speed), 500000000);
    ck_assert_int_eq(cnc_nc_value(&program, block(0)->speed_limit), 600000000);
    ck_assert_int_eq(word(0, CNC_NC_T), 7);
    ck_assert_int_eq(word(0, CNC_NC_H), 8000000);
    ck_assert_int_eq(word(0, CNC_NC_I0), 9);
    ck_assert_int_eq(word(0, CNC_NC_R0 + 1), 10000000);
    ck_assert_int_eq(word(0, CNC_NC_DELAY), 500000);
    ck_assert_uint_eq(block(0)->m[2], 3);
}
END_TEST

START_TEST(nn1_words)
{
    text_read_config("<ChannelConfig><Axis Name=\"Z\"/><Axis Name=\"4\"/><Axis Name=\"16\"/></ChannelConfig>", &config);
    read_well("G33 A16=1 A4 = -0.000001 Z0.000002 F0.5 T12345678 H5.7 I0=-2147483648 I4=7 R0=1.25 R4=-999999999.999999 M100 M3\n"
              "G4 P0.1 Z1\nI1=3");
    ck_assert_uint_eq(block(0)->motion, CNC_MOTION_THREAD);
    ck_assert_uint_eq(block(0)->axes, 0x800C);
    ck_assert_int_eq(target(0, 2), 131); /* 131.07: cut towards 0 */
    ck_assert_int_eq(target(0, 3), -65); /* -65.5 */
    ck_assert_int_eq(target(0, 15), 65536000);
    ck_assert_int_eq(word(0, CNC_NC_T), 12345678);
    ck_assert_int_eq(word(0, CNC_NC_H), 5700000);
    ck_assert_int_eq(word(0, CNC_NC_I0), -2147483648LL);
    ck_assert_int_eq(word(0, CNC_NC_I0 + 4), 7);
    ck_assert_int_eq(word(0, CNC_NC_R0), 1250000);
    ck_assert_int_eq(word(0, CNC_NC_R0 + 4), -999999999999999);
    ck_assert_int_eq(word(0, CNC_NC_I0 + 1), 0);
    ck_assert_uint_eq(block(0)->words, 1u << CNC_NC_T | 1u << CNC_NC_H | 1u << CNC_NC_I0 | 1u << (CNC_NC_I0 + 4) |
                                       1u << CNC_NC_R0 | 1u << (CNC_NC_R0 + 4));
    ck_assert_uint_eq(block(0)->m[14], 100);
    ck_assert_uint_eq(block(0)->m[2], 3);
    ck_assert_int_eq(word(1, CNC_NC_DELAY), 100000);
    ck_assert_int_eq(target(1, 2), 65536000);
    ck_assert_int_eq(word(2, CNC_NC_I0 + 1), 3);
    ck_assert_int_eq(word(2, CNC_NC_T), 0); /* of this block only */
}
END_TEST

START_TEST(nn1_modes_and_speeds)
{
    cnc_config_clear(&config);
    read_well("S1000 G23\nG96 S100 L2000\nG95\nG97\nG94 G24 S50");
    static const uint8_t modes[] = {CNC_NC_CONTINUOUS, CNC_NC_CONTINUOUS | CNC_NC_CONSTANT_CUT,
                                    CNC_NC_CONTINUOUS | CNC_NC_CONSTANT_CUT | CNC_NC_PER_REVOLUTION,
                                    CNC_NC_CONTINUOUS | CNC_NC_PER_REVOLUTION, 0};
    for (unsigned i = 0; i < 5; i++) {
        ck_assert_uint_eq(block(i)->modes, modes[i]);
        ck_assert_int_eq(cnc_nc_value(&program, block(i)->speed), i < 4 ? 1000000000 : 50000000);
        ck_assert_int_eq(cnc_nc_value(&program, block(i)->cutting_speed), i < 1 ? 0 : 100000000);
        ck_assert_int_eq(cnc_nc_value(&program, block(i)->speed_limit), i < 1 ? 0 : 2000000000);
        ck_assert_uint_eq(block(i)->has_speed, i == 0 || i == 1 || i == 4);
    }
    ck_assert_uint_eq(block(0)->cutting_speed, CNC_NC_NONE);
}
END_TEST

START_TEST(nn2_wrong_texts_are_not_loaded)
{
    static const char *const wrong[][2] = {
        {"X1", "1:1: expected G0, G1 or G33 before an axis\n"},
        {"G1\nN1 Y2 X1", "2:4: expected F before a motion with G1 or G33\n"},
        {"G0 A4=1", "1:4: expected an axis of the configuration, which does not have 4\n"},
        {"G0 A3=1", "1:4: expected A4= to A16=\n"},
        {"G0 A4 1", "1:4: expected A4= to A16=\n"},
        {"G0 X1 X2", "1:7: expected each axis once in a block\n"},
        {"G0 X200000.000001", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G0 X1.2345678", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G0 X", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G0 X1.2.3", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G0 X99999999999999999999999", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"F0", "1:2: expected a number above 0, up to 1000000, up to six decimals\n"},
        {"F-1", "1:2: expected a number above 0, up to 1000000, up to six decimals\n"},
        {"S1000001", "1:2: expected a number above 0, up to 1000000, up to six decimals\n"},
        {"S1 S1", "1:4: expected each word once in a block\n"},
        {"T1 T1", "1:4: expected each word once in a block\n"},
        {"T1.", "1:2: expected a whole number from 0 to 99999999\n"},
        {"H-1", "1:2: expected a number from 0 to 1000000, up to six decimals\n"},
        {"I5=1", "1:1: expected I0= to I4=\n"},
        {"R01=1", "1:1: expected R0= to R4=\n"},
        {"I0=2147483648", "1:4: expected a whole number from -2147483648 to 2147483647\n"},
        {"M3 M4", "1:4: expected one M function of each group in a block\n"},
        {"M77 M78", "1:5: expected one M function of each group in a block\n"},
        {"M101", "1:2: expected M0 to M100\n"},
        {"N1 N2", "1:4: expected N once in a block\n"},
        {"G2 X1 Y1 I2", "1:1: expected G0, G1, G4, G23, G24, G33 or G94 to G97: other functions are not emulated\n"},
        {"G0 G1", "1:4: expected one G function of a kind in a block\n"},
        {"G4", "1:1: expected P with G4\n"},
        {"P1", "1:1: expected G4 with P\n"},
        {"X1 P1 G0", "1:4: expected G4 with P\n"},
        {"G0 X99999999999999999999999.5", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G0 X9999999999999999", "1:5: expected a position from -200000 to 200000 mm, up to six decimals\n"},
        {"G4 (a", "1:4: expected ) behind a comment\n"},
        {"G0 X1\n\x80", "2:1: expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not ?\n"},
        {"G0 \x7F", "1:4: expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not ?\n"},
        {"G0 |1", "1:4: expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not |\n"},
        {"G4 P1 P2", "1:7: expected each word once in a block\n"},
        {"G0 Q1", "1:4: expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not Q\n"},
        {"%", "1:1: expected N, G, X, Y, Z, A4= to A16=, F, S, L, T, H, M, P, I0= to I4=, R0= to R4=, not %\n"},
        {"X1\nF0 F0\nM1\nM1 M0", "1:1: expected G0, G1 or G33 before an axis\n"
                                 "2:2: expected a number above 0, up to 1000000, up to six decimals\n"
                                 "4:4: expected one M function of each group in a block\n"},
    };
    cnc_config_clear(&config);
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        ck_assert_msg(!text_read_nc(wrong[i][0], &config, &program), "accepted: %s", wrong[i][0]);
        ck_assert_str_eq(text_reported, wrong[i][1]);
        ck_assert_uint_eq(program.block_count, 0);
    }
}
END_TEST

START_TEST(nn2_a_byte_0_is_not_a_word)
{
    static const char text[] = "M3 ;a\0b\nM4 (\0)\n";
    static struct cnc_nc_block blocks[4];
    static int64_t values[4];
    program = (struct cnc_nc_program){.blocks = blocks, .values = values, .block_room = 4, .value_room = 4};
    cnc_config_clear(&config);
    text_reported[0] = '\0';
    ck_assert(!cnc_nc_read(text, sizeof text - 1, &config, &program, text_report, NULL));
    ck_assert_str_eq(text_reported, "2:4: expected ) behind a comment\n");
    ck_assert(!cnc_nc_read(text, sizeof text, &config, &program, NULL, NULL));
}
END_TEST

START_TEST(nn2_the_first_twenty_errors)
{
    char text[200] = "";
    for (unsigned i = 0; i < 30; i++)
        strcat(text, "X1\n");
    cnc_config_clear(&config);
    ck_assert(!text_read_nc(text, &config, &program));
    unsigned lines = 0;
    for (const char *at = text_reported; *at != '\0'; at++)
        lines += *at == '\n';
    ck_assert_uint_eq(lines, CNC_TEXT_ERRORS_MAX);
}
END_TEST

START_TEST(nl4_blocks_beyond_the_room_are_refused)
{
    static struct cnc_nc_block blocks[2];
    static int64_t values[3];
    static const char *const texts[] = {"M3\nM4\nM5", "G0 X1 Y1\nX2\n\nZ5", "G0 X1 Y1\nX2 F1", "G0 X1 Y1 Z1\nY1 Z1",
                                        "T1 H1 I1=1\nT1 H1"};
    static const char lines[] = "34222";
    cnc_config_clear(&config);
    for (unsigned i = 0; i < 5; i++) {
        program = (struct cnc_nc_program){.blocks = blocks, .values = values, .block_room = 2, .value_room = 3};
        text_reported[0] = '\0';
        ck_assert(!cnc_nc_read(texts[i], strlen(texts[i]), &config, &program, text_report, NULL));
        ck_assert_str_eq(text_reported + 1, ":1: expected at most 1000000 blocks\n");
        ck_assert_int_eq(text_reported[0], lines[i]);
    }
}
END_TEST

START_TEST(nl4_room_that_a_text_takes)
{
    uint32_t blocks, values;
    static const char text[] = "N1 G1 x1 Z2 (A z)\n\nM3 @[`{;";
    cnc_nc_measure(text_before_hole(text, sizeof text - 1), sizeof text - 1, &blocks, &values);
    ck_assert_uint_eq(blocks, 3);
    ck_assert_uint_eq(values, 7);
    cnc_nc_measure("", 0, &blocks, &values);
    ck_assert_uint_eq(blocks, 1);
    ck_assert_uint_eq(values, 0);
}
END_TEST

START_TEST(nl4_a_million_blocks)
{
    const size_t length = (CNC_NC_BLOCKS_MAX + 1) * 3;
    char *text = malloc(length);
    ck_assert_ptr_nonnull(text);
    for (size_t i = 0; i < length; i += 3)
        memcpy(text + i, "M3\n", 3);
    uint32_t blocks, values;
    cnc_nc_measure(text, length, &blocks, &values);
    ck_assert_uint_eq(blocks, CNC_NC_BLOCKS_MAX);
    program = (struct cnc_nc_program){.blocks = calloc(blocks + 1, sizeof(struct cnc_nc_block)),
                                      .values = calloc(values, sizeof(int64_t)), .block_room = blocks + 1, .value_room = values};
    cnc_config_clear(&config);
    text_reported[0] = '\0';
    ck_assert(cnc_nc_read(text, length - 3, &config, &program, text_report, NULL));
    ck_assert_uint_eq(program.block_count, CNC_NC_BLOCKS_MAX);
    ck_assert(!cnc_nc_read(text, length, &config, &program, text_report, NULL));
    ck_assert_str_eq(text_reported, "1000001:1: expected at most 1000000 blocks\n");
    free(program.blocks);
    free(program.values);
    free(text);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_nc");
    TCase *all = tcase_create("nc");
    tcase_set_timeout(all, 60);
    tcase_add_test(all, nn1_a_line_is_a_block);
    tcase_add_test(all, nn1_letters_in_either_case);
    tcase_add_test(all, nn1_words);
    tcase_add_test(all, nn1_modes_and_speeds);
    tcase_add_test(all, nn2_wrong_texts_are_not_loaded);
    tcase_add_test(all, nn2_a_byte_0_is_not_a_word);
    tcase_add_test(all, nn2_the_first_twenty_errors);
    tcase_add_test(all, nl4_blocks_beyond_the_room_are_refused);
    tcase_add_test(all, nl4_room_that_a_text_takes);
    tcase_add_test(all, nl4_a_million_blocks);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: MIT */
/* test_client_cut.c: how rkmctl cuts a program that does not fit one message (specification L4, C1-C4, C9).
 * One case alone: CK_RUN_CASE=pieces ./test_client_cut */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/text.h>

#include "client/client_cut.h"

#define TAPE_MAX 4000

static struct client_cut cut;

static enum client_cut_result cut_text(const char *text, size_t room)
{
    return client_cut(&cut, text, strlen(text), room);
}

static void assert_pieces(const char *const *expected, size_t count)
{
    ck_assert_uint_eq(cut.pieces, count);
    for (size_t i = 0; i < count; i++) {
        char *piece = strndup(cut.piece[i].text, cut.piece[i].length);
        ck_assert_str_eq(piece, expected[i]);
        free(piece);
    }
}

/* The text is cut into just these pieces. */
#define ASSERT_CUT(text, room, ...) \
    do { \
        const char *const expected[] = {__VA_ARGS__}; \
        ck_assert_int_eq(cut_text(text, room), CLIENT_CUT_DONE); \
        assert_pieces(expected, sizeof expected / sizeof expected[0]); \
        client_cut_free(&cut); \
    } while (0)

/* ---- Cuts --------------------------------------------------------------------------------------------------------- */

START_TEST(L4_a_text_that_fits_is_one_piece_as_it_is)
{
    ASSERT_CUT("F1 R { x } \n", 16, "F1 R { x } \n");
    ASSERT_CUT("F100 R F200 R W1", 16, "F100 R F200 R W1");
    ASSERT_CUT("", 16, "");
    ASSERT_CUT("K", 16, "K");
}
END_TEST

START_TEST(L4_cuts_are_at_borders_of_commands)
{
    ASSERT_CUT("F100 R F200 R F300 R", 16, "[F100 R F200 R", " F300 R]");
    ASSERT_CUT("F1RF22RF333RF4444R", 16, "[F1RF22RF333R", "F4444R]");
    ASSERT_CUT("I 01 H 20 I 80 L 30", 16, "[I 01 H 20 ", "I 80 L 30]");
}
END_TEST

START_TEST(L4_a_comment_that_is_cut_is_closed_and_opened_again)
{
    ASSERT_CUT("F1 { abcdefghijklmnop } R", 16, "[F1 { abcdefgh}", "{ijklmnop } R]");
    ASSERT_CUT("F1 { abcdefg } R W1 ", 16, "[F1 { abcdefg }", " R W1 ]");
    ASSERT_CUT("F1 { abcdefgh} R W1 ", 16, "[F1 { abcdefgh}", " R W1 ]");
    ASSERT_CUT("F1 R { [ ] \\ K { }W1", 16, "[F1 R { [ ] \\ }", "{K { }W1]");
}
END_TEST

START_TEST(L4_the_longest_command_of_a_message_is_sent_and_a_longer_one_is_an_error)
{
    ASSERT_CUT("F1 F000000000123 R", 16, "[F1 ", "F000000000123 ", "R]");
    ASSERT_CUT("F1 F0000000000123 R", 16, "[F1 ", "F0000000000123", " R]");
    ck_assert_int_eq(cut_text("F1 F00000000000123 R", 16), CLIENT_CUT_LONG_COMMAND);
    ck_assert_uint_eq(cut.wrong, 3);
    client_cut_free(&cut);
}
END_TEST

START_TEST(L4_what_the_unit_would_refuse_is_not_cut)
{
    ck_assert_int_eq(cut_text("F1 R q F2", 16), CLIENT_CUT_INVALID);
    ck_assert_uint_eq(cut.wrong, 5);
    client_cut_free(&cut);
    ck_assert_int_eq(cut_text("F1 S9999", 16), CLIENT_CUT_INVALID);
    ck_assert_uint_eq(cut.wrong, 3);
    client_cut_free(&cut);
}
END_TEST

/* ---- Holding ------------------------------------------------------------------------------------------------------ */

START_TEST(C1_a_reset_does_not_drop_the_bracket_that_holds_the_pieces)
{
    ASSERT_CUT("\\ F100 R F200 R W1", 16, "\\ [F100 R F200", " R W1]");
    ASSERT_CUT("F1 \\ F100 R F200 R", 16, "[F1 \\ [F100 R ", "F200 R]");
}
END_TEST

START_TEST(C9_a_block_of_the_program_does_not_let_go_before_the_last_piece)
{
    ASSERT_CUT("[ F1 R ] [ F2 R ] F3 R", 16, "[[ F1 R [ [ F2", " R ] F3 R]");
}
END_TEST

START_TEST(C9_a_block_that_stays_open_stays_open)
{
    ASSERT_CUT("F100 R F200 R [ F300 R", 16, "[F100 R F200 R", " ", "][ F300 R");
    ASSERT_CUT("\\ [ F100 R F200 R W1", 16, "\\ [ F100 R ", "F200 R W1");
}
END_TEST

START_TEST(C9_an_open_block_longer_than_a_message_after_other_commands_is_an_error)
{
    ck_assert_int_eq(cut_text("F1 [ F300 R F400 R W500", 16), CLIENT_CUT_OPEN_BLOCK);
    ck_assert_uint_eq(cut.wrong, 3);
    client_cut_free(&cut);
}
END_TEST

START_TEST(C3_C4_a_command_that_would_act_at_once_is_never_alone_in_a_piece)
{
    ASSERT_CUT("F1 F000000001 V00000000001 F000000002", 16, "[F1 F000000001", "[ V00000000001 ", "F000000002]");
    ASSERT_CUT("F1 F000000001 C00000000075 F000000002", 16, "[F1 F000000001", "[ C00000000075 ", "F000000002]");
    ASSERT_CUT("F1 F000000001 {0123}K{0123} F000000002", 16, "[F1 F000000001", "[ {0123}K{0123}", " F000000002]");
    ASSERT_CUT("F1 F000000001 A00000000001 F000000002", 16, "[F1 F000000001", " A00000000001 ", "F000000002]");
}
END_TEST

START_TEST(C3_a_single_command_still_acts_at_once_whatever_comments_are_around_it)
{
    ASSERT_CUT("{ stop it now } K", 16, "{ stop it now }", " K");
    ASSERT_CUT("{ a comment alone }", 16, "{ a comment al}", "{one }");
}
END_TEST

/* ---- Memory ------------------------------------------------------------------------------------------------------- */

static enum client_cut_result cut_repeated(const char *before, const char *command, unsigned count)
{
    size_t length = strlen(before), each = strlen(command);
    char *text = malloc(length + count * each + 1);
    ck_assert_ptr_nonnull(text);
    memcpy(text, before, length);
    for (unsigned i = 0; i < count; i++)
        memcpy(text + length + i * each, command, each);
    enum client_cut_result result = client_cut(&cut, text, length + count * each, 100);
    free(text);
    return result;
}

START_TEST(C10_698_commands_can_be_sent_in_pieces_and_699_cannot)
{
    ck_assert_int_eq(cut_repeated("", "F1 R ", 349), CLIENT_CUT_DONE);
    ck_assert_uint_eq(cut.places, 700);
    client_cut_free(&cut);
    ck_assert_int_eq(cut_repeated("D", "F1 R ", 349), CLIENT_CUT_TOO_MANY);
    ck_assert_uint_eq(cut.program, 699);
    ck_assert_uint_eq(cut.places - cut.program, 2);
    client_cut_free(&cut);
}
END_TEST

START_TEST(C1_C3_commands_that_take_no_place_do_not_count)
{
    ck_assert_int_eq(cut_repeated("F1 F2 F3 \\ K C75 K", "F1 R ", 349), CLIENT_CUT_DONE);
    ck_assert_uint_eq(cut.program, 698);
    client_cut_free(&cut);
}
END_TEST

/* ---- Any program -------------------------------------------------------------------------------------------------- */

/* What the unit makes of messages: a tape of stored commands, and whether anything of it can run. */
struct tape {
    struct rkm04_command command[TAPE_MAX];
    unsigned count;
};

static bool is_resume(struct rkm04_command command)
{
    return command.op == 'C' && command.argument == 75;
}

static void receive(struct tape *tape, const char *text, size_t length)
{
    struct rkm04_reader reader;
    struct rkm04_command command, first = {0};
    enum rkm04_read found;
    unsigned seen = 0;
    rkm04_read_begin(&reader, text, length);
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND) {
        if (seen++ == 0)
            first = command;
        if (command.op == '\\')
            tape->count = 0;
        else if (command.op != 'K' && !is_resume(command))
            tape->command[tape->count++] = command;
    }
    ck_assert_int_eq(found, RKM04_READ_END);
    bool acts_at_once = seen == 1 && (first.op == 'V' || first.op == 'K' || is_resume(first));
    ck_assert_msg(!acts_at_once, "acts at once: %.*s", (int)length, text);
}

static bool is_bracket(struct rkm04_command command)
{
    return command.op == '[' || command.op == ']';
}

/* How many commands, brackets apart, can run now: those up to the first `[` after the last `]`. */
static unsigned free_to_run(const struct tape *tape)
{
    unsigned last = 0, count = 0;
    for (unsigned i = 0; i < tape->count; i++)
        if (tape->command[i].op == ']')
            last = i;
    for (unsigned i = 0; i < tape->count && !(tape->command[i].op == '[' && i >= last); i++)
        count += !is_bracket(tape->command[i]);
    return count;
}

static void drop_brackets(struct tape *tape)
{
    unsigned count = 0;
    for (unsigned i = 0; i < tape->count; i++)
        if (!is_bracket(tape->command[i]))
            tape->command[count++] = tape->command[i];
    tape->count = count;
}

/* The pieces of the present cut of `text` do what the whole text does, and nothing before the last one. */
static void assert_equivalent(const char *text, size_t length, size_t room)
{
    static struct tape whole, pieces;
    whole.count = pieces.count = 0;
    receive(&whole, text, length);
    for (size_t i = 0; i < cut.pieces; i++) {
        ck_assert_uint_le(cut.piece[i].length, room);
        receive(&pieces, cut.piece[i].text, cut.piece[i].length);
        ck_assert_msg(i + 1 == cut.pieces || free_to_run(&pieces) == 0, "runs early: %.*s", (int)length, text);
    }
    ck_assert_uint_eq(pieces.count, cut.places);
    ck_assert_msg(free_to_run(&whole) == free_to_run(&pieces), "runs otherwise: %.*s", (int)length, text);
    drop_brackets(&whole);
    drop_brackets(&pieces);
    ck_assert_uint_eq(pieces.count, whole.count);
    for (unsigned i = 0; i < whole.count; i++)
        if (pieces.command[i].op != whole.command[i].op || pieces.command[i].argument != whole.command[i].argument)
            ck_abort_msg("command %u of %.*s", i, (int)length, text);
}

static uint32_t seed;

static unsigned any(unsigned below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

static size_t random_program(char *text)
{
    static const char *const parts[] = {
        "F1", "R", "V500", "K", "C75", "I 01 H 20", "[", "]", "S100", "L3 R E", "W1000", "Y", "=-5", "G+", "\\", "'3", "C01",
        "T55", " ", "\n", "{ x }", "{}", "{long comment, } ", "{0123456789abcdef0123456789}", "{ \\ [ ] K }",
    };
    size_t length = 0;
    unsigned count = 2 + any(60);
    for (unsigned i = 0; i < count; i++) {
        const char *part = parts[any(sizeof parts / sizeof parts[0])];
        memcpy(text + length, part, strlen(part));
        length += strlen(part);
    }
    return length;
}

START_TEST(L4_C9_pieces_of_any_program_run_only_when_all_are_there_and_then_as_one_message)
{
    char text[4000];
    unsigned cuts = 0;
    seed = 1;
    for (unsigned round = 0; round < 20000; round++) {
        size_t length = random_program(text), room = CLIENT_ROOM_MIN + any(60);
        enum client_cut_result result = client_cut(&cut, text, length, room);
        ck_assert(result == CLIENT_CUT_DONE || result == CLIENT_CUT_OPEN_BLOCK);
        if (result == CLIENT_CUT_DONE && cut.pieces > 1 && cut.commands > 1) {
            assert_equivalent(text, length, room);
            cuts++;
        }
        client_cut_free(&cut);
    }
    ck_assert_uint_gt(cuts, 10000);
}
END_TEST

static Suite *client_cut_suite(void)
{
    Suite *suite = suite_create("client_cut");
    TCase *pieces = tcase_create("pieces");
    tcase_add_test(pieces, L4_a_text_that_fits_is_one_piece_as_it_is);
    tcase_add_test(pieces, L4_cuts_are_at_borders_of_commands);
    tcase_add_test(pieces, L4_a_comment_that_is_cut_is_closed_and_opened_again);
    tcase_add_test(pieces, L4_the_longest_command_of_a_message_is_sent_and_a_longer_one_is_an_error);
    tcase_add_test(pieces, L4_what_the_unit_would_refuse_is_not_cut);
    suite_add_tcase(suite, pieces);

    TCase *holding = tcase_create("holding");
    tcase_add_test(holding, C1_a_reset_does_not_drop_the_bracket_that_holds_the_pieces);
    tcase_add_test(holding, C9_a_block_of_the_program_does_not_let_go_before_the_last_piece);
    tcase_add_test(holding, C9_a_block_that_stays_open_stays_open);
    tcase_add_test(holding, C9_an_open_block_longer_than_a_message_after_other_commands_is_an_error);
    tcase_add_test(holding, C3_C4_a_command_that_would_act_at_once_is_never_alone_in_a_piece);
    tcase_add_test(holding, C3_a_single_command_still_acts_at_once_whatever_comments_are_around_it);
    suite_add_tcase(suite, holding);

    TCase *memory = tcase_create("memory");
    tcase_add_test(memory, C10_698_commands_can_be_sent_in_pieces_and_699_cannot);
    tcase_add_test(memory, C1_C3_commands_that_take_no_place_do_not_count);
    suite_add_tcase(suite, memory);

    TCase *any_program = tcase_create("any_program");
    tcase_set_timeout(any_program, 120);
    tcase_add_test(any_program, L4_C9_pieces_of_any_program_run_only_when_all_are_there_and_then_as_one_message);
    suite_add_tcase(suite, any_program);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(client_cut_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=pieces|holding|memory|any_program ./test_client_cut\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* SPDX-License-Identifier: MIT */
/* test_coverage.c: what a client has exercised (coverage.h). One test alone: CK_RUN_CASE=coverage ./test_coverage */
#include <check.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/flash_fake.h"
#include "core/store_rig.h"
#include "device/rkm04_device.h"

#define TEXT_MAX 20000

static struct coverage coverage;
static struct rkm04_unit unit;

/* ---- A client of a unit, both listened to ----------------------------------------------------------------------------- */

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    (void)context, (void)tick, (void)motor;
    if (what == RKM04_EVENT_FAULT)
        rkm04_coverage.fault(&coverage, (enum rkm04_fault)value);
}

/* A missing label is a fault: the full list. */
static const struct rkm04_config config = {.node = 1, .readings.label = RKM04_LABEL_FAULT};

static void begin_list(const struct rkm04_config *settings)
{
    const struct device_config device = rkm04_device_config(settings);
    rkm04_coverage.begin(&coverage, &device);
}

static void setup(void)
{
    static struct rkm04_port port;
    begin_list(&config);
    flash_fake_init(&flash);
    port = store_port;
    port.event = on_event;
    rkm04_init(&unit, &config, &port, &flash);
}

static void pass_seconds(unsigned seconds)
{
    rkm04_advance(&unit, (uint64_t)seconds * RKM04_TICKS_PER_SECOND);
}

/* One exchange with the unit. */
static void ask(const char *message, size_t length)
{
    uint8_t answer[RKM04_MESSAGE_MAX];
    rkm04_coverage.request(&coverage, 1, (const uint8_t *)message, length);
    size_t got = rkm04_exchange(&unit, (const uint8_t *)message, length, answer, sizeof answer);
    rkm04_coverage.answer(&coverage, answer, got);
    rkm04_advance(&unit, 20 * RKM04_SLOT_TICKS);
}

/* Set Command; `motor` '0'..'4'. */
static void set(char motor, const char *text)
{
    char message[TEXT_MAX];
    int length = snprintf(message, sizeof message, "\2%c%s", motor, text);
    ck_assert_int_lt(length, TEXT_MAX);
    ask(message, (size_t)length);
}

/* ---- What is asked of the coverage -------------------------------------------------------------------------------------- */

static uint64_t times(enum coverage_group group, const char *name)
{
    for (size_t i = 0; i < coverage.items; i++)
        if (coverage.item[i].group == group && strcmp(coverage.item[i].name, name) == 0)
            return coverage.item[i].count;
    ck_abort_msg("there is no item \"%s\" of the %s", name, coverage_group_name(group));
    return 0;
}

static unsigned covered(enum coverage_group group)
{
    return coverage_sum(&coverage, group).covered;
}

/* All that is missing, for messages of failing tests. */
static const char *missing(void)
{
    static char text[TEXT_MAX];
    text[0] = '\0';
    for (size_t i = 0; i < coverage.items; i++)
        if (coverage.item[i].count == 0)
            strcat(strcat(text, coverage.item[i].name), "; ");
    return text;
}

/* ---- Tests ---------------------------------------------------------------------------------------------------------------- */

START_TEST(nothing_is_covered_at_first)
{
    ck_assert_uint_eq(covered(COVERAGE_GROUPS), 0);
    ck_assert_uint_eq(coverage_sum(&coverage, COVERAGE_GROUPS).total, coverage.items);
    ck_assert_double_eq(coverage_percent(&coverage), 0.0);
}
END_TEST

START_TEST(the_list_has_room_and_no_name_twice)
{
    ck_assert_uint_lt(coverage.items, COVERAGE_ITEMS_MAX);
    for (size_t i = 0; i < coverage.items; i++) {
        ck_assert_uint_lt(strlen(coverage.item[i].name), COVERAGE_NAME_MAX - 1);
        for (size_t j = 0; j < i; j++)
            ck_assert_msg(coverage.item[i].group != coverage.item[j].group ||
                              strcmp(coverage.item[i].name, coverage.item[j].name) != 0,
                          "%s stands there twice", coverage.item[i].name);
    }
}
END_TEST

START_TEST(every_message_counts_by_whom_it_is_sent_to)
{
    ask("\1", 1);
    ask("\4" "0", 2);
    ask("\4" "3", 2);
    ask("\4" "3", 2);
    ask("\10", 1);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "1 Version"), 1);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "4 Get Position, motor 0"), 1);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "4 Get Position, motor 1..4"), 2);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "unknown message"), 1);
    ck_assert_uint_eq(times(COVERAGE_MOTORS, "motor 3"), 2);
    ck_assert_uint_eq(covered(COVERAGE_MESSAGES), 4);
    ck_assert_uint_eq(covered(COVERAGE_MOTORS), 1);
}
END_TEST

START_TEST(P10_a_broadcast_that_does_nothing_covers_nothing)
{
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\1", 1);
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\4" "1", 2);
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\10", 1);
    ck_assert_uint_eq(covered(COVERAGE_GROUPS), 0);
}
END_TEST

START_TEST(L3_a_broadcast_that_is_obeyed_covers_its_commands_too)
{
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\2" "0D", 3);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "2 Set Command, broadcast"), 1);
    ck_assert_uint_eq(times(COVERAGE_MESSAGES, "2 Set Command, motor 0"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "D"), 1);
}
END_TEST

START_TEST(P4_a_message_without_a_right_motor_covers_no_message_of_a_motor)
{
    const char number_alone[] = {2}; /* and no zero after it */
    ask(number_alone, 1);
    ask("\2" "9D", 3);
    ask("\6" "x", 2);
    ck_assert_uint_eq(covered(COVERAGE_MESSAGES), 0);
    ck_assert_uint_eq(covered(COVERAGE_COMMANDS), 0);
    ck_assert_uint_eq(times(COVERAGE_FLAGS, "flag 1, bad value"), 2);
    ck_assert_uint_eq(times(COVERAGE_ERRORS, "6 Get Tabul Run, ERROR COMMAND!"), 1);
}
END_TEST

/* Every command that can be written is on the list, whatever its number; 42..50 alone have no effect and are not (C11). */
START_TEST(every_command_of_the_table_has_its_item)
{
    static const uint32_t numbers[] = {0, 1, 8, 40, 41, 51, 55, 58, 75, 80, 95, 100, 255, 16000, 2000000000, 4000000000,
                                       RKM04_G_FORWARD, RKM04_G_BACK, 8 | 1u << 8 | 80u << 16, 95 | 80u << 16};
    unsigned tried = 0;
    for (unsigned op = 0; op <= UINT8_MAX; op++)
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
            struct rkm04_command command = {(uint8_t)op, numbers[i]};
            char message[2 + RKM04_COMMAND_TEXT_MAX] = "\2" "1";
            if (!rkm04_command_valid(command))
                continue;
            tried++;
            begin_list(&config);
            rkm04_coverage.request(&coverage, 1, (const uint8_t *)message, 2 + rkm04_format(command, message + 2));
            ck_assert_msg(covered(COVERAGE_COMMANDS) == 1, "%s covers %u items", message, covered(COVERAGE_COMMANDS));
        }
    ck_assert_uint_gt(tried, 70);
}
END_TEST

START_TEST(the_forms_of_a_command_count_apart)
{
    set('1', "C01 C02 C85 C100 T41 T55");
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "C01..C08"), 2);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "C80..C95"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "C100"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "T41"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "T51..T58"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "T40"), 0);
    ck_assert_uint_eq(covered(COVERAGE_COMMANDS), 5);
}
END_TEST

START_TEST(G_and_position_count_by_sign_and_I_by_bit_and_level)
{
    set('1', "G5 G+ =-7 =7 I01H3 I95L4 @3 @4");
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "G1..G2000000000"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "G+"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "G-"), 0);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "=-2000000000..=-1"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "=0..=2000000000"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "I01H1..I08H80"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "I80L1..I95L80"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "I01L1..I08L80"), 0);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "I80H1..I95H80"), 0);
}
END_TEST

START_TEST(C3_C4_alone_and_in_a_text_are_two_things)
{
    static const char *const alone[] = {"K alone", "C75 alone", "V1..V16000 alone"};
    static const char *const inside[] = {"K in a text", "C75 in a text", "V1..V16000 in a text"};
    set('1', "{stop} K ");
    set('1', "C75");
    set('1', "V500");
    for (size_t i = 0; i < 3; i++) {
        ck_assert_uint_eq(times(COVERAGE_COMMANDS, alone[i]), 1);
        ck_assert_uint_eq(times(COVERAGE_COMMANDS, inside[i]), 0);
    }
    set('1', "K D");
    set('1', "C75 V500");
    for (size_t i = 0; i < 3; i++) {
        ck_assert_uint_eq(times(COVERAGE_COMMANDS, alone[i]), 1);
        ck_assert_uint_eq(times(COVERAGE_COMMANDS, inside[i]), 1);
    }
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "{ comment }"), 1);
}
END_TEST

START_TEST(P2_a_text_with_an_error_covers_its_flag_and_no_command)
{
    set('1', "D A0");
    set('1', "D ?");
    set('1', "D {");
    ck_assert_uint_eq(covered(COVERAGE_COMMANDS), 0);
    ck_assert_uint_eq(times(COVERAGE_FLAGS, "flag 1, bad value"), 1);
    ck_assert_uint_eq(times(COVERAGE_FLAGS, "flag 2, unknown command"), 2);
    ck_assert_uint_eq(times(COVERAGE_FLAGS, "flag 0, ok"), 0);
}
END_TEST

START_TEST(C1_what_is_before_a_reset_is_not_covered)
{
    set('1', "D \\ H \\ U");
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "\\"), 1);
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "U"), 1);
    ck_assert_uint_eq(covered(COVERAGE_COMMANDS), 2);
}
END_TEST

START_TEST(any_spelling_of_the_call_counts_as_the_call)
{
    set('1', "'7 \"7 \xB4" "7 \x84" "7 @7");
    ck_assert_uint_eq(times(COVERAGE_COMMANDS, "'1..'80"), 4);
}
END_TEST

START_TEST(a_fault_that_the_readings_exclude_is_not_on_the_list)
{
    begin_list(&(struct rkm04_config){.node = 1});
    ck_assert_uint_eq(coverage_sum(&coverage, COVERAGE_FAULTS).total, RKM04_FAULT_MOTION - 1);
}
END_TEST

START_TEST(a_fault_counts_by_its_reason)
{
    set('1', "J5");
    set('2', "E");
    rkm04_coverage.fault(&coverage, RKM04_FAULT_NONE);
    ck_assert_uint_eq(times(COVERAGE_FAULTS, rkm04_fault_name(RKM04_FAULT_NO_LABEL)), 1);
    ck_assert_uint_eq(times(COVERAGE_FAULTS, rkm04_fault_name(RKM04_FAULT_NO_LOOP)), 1);
    ck_assert_uint_eq(covered(COVERAGE_FAULTS), 2);
    ck_assert_uint_eq(coverage_sum(&coverage, COVERAGE_FAULTS).total, RKM04_FAULT_MOTION);
}
END_TEST

START_TEST(storing_counts_by_how_it_went)
{
    set('1', "D");
    ask("\3" "1", 2);
    ck_assert_uint_eq(times(COVERAGE_ERRORS, "3 Store Flash, written"), 1);
    ck_assert_uint_eq(times(COVERAGE_ERRORS, "3 Store Flash, not written"), 0);
    flash_fake_arm(&flash, 1, FLASH_FAIL_NOTHING, 1);
    ask("\3" "1", 2);
    ck_assert_uint_eq(times(COVERAGE_ERRORS, "3 Store Flash, not written"), 1);
}
END_TEST

START_TEST(P7_an_answer_that_is_no_error_text_does_not_count_as_one)
{
    set('1', "E");
    for (char number = 4; number <= 7; number++)
        ask((const char[]){number, '1'}, 2);
    ck_assert_uint_eq(covered(COVERAGE_ERRORS), 0);
    ask("\5" "0", 2);
    ck_assert_uint_eq(times(COVERAGE_ERRORS, "5 Get Command, ERROR COMMAND!"), 1);
    ck_assert_uint_eq(covered(COVERAGE_ERRORS), 1);
}
END_TEST

/* ---- All of it -------------------------------------------------------------------------------------------------------- */

/* Each fault once, by a unit. */
static void provoke_faults(void)
{
    set('1', "\\ J5");
    set('1', "\\ L2 L2 L2 L2 L2 L2 L2 L2 L2");
    set('1', "\\ E");
    set('1', "\\ @1 '1");
    set('1', "\\ .");
    set('1', "\\ R Y R");
    /* While the motor dwells 700 commands more bring the memory round: the start of the loop is gone. */
    char text[TEXT_MAX] = "";
    for (size_t i = 0; i < RKM04_PROGRAM_MAX - 1; i++)
        strcat(text, "D ");
    strcat(text, "E");
    set('1', "\\ L2 W100");
    set('1', text);
    pass_seconds(1);
}

static void exercise_all(void)
{
    for (char number = 1; number <= 8; number++)
        for (char motor = '0'; motor <= '4'; motor++)
            ask((const char[]){number, motor}, 2);
    ask("\4" "x", 2);
    set('1', "A0");
    set('1', "?");
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\2" "0", 2);
    rkm04_coverage.request(&coverage, 0, (const uint8_t *)"\3" "0", 2);
    provoke_faults();
    flash_fake_arm(&flash, 1, FLASH_FAIL_NOTHING, 1);
    ask("\3" "1", 2);
    set('1', "\\ @1 A1 B1 C01 C40 C41 C51 C75 C80 C100 D E F1 G1 G+ G- H I01H1 I01L1 I80H1 I80L1 J1 K L1 M01 N01 O01 O80 R S1 "
             "T01 T40 T41 T51 T80 U V1 W1 X01 Y Z01 Z80 )01 (01 =-1 =1 '1 . [ ] { }");
    set('1', "K");
    set('1', "V1");
    set('1', "C75");
}

START_TEST(a_client_that_does_everything_reaches_100_per_cent)
{
    exercise_all();
    ck_assert_msg(coverage_percent(&coverage) == 100.0, "missing: %s", missing());
}
END_TEST

START_TEST(per_cent_is_rounded_down_so_that_100_means_all)
{
    begin_list(&config);
    for (size_t i = 1; i < coverage.items; i++)
        coverage.item[i].count = 1;
    unsigned tenths = (unsigned)(1000 * (coverage.items - 1) / coverage.items);
    ck_assert_double_lt(coverage_percent(&coverage), 100.0);
    ck_assert_double_eq(coverage_percent(&coverage), tenths / 10.0);
}
END_TEST

/* ---- Reports ------------------------------------------------------------------------------------------------------------ */

static char folder[] = "/tmp/rkm04-coverage-XXXXXX";
static char file[64], json_file[80];

static void make_folder(void)
{
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(file, sizeof file, "%s/report", folder);
    snprintf(json_file, sizeof json_file, "%s/report.json", folder);
}

static void empty_folder(void)
{
    unlink(file);
    unlink(json_file);
}

static void remove_folder(void)
{
    empty_folder();
    rmdir(folder);
}

/* The whole of a file as text. */
static const char *read_file(const char *name)
{
    static char text[TEXT_MAX];
    FILE *in = fopen(name, "r");
    ck_assert_msg(in != NULL, "%s is not there", name);
    text[fread(text, 1, sizeof text - 1, in)] = '\0';
    fclose(in);
    return text;
}

static bool try_report(const char *name)
{
    struct coverage_files files;
    bool ok = coverage_open(&files, name, 0);
    coverage_close(&files);
    return ok;
}

static bool write_report(const char *name)
{
    struct coverage_files files;
    bool ok = coverage_open(&files, name, 0) && coverage_write(&coverage, &files);
    coverage_close(&files);
    return ok;
}

START_TEST(the_text_lists_what_is_covered_and_what_is_missing)
{
    ask("\1", 1);
    ask("\1", 1);
    ck_assert(write_report(file));
    const char *text = read_file(file);
    const char *lacking = strstr(text, "\nmissing\n"), *there = strstr(text, "\ncovered (how often)\n");
    ck_assert_ptr_nonnull(lacking);
    ck_assert_ptr_nonnull(there);
    ck_assert_ptr_nonnull(strstr(there, "  messages  1 Version                                          2\n"));
    ck_assert_ptr_nonnull(strstr(lacking, "  commands  C100\n"));
    ck_assert_ptr_eq(strstr(lacking, "1 Version"), strstr(there, "1 Version"));
}
END_TEST

START_TEST(the_JSON_says_the_same)
{
    ask("\1", 1);
    set('2', "C100");
    ck_assert(write_report(file));
    json_error_t error;
    json_t *report = json_load_file(json_file, 0, &error);
    ck_assert_msg(report != NULL, "%s: %s", json_file, error.text);
    ck_assert_int_eq(json_integer_value(json_object_get(report, "covered")), 5);
    ck_assert_int_eq(json_integer_value(json_object_get(report, "total")), (int)coverage.items);
    ck_assert_double_eq(json_real_value(json_object_get(report, "percent")), coverage_percent(&coverage));
    json_t *groups = json_object_get(report, "groups");
    ck_assert_uint_eq(json_array_size(groups), COVERAGE_GROUPS);
    size_t items = 0, i;
    json_t *group;
    json_array_foreach(groups, i, group)
        items += json_array_size(json_object_get(group, "items"));
    ck_assert_uint_eq(items, coverage.items);
    json_t *first = json_array_get(json_object_get(json_array_get(groups, 0), "items"), 0);
    ck_assert_str_eq(json_string_value(json_object_get(first, "name")), "1 Version");
    ck_assert_int_eq(json_integer_value(json_object_get(first, "count")), 1);
    json_decref(report);
}
END_TEST

START_TEST(a_name_that_ends_in_json_gets_the_JSON_alone)
{
    ck_assert(write_report(json_file));
    ck_assert_int_eq(read_file(json_file)[0], '{');
    ck_assert_int_ne(access(file, F_OK), 0);
}
END_TEST

START_TEST(a_place_that_cannot_be_written_is_known_from_the_start)
{
    char nowhere[96];
    snprintf(nowhere, sizeof nowhere, "%s/none/report", folder);
    ck_assert(!try_report(nowhere));
    ck_assert(!write_report(nowhere));
    ck_assert(try_report(file));
    ck_assert(write_report(file));
    size_t length = strlen(read_file(file));
    ck_assert(try_report(file));
    ck_assert_uint_eq(strlen(read_file(file)), length);
}
END_TEST

START_TEST(a_full_disk_is_reported)
{
    ck_assert_int_eq(symlink("/dev/full", json_file), 0);
    ck_assert(!write_report(file));
    ck_assert_ptr_nonnull(strstr(read_file(file), "missing"));
    empty_folder();
    ck_assert_int_eq(symlink("/dev/full", file), 0);
    ck_assert(!write_report(file));
    ck_assert_int_eq(read_file(json_file)[0], '{');
}
END_TEST

static Suite *coverage_suite(void)
{
    Suite *suite = suite_create("coverage");
    TCase *counting = tcase_create("coverage"), *reports = tcase_create("report");
    tcase_add_checked_fixture(counting, setup, NULL);
    tcase_add_test(counting, nothing_is_covered_at_first);
    tcase_add_test(counting, the_list_has_room_and_no_name_twice);
    tcase_add_test(counting, every_message_counts_by_whom_it_is_sent_to);
    tcase_add_test(counting, P10_a_broadcast_that_does_nothing_covers_nothing);
    tcase_add_test(counting, L3_a_broadcast_that_is_obeyed_covers_its_commands_too);
    tcase_add_test(counting, P4_a_message_without_a_right_motor_covers_no_message_of_a_motor);
    tcase_add_test(counting, every_command_of_the_table_has_its_item);
    tcase_add_test(counting, the_forms_of_a_command_count_apart);
    tcase_add_test(counting, G_and_position_count_by_sign_and_I_by_bit_and_level);
    tcase_add_test(counting, C3_C4_alone_and_in_a_text_are_two_things);
    tcase_add_test(counting, P2_a_text_with_an_error_covers_its_flag_and_no_command);
    tcase_add_test(counting, C1_what_is_before_a_reset_is_not_covered);
    tcase_add_test(counting, any_spelling_of_the_call_counts_as_the_call);
    tcase_add_test(counting, a_fault_counts_by_its_reason);
    tcase_add_test(counting, a_fault_that_the_readings_exclude_is_not_on_the_list);
    tcase_add_test(counting, storing_counts_by_how_it_went);
    tcase_add_test(counting, P7_an_answer_that_is_no_error_text_does_not_count_as_one);
    tcase_add_test(counting, a_client_that_does_everything_reaches_100_per_cent);
    tcase_add_test(counting, per_cent_is_rounded_down_so_that_100_means_all);
    suite_add_tcase(suite, counting);
    tcase_add_unchecked_fixture(reports, make_folder, remove_folder); /* also when a test fails */
    tcase_add_checked_fixture(reports, setup, empty_folder);
    tcase_add_checked_fixture(reports, empty_folder, NULL);
    tcase_add_test(reports, the_text_lists_what_is_covered_and_what_is_missing);
    tcase_add_test(reports, the_JSON_says_the_same);
    tcase_add_test(reports, a_name_that_ends_in_json_gets_the_JSON_alone);
    tcase_add_test(reports, a_place_that_cannot_be_written_is_known_from_the_start);
    tcase_add_test(reports, a_full_disk_is_reported);
    suite_add_tcase(suite, reports);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(coverage_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

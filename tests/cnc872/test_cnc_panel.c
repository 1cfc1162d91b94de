/* SPDX-License-Identifier: MIT */
/* Time, displays, backup memory, switches of the machine (NO1 to NO3, NJ4): the example W38 and the listings of 8.4. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc_rig.h"

/* ---- Time --------------------------------------------------------------------------------------------------------------- */

/* At the end of this T: "HH:MM:SS.hh D.M.YYYY". */
static const char *time_at(uint64_t turn)
{
    static char text[40];
    const struct cnc_cells *cells = &cnc.cells;
    rig_power(NULL, NULL);
    cnc.turn = turn - 1;
    cnc_tick(&cnc);
    const unsigned time = cnc_cell_place(CNC_CELL_SYST_TIME_INFO), date = cnc_cell_place(CNC_CELL_SYST_DATE_INFO);
    ck_assert_mem_eq(cells->memory + time, cells->memory + cnc_cell_place(CNC_CELL_UTC_TIME_INFO), 4);
    ck_assert_mem_eq(cells->memory + date, cells->memory + cnc_cell_place(CNC_CELL_UTC_DATE_INFO), 4);
    snprintf(text, sizeof text, "%02u:%02u:%02u.%02u %u.%u.%u", cells->memory[time + 1], cells->memory[time],
             cells->memory[time + 3], cells->memory[time + 2], cells->memory[date + 2], cells->memory[date + 3],
             (unsigned)cnc_read_number(cells, date, CNC_WORD));
    return text;
}

static int64_t filetime(void)
{
    return cnc_read_number(&cnc.cells, cnc_cell_place(CNC_CELL_FILETIME_INFO), CNC_QWRD);
}

START_TEST(w38_time)
{
    ck_assert_str_eq(time_at(90061500), "01:01:01.50 2.1.2000");
    ck_assert_int_eq(filetime(), 125912484615000000);
}
END_TEST

START_TEST(no1_dates)
{
    static const struct {
        uint64_t day;
        const char *date;
    } dates[] = {{0, "1.1.2000"}, {30, "31.1.2000"}, {31, "1.2.2000"}, {59, "29.2.2000"}, {60, "1.3.2000"}, {365, "31.12.2000"},
                 {366, "1.1.2001"}, {366 + 58, "28.2.2001"}, {366 + 59, "1.3.2001"}, {36524 + 59, "28.2.2100"},
                 {36525 + 59, "1.3.2100"}, {146097, "1.1.2400"}, {146097 + 59, "29.2.2400"}, {146096, "31.12.2399"}};
    for (unsigned i = 0; i < sizeof dates / sizeof *dates; i++)
        ck_assert_str_eq(time_at(dates[i].day * 86400000 + 1) + strlen("00:00:00.00 "), dates[i].date);
    ck_assert_str_eq(time_at(86399999), "23:59:59.99 1.1.2000");
    rig_power(NULL, NULL); /* at power-up */
    ck_assert_int_eq(filetime(), 125911584000000000);
    ck_assert_int_eq(cnc_read_number(&cnc.cells, cnc_cell_place(CNC_CELL_SYST_DATE_INFO), CNC_WORD), 2000);
}
END_TEST

/* ---- Displays ----------------------------------------------------------------------------------------------------------- */

static void write_display(unsigned which, const uint8_t bytes[8])
{
    memcpy(cnc.cells.memory + cnc_cell_place(which == 0 ? CNC_CELL_DISPTOC1 : CNC_CELL_DISPTOC2), bytes, 8);
}

START_TEST(w843_listing)
{
    static const uint8_t abc[8] = {0, 16, 'A', 'b', 'c', 0xFF}, x[8] = {0, 24, 'x', 0, 0xFF, 'y', 2, 1};
    rig_power(NULL, NULL);
    set_bit("BUSY_DISPTOC1", true);
    write_display(0, abc);
    run_to(1);
    ck_assert_int_eq(cnc.display[0].text[0][2], 0); /* not while it is busy */
    set_bit("BUSY_DISPTOC1", false);
    run_to(2);
    ck_assert_mem_eq(cnc.display[0].text[0], "\0\0Abc\0\0\0", 8);
    write_display(0, x);
    run_to(3);
    ck_assert_mem_eq(cnc.display[0].text[0], "\0\0Axc\0y\0", 8); /* 0 and FFh leave what is there */
    ck_assert_uint_eq(cnc.display[0].size, 2);
    ck_assert_uint_eq(cnc.display[0].inverse, 1);
    ck_assert_int_eq(cnc.display[1].text[0][2], 0); /* the other panel */
}
END_TEST

START_TEST(no2_borders_of_a_display)
{
    static const uint8_t corner[8] = {63, 127, 'Z', 'a', 'b', 'c'}, below[8] = {64, 0, 'Q'}, beside[8] = {0, 128, 'Q'};
    static const uint8_t begin[8] = {0, 0, 'B'};
    rig_power(NULL, NULL);
    write_display(1, corner);
    run_to(1);
    ck_assert_int_eq(cnc.display[1].text[7][15], 'Z');
    struct cnc_display before = cnc.display[1];
    write_display(1, below);
    run_to(2);
    write_display(1, beside);
    run_to(3);
    ck_assert_mem_eq(&before, &cnc.display[1], sizeof before);
    set_bit("BUSY_DISPTOC2", true);
    write_display(1, begin);
    run_to(4);
    ck_assert_mem_eq(&before, &cnc.display[1], sizeof before);
    set_bit("BUSY_DISPTOC2", false);
    run_to(5);
    ck_assert_int_eq(cnc.display[1].text[0][0], 'B');
}
END_TEST

START_TEST(no2_keys)
{
    static const char *const names[] = {"PTLTOC_P1", "PTLTOC_P1_2", "PTLTOC_P2", "PTLTOC_P2_2"};
    rig_power(NULL, NULL);
    for (unsigned i = 0; i < 4; i++)
        cnc.panel.key[i] = (uint16_t)(0x1234 + i);
    run_to(1);
    for (unsigned i = 0; i < 4; i++)
        ck_assert_int_eq(cell(names[i], 0), 0x1234 + i);
}
END_TEST

/* ---- Backup memory ------------------------------------------------------------------------------------------------------ */

static unsigned saves, saved_events, failed_events;
static bool can_save;
static uint8_t saved[CNC_BACKUP_SIZE];

static bool save_backup(void *context, const uint8_t *bytes, size_t size)
{
    (void)context;
    ck_assert_uint_eq(size, sizeof saved);
    saves++;
    if (can_save)
        memcpy(saved, bytes, size);
    return can_save;
}

static void count_event(void *context, enum cnc_event event, int64_t value)
{
    (void)context;
    (void)value;
    saved_events += event == CNC_EVENT_SAVED;
    failed_events += event == CNC_EVENT_NOT_SAVED;
}

static void power_with_backup(const uint8_t *backup, bool has_file)
{
    static const struct cnc_port file = {.event = count_event, .save_backup = save_backup}, none = {.event = count_event};
    saves = saved_events = failed_events = 0;
    cnc_config_clear(&config);
    rig_script = NULL;
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .port = has_file ? &file : &none, .backup = backup});
}

START_TEST(no3_backup_memory)
{
    static uint8_t before[CNC_BACKUP_SIZE];
    for (unsigned i = 0; i < sizeof before; i++)
        before[i] = (uint8_t)(i * 7);
    power_with_backup(before, true);
    ck_assert_mem_eq(cnc_backup(&cnc), before, sizeof before);
    can_save = true;
    set_cell("PLC_MEM_BACKUP", 9999, 77);
    set_bit("REQ_BACKUP_MEM", true);
    run_to(1);
    ck_assert(!bit("REQ_BACKUP_MEM"));
    ck_assert_uint_eq(saves, 1);
    ck_assert_uint_eq(saved_events, 1);
    before[9999] = 77;
    ck_assert_mem_eq(saved, before, sizeof before);
    run_to(10);
    ck_assert_uint_eq(saves, 1);
    power_with_backup(NULL, true);
    ck_assert_int_eq(cell("PLC_MEM_BACKUP", 1), 0);
}
END_TEST

START_TEST(no3_saving_fails)
{
    power_with_backup(NULL, true);
    can_save = false;
    set_bit("REQ_BACKUP_MEM", true);
    run_to(1000);
    ck_assert(bit("REQ_BACKUP_MEM"));
    ck_assert_uint_eq(saves, 1); /* not in every T */
    ck_assert_uint_eq(failed_events, 1);
    run_to(1001); /* a second after it, again */
    ck_assert_uint_eq(saves, 2);
    run_to(2000);
    ck_assert_uint_eq(saves, 2);
    can_save = true;
    run_to(2100);
    ck_assert(!bit("REQ_BACKUP_MEM"));
    ck_assert_uint_eq(saves, 3);
    can_save = false;
    set_bit("REQ_BACKUP_MEM", true);
    run_to(2101);
    set_bit("REQ_BACKUP_MEM", false); /* asked for anew: at once */
    run_to(2102);
    can_save = true;
    set_bit("REQ_BACKUP_MEM", true);
    run_to(2103);
    ck_assert(!bit("REQ_BACKUP_MEM"));
}
END_TEST

START_TEST(no3_without_a_file)
{
    power_with_backup(NULL, false);
    set_bit("REQ_BACKUP_MEM", true);
    run_to(1);
    ck_assert(!bit("REQ_BACKUP_MEM"));
    ck_assert_uint_eq(saves, 0);
}
END_TEST

/* ---- Switches ----------------------------------------------------------------------------------------------------------- */

START_TEST(nj4_switches_of_the_machine)
{
    static const struct cnc_switch switches[] = {
        {.place = CNC_BIT_KHx0, .axis = 0, .has_at_least = true, .at_least = 3 * MM},
        {.place = CNC_BIT_KRx + 1, .axis = 0, .has_at_least = true, .has_at_most = true, .at_least = MM, .at_most = 2 * MM},
        {.place = CNC_BIT_ZPRx, .axis = 0, .has_at_most = true, .at_most = MM},
    };
    rig_power(NULL, "G1 X10 F1000");
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .program = &program, .switches = switches, .switch_count = 3});
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(1);
    ck_assert(bit("ZPRX") && !bit("KRY") && !bit("KHX0"));
    uint64_t seen = 0;
    for (uint64_t turn = 2; turn <= 400; turn++) {
        const int64_t before = cnc.axis[0].actual; /* at the end of the last T */
        run_to(turn);
        ck_assert_int_eq(bit("ZPRX"), before <= MM);
        ck_assert_int_eq(bit("KRY"), before >= MM && before <= 2 * MM);
        ck_assert_int_eq(bit("KHX0"), before >= 3 * MM);
        seen = seen == 0 && bit("KHX0") ? turn : seen;
    }
    ck_assert_uint_eq(seen, 199); /* W16 */
    ck_assert_int_eq(at(400).x, 201534008);
}
END_TEST

START_TEST(nj4_the_machine_drives_its_bits_in_every_turn)
{
    static const struct cnc_switch switches[] = {{.place = CNC_BIT_KHx0, .axis = 2, .has_at_least = true, .at_least = MM}};
    rig_power(NULL, NULL);
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .switches = switches, .switch_count = 1});
    set_bit("KHX0", true);
    run_to(1);
    ck_assert(!bit("KHX0"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_panel");
    TCase *all = tcase_create("panel");
    tcase_add_test(all, w38_time);
    tcase_add_test(all, no1_dates);
    tcase_add_test(all, w843_listing);
    tcase_add_test(all, no2_borders_of_a_display);
    tcase_add_test(all, no2_keys);
    tcase_add_test(all, no3_backup_memory);
    tcase_add_test(all, no3_saving_fails);
    tcase_add_test(all, no3_without_a_file);
    tcase_add_test(all, nj4_switches_of_the_machine);
    tcase_add_test(all, nj4_the_machine_drives_its_bits_in_every_turn);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

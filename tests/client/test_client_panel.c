/* SPDX-License-Identifier: MIT */
/* test_client_panel.c: the front panel in a terminal of any size.
 * One test alone: CK_RUN_CASE=sizes ./test_client_panel */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "client/client_panel.h"

static struct panel panel;
static char text[PANEL_ROWS * (PANEL_COLUMNS + 1) + 1];

/* Motor `number` as `state` shows it; `more` replaces members. Takes the reference to `more`. */
static json_t *motor(int number, json_t *more)
{
    json_t *json = json_pack("{s:i, s:i, s:n, s:s, s:i, s:n, s:n, s:n, s:s, s:b, s:i, s:b, s:{s:n, s:n, s:n}}", "motor", number,
                             "position", 0, "true_position", "state", "idle", "index", 0, "command", "waits_for", "fault", "led",
                             "off", "lit", 0, "speed", 0, "forward", 1, "guards", "m", "n", "x");
    json_object_update(json, more);
    json_decref(more);
    return json;
}

static json_t *state(json_t *first, json_t *second)
{
    return json_pack("{s:i, s:s, s:b, s:s, s:i, s:i, s:i, s:[o, o, o, o], s:{s:i, s:i, s:i, s:i}}", "t_us", 12345678, "unit", "3",
                     "powered", 1, "clock", "x10", "di", 0x81, "do", 0x02, "var", 0x8001, "motors", motor(1, first),
                     motor(2, second), motor(3, NULL), motor(4, NULL), "counters", "requests", 17, "answers", 16, "others", 5,
                     "dropped", 1);
}

/* Draw at a size; the result is in `text`. Takes the reference. */
static void draw(json_t *what, int rows, int columns)
{
    struct panel_view view = {.state = what};
    FILE *file = fmemopen(text, sizeof text, "w");
    ck_assert_ptr_nonnull(file);
    client_panel_draw(&panel, &view, rows, columns);
    client_panel_print(&panel, file);
    fclose(file);
    json_decref(what);
}

static void assert_shown(const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "'%s' is not shown:\n%s", part, text);
}

START_TEST(what_a_motor_does_is_in_its_row)
{
    draw(state(json_pack("{s:s, s:i, s:i, s:i, s:i, s:s, s:b, s:b}", "state", "moving", "position", -1234, "true_position", -1200,
                         "speed", 2500, "index", 7, "command", "R", "lit", 1, "forward", 0),
               json_pack("{s:s, s:i, s:s, s:s, s:{s:i}}", "state", "wait", "index", 2, "command", "O01", "waits_for", "DI 01 = 1",
                         "guards", "m", 5)),
         24, 100);
    assert_shown("RKM04 unit 3  12.345678 s  clock x10");
    assert_shown(" 1   *   moving         -1234        -1200   -2500      7  R\n");
    assert_shown(" 2   .   wait               0            -       0      2  O01  DI 01 = 1  M05\n");
    assert_shown(" 3   .   idle               0            -       0      -  -\n");
    assert_shown("17 requests   16 answers   5 for others   1 dropped");
}
END_TEST

START_TEST(lamps_are_under_their_numbers)
{
    draw(state(NULL, NULL), 24, 80);
    assert_shown("      01 02 03 04 05 06 07 08\n DI    *  .  .  .  .  .  .  *\n DO    .  *  .  .  .  .  .  .\n");
    assert_shown("      80 81 82 83 84 85 86 87 88 89 90 91 92 93 94 95\n VAR   *  .  .  .");
}
END_TEST

START_TEST(true_positions_are_shown_where_there_is_a_plant)
{
    draw(state(NULL, NULL), 24, 100);
    ck_assert_ptr_null(strstr(text, "true"));
    draw(state(json_pack("{s:i}", "true_position", 7), NULL), 24, 100);
    assert_shown("true pos.");
}
END_TEST

START_TEST(a_fault_is_named_and_a_unit_without_power_is_called_so)
{
    json_t *off = state(json_pack("{s:s, s:s, s:s}", "state", "fault", "fault", "no_label", "command", "J05"), NULL);
    json_object_set_new(off, "powered", json_false());
    draw(off, 24, 100);
    assert_shown("J05  fault: no_label");
    assert_shown("RKM04 unit 3: no power");
}
END_TEST

START_TEST(at_every_size_nothing_is_wider_or_higher_and_positions_stay_longest)
{
    for (int rows = 0; rows <= 30; rows++) {
        for (int columns = 0; columns <= 130; columns++) {
            draw(state(json_pack("{s:i, s:i}", "position", 4711, "true_position", 9), NULL), rows, columns);
            ck_assert_int_le(panel.rows, rows);
            ck_assert_int_le(panel.columns, columns);
            if (rows >= 5 && columns >= 20)
                assert_shown("4711");
        }
    }
}
END_TEST

START_TEST(what_the_state_lacks_is_a_dash)
{
    draw(json_object(), 24, 100);
    assert_shown("RKM04 unit -");
    assert_shown(" 4   .   -");
    assert_shown("- requests");
}
END_TEST

START_TEST(control_characters_and_others_do_not_reach_the_terminal)
{
    draw(state(json_pack("{s:s}", "command", "\033[2JF5 \302\233m"), NULL), 24, 100);
    ck_assert_ptr_null(strchr(text, '\033'));
    assert_shown("?[2JF5 ??m");
}
END_TEST

/* Every number shown at a width is one that is shown where there is room: none is cut. */
START_TEST(no_number_is_cut_at_any_width)
{
    static const char *const whole[] = {"551", "5000", "1234567", "55123", "12345678", "12.345678", "10", "3", "1", "2", "4", "7",
                                        "0", "17", "16", "5", "23", "24", "25"};
    for (int columns = 12; columns <= 130; columns++) {
        json_t *shown = state(json_pack("{s:s, s:i, s:i, s:s, s:s, s:{s:i}}", "state", "moving", "position", 1234567, "index", 7,
                                        "command", "R", "waits_for", "the end of R: 551 of 5000 steps done", "guards", "m", 5),
                              json_pack("{s:s, s:s}", "command", "W55123", "waits_for", "the end of W55123: 55123 ms left"));
        draw(shown, 12, columns);
        bool lamps = false;
        for (char *at = text; *at != '\0';) {
            size_t length = strspn(at, "0123456789.");
            if (at == text || at[-1] == '\n')
                lamps = strncmp(at, "      ", 6) == 0; /* numbers above lamps */
            bool known = length == 0 || lamps;
            for (size_t i = 0; i < sizeof whole / sizeof *whole && !known; i++)
                known = strlen(whole[i]) == length && memcmp(at, whole[i], length) == 0;
            ck_assert_msg(known || strspn(at, "0.") > 0 || at[-1] == 'M' || at[-1] == 'x' || at[-1] == '[' || *at == '.',
                          "%d columns: '%.*s' in\n%s", columns, (int)length, at, text);
            at += length > 0 ? length : 1;
        }
    }
}
END_TEST

START_TEST(progress_is_short_where_there_is_little_room)
{
    static const char waits[] = "the end of R: 551 of 5000 steps done";
    draw(state(json_pack("{s:s, s:s}", "command", "R", "waits_for", waits), NULL), 24, 57);
    assert_shown("R  551/5000\n");
    draw(state(json_pack("{s:s, s:s}", "command", "R", "waits_for", waits), NULL), 24, 56);
    assert_shown("  R\n");
    draw(state(json_pack("{s:s, s:s}", "command", "R", "waits_for", waits), NULL), 24, 80);
    assert_shown("R  551 of 5000 steps\n");
}
END_TEST

START_TEST(a_device_without_a_bus_has_no_row_for_it)
{
    json_t *shown = state(NULL, NULL);
    json_object_set_new(shown, "device", json_pack("{s:s, s:i, s:i, s:i, s:i, s:b}", "name", "alone", "axes", 1, "inputs", 3,
                                                   "outputs", 0, "variables", 0, "bus", 0));
    draw(shown, 24, 80);
    assert_shown("\n\n      01 02 03\n DI    ");
    ck_assert(strstr(text, "requests") == NULL && strstr(text, "on the line") == NULL && strstr(text, " DO") == NULL);
}
END_TEST

/* A CNC872 with so many axes, as `state` shows it; `more` replaces members of `cnc`. Takes the reference to `more`. */
static json_t *cnc_state(int count, json_t *more)
{
    json_t *axes = json_object();
    for (int i = 0; i < count; i++) {
        char name[8];
        snprintf(name, sizeof name, i < 3 ? "%c" : "%d", i < 3 ? 'X' + i : i + 1);
        json_object_set_new(axes, name, json_pack("{s:I, s:I, s:i, s:s, s:b, s:b}", "position", (json_int_t)-65536 * 1500 - 1,
                                                  "actual", (json_int_t)65536 * 200000, "difference", -7, "state",
                                                  i == 0 ? "block" : "idle", "homed", i == 1, "enabled", 1));
    }
    json_t *cnc = json_pack(
        "{s:{s:s, s:i, s:i, s:i, s:i}, s:o, s:{s:b, s:b}, s:{s:s, s:i, s:i, s:b, s:b}, s:{s:i, s:i, s:i, s:s}, s:i, s:i, s:i, "
        "s:i}", "block", "phase", "move", "block", 1, "line", 4, "next", 2, "blocks", 9, "axes", axes, "stops", "po_stop", 0,
        "sf_stop", 0, "panel", "mode", "aut", "feed", 120, "spindle", 95, "rapid", 1, "m01", 0, "spindle", "required", 500000,
        "actual", 479949, "gear", 2, "turns", "m3", "speed", 1092266, "critical", 0, "plc_error", 0, "plc_pass", 1);
    json_object_update(cnc, more);
    json_decref(more);
    return json_pack("{s:i, s:s, s:s, s:[], s:o, s:{s:s}}", "t_us", 99000, "unit", "1", "clock", "x1", "motors", "cnc", cnc,
                     "device", "name", "cnc872");
}

START_TEST(a_cnc_has_its_axes_and_what_its_block_and_its_program_do)
{
    draw(cnc_state(2, NULL), 24, 80);
    assert_shown(" cnc872 unit 1  0.099000 s  clock x1\n\n"
                 " axis  state               mm    actual mm  dif. um  homed  enabled\n"
                 " X     block           -1.501      200.000       -7     no      yes\n"
                 " Y     idle            -1.501      200.000       -7    yes      yes\n\n"
                 " block    move   block 1   line 4   next 2   of 9\n"
                 " feed     1000.0 mm/min   feed 120 %   aut   rapid\n"
                 " stops    -\n"
                 " PLC      pass init   error 0h\n"
                 " spindle  m3   479.9 of 500.0 rev/min   gear 2   spindle 95 %\n");
}
END_TEST

START_TEST(a_cnc_with_a_rotary_axis_shows_degrees)
{
    draw(json_pack("{s:{s:{s:{s:I, s:b}}}}", "cnc", "axes", "4", "position", (json_int_t)65536 * 90000, "rotary", 1), 24, 80);
    assert_shown(" axis  state        mm or deg");
    assert_shown(" 4     -               90.000");
}
END_TEST

START_TEST(stops_and_errors_of_a_cnc_are_named)
{
    draw(cnc_state(1, json_pack("{s:{s:b, s:b}, s:i, s:i, s:i}", "stops", "po_stop", 1, "limit", 1, "plc_error", 0x15, "critical",
                                12, "plc_pass", 9)), 24, 80);
    assert_shown(" stops    po_stop   limit\n PLC      pass ?   error 15h   critical error 12\n");
}
END_TEST

START_TEST(what_the_state_of_a_cnc_lacks_is_a_dash)
{
    draw(json_pack("{s:{s:{s:{}}}}", "cnc", "axes", "X"), 24, 80);
    assert_shown(" X     -                    -            -        -     no       no\n");
    assert_shown(" block    -   block -");
}
END_TEST

/* The style in which the first character of the text is shown. */
static int style_of(const char *part)
{
    const char *at = strstr(text, part);
    int row = 0;
    ck_assert_ptr_nonnull(at);
    for (const char *before = text; before < at; before++)
        row += *before == '\n';
    const char *line = at;
    while (line > text && line[-1] != '\n')
        line--;
    return panel.cell[row][at - line].style;
}

START_TEST(what_is_wrong_with_a_cnc_is_marked)
{
    draw(cnc_state(1, json_pack("{s:{s:b}, s:i, s:i, s:i}", "stops", "po_stop", 1, "plc_error", 1, "critical", 2, "plc_pass", 4)),
         24, 80);
    ck_assert_int_eq(style_of("po_stop"), PANEL_WRONG);
    ck_assert_int_eq(style_of("error 1h"), PANEL_WRONG);
    ck_assert_int_eq(style_of("critical error 2"), PANEL_WRONG);
    ck_assert_int_eq(style_of("pass done"), PANEL_PLAIN);
    draw(cnc_state(1, NULL), 24, 80);
    ck_assert_int_eq(style_of("error 0h"), PANEL_PLAIN);
}
END_TEST

/* Two axes with head, lines and keys are ten rows; gaps come all at once. */
START_TEST(a_cnc_has_gaps_where_there_is_room)
{
    static const struct {
        const char *keys;
        int rows, shown;
    } sizes[] = {{"q quit", 12, 10}, {"q quit", 13, 13}, {"q quit", 24, 13}, {NULL, 10, 9}, {NULL, 11, 11}};
    json_t *shown = cnc_state(2, NULL);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        struct panel_view view = {.state = shown, .keys = sizes[i].keys};
        client_panel_draw(&panel, &view, sizes[i].rows, 80);
        ck_assert_int_eq(panel.rows, sizes[i].shown);
        if (sizes[i].keys)
            ck_assert_int_eq((int)panel.cell[panel.rows - 1][1].character, 'q');
    }
    json_decref(shown);
}
END_TEST

/* {"displays": ...}: what the second one shows in its second line. */
static json_t *displays(const char *second)
{
    const char *blank = "                ";
    return json_pack("{s:[{s:[s, s, s]}, {s:[s, s, s]}]}", "displays", "lines", blank, blank, blank, "lines", blank, second,
                     blank);
}

START_TEST(displays_of_a_cnc_are_shown_if_something_is_written_on_them)
{
    draw(cnc_state(2, displays("  Abc \x1b          ")), 24, 80);
    assert_shown(" rev/min   gear 2   spindle 95 %\n\n display 1          display 2\n\n                      Abc ?\n");
    ck_assert_int_eq(panel.rows, 15);
    draw(cnc_state(2, displays("                ")), 24, 80);
    ck_assert(strstr(text, "display") == NULL);
    draw(cnc_state(2, displays("  Abc           ")), 14, 80); /* there is no room */
    ck_assert(strstr(text, "display") == NULL);
    assert_shown("spindle 95 %\n");
}
END_TEST

/* Block and stops are there before the fourth axis; what has no room is named. */
START_TEST(a_small_terminal_shows_what_a_cnc_does)
{
    draw(cnc_state(16, NULL), 10, 40);
    assert_shown("\n X     block");
    assert_shown("\n Z     idle");
    assert_shown("\n 13 more axes: not enough rows\n block    move");
    assert_shown("\n stops    -\n");
    draw(cnc_state(16, NULL), 23, 80);
    assert_shown("\n 16    idle");
    draw(cnc_state(16, NULL), 50, 200);
    assert_shown("x1\n\n axis"); /* with gaps */
}
END_TEST

/* Sixteen axes, head, lines and keys fill 24 rows; with less room axes stay longest, and no position is cut. */
START_TEST(a_cnc_fits_any_size)
{
    draw(cnc_state(16, NULL), 24, 80);
    assert_shown("\n 16    idle");
    assert_shown("\n spindle  m3");
    assert_shown("\n axis  state");
    for (int rows = 0; rows <= 30; rows++) {
        for (int columns = 0; columns <= 130; columns++) {
            draw(cnc_state(3, NULL), rows, columns);
            ck_assert_int_le(panel.rows, rows);
            ck_assert_int_le(panel.columns, columns);
            if (rows >= 4 && columns >= 18)
                assert_shown("-1.501");
            const char *cut = strstr(text, "-1.50");
            ck_assert_msg(!cut || cut[5] == '1', "%d columns:\n%s", columns, text);
        }
    }
}
END_TEST

static Suite *client_panel_suite(void)
{
    Suite *suite = suite_create("client_panel");
    TCase *values = tcase_create("values"), *sizes = tcase_create("sizes");
    tcase_add_test(values, what_a_motor_does_is_in_its_row);
    tcase_add_test(values, lamps_are_under_their_numbers);
    tcase_add_test(values, true_positions_are_shown_where_there_is_a_plant);
    tcase_add_test(values, a_fault_is_named_and_a_unit_without_power_is_called_so);
    tcase_add_test(values, what_the_state_lacks_is_a_dash);
    tcase_add_test(values, control_characters_and_others_do_not_reach_the_terminal);
    tcase_add_test(values, a_device_without_a_bus_has_no_row_for_it);
    tcase_add_test(values, a_cnc_has_its_axes_and_what_its_block_and_its_program_do);
    tcase_add_test(values, a_cnc_with_a_rotary_axis_shows_degrees);
    tcase_add_test(values, stops_and_errors_of_a_cnc_are_named);
    tcase_add_test(values, what_the_state_of_a_cnc_lacks_is_a_dash);
    tcase_add_test(values, what_is_wrong_with_a_cnc_is_marked);
    tcase_add_test(sizes, a_cnc_has_gaps_where_there_is_room);
    tcase_add_test(sizes, displays_of_a_cnc_are_shown_if_something_is_written_on_them);
    tcase_add_test(sizes, a_small_terminal_shows_what_a_cnc_does);
    tcase_add_test(sizes, a_cnc_fits_any_size);
    tcase_add_test(sizes, at_every_size_nothing_is_wider_or_higher_and_positions_stay_longest);
    tcase_add_test(sizes, no_number_is_cut_at_any_width);
    tcase_add_test(sizes, progress_is_short_where_there_is_little_room);
    tcase_set_timeout(sizes, 60);
    suite_add_tcase(suite, values);
    suite_add_tcase(suite, sizes);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(client_panel_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* SPDX-License-Identifier: MIT */
/* A motion of a CNC872 along its path, and ways of blocks, by themselves (NM1 to NM8 of docs/CNC872.md). */
#include <stdio.h>
#include <string.h>

#include "cnc_rig.h"

static struct cnc_path path;
static int64_t ring[CNC_AVERAGE_MAX];
static uint64_t seed;

static unsigned any(unsigned count)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)(seed >> 33) % count;
}

START_TEST(an_endless_motion)
{
    cnc_path_begin(&path, NULL, CNC_ENDLESS, 100, 1);
    for (unsigned i = 1; i <= 10; i++)
        ck_assert_int_eq(cnc_path_step(&path, NULL, 950, 0, NULL), i < 10 ? 100 * i : 950);
    for (unsigned i = 0; i < 1000; i++)
        ck_assert_int_eq(cnc_path_step(&path, NULL, 950, 0, NULL), 950);
    ck_assert_int_eq(path.left, CNC_ENDLESS);
    ck_assert_int_eq(path.done, 0); /* nothing that could overflow is counted */
    ck_assert_int_eq(cnc_path_step(&path, NULL, 0, 300, NULL), 650);
    ck_assert_int_eq(cnc_path_step(&path, NULL, 0, 0, NULL), 550);
    cnc_path_halt(&path, NULL);
    ck_assert(cnc_path_is_at_rest(&path));
    ck_assert_int_eq(path.left, CNC_ENDLESS);
}
END_TEST

START_TEST(the_fastest_motion_there_is)
{
    cnc_path_begin(&path, NULL, CNC_ENDLESS, CNC_SPEED_LIMIT, 1);
    ck_assert_int_eq(cnc_path_step(&path, NULL, CNC_SPEED_LIMIT, 0, NULL), CNC_SPEED_LIMIT);
    cnc_path_begin(&path, NULL, INT64_C(1) << 47, 1, 1); /* the ramp down from the limit would take 2^79 u */
    path.u = path.v = CNC_SPEED_LIMIT;
    ck_assert_int_eq(cnc_path_step(&path, NULL, CNC_SPEED_LIMIT, 0, NULL), CNC_SPEED_LIMIT - 1);
}
END_TEST

START_TEST(the_way_ends_before_the_ramp_does)
{
    /* A set with a small acceleration takes over on the final ramp of a steep one: linear ramps keep their own. */
    cnc_path_begin(&path, NULL, 1000, 100, 1);
    for (unsigned i = 0; i < 3; i++)
        cnc_path_step(&path, NULL, 1000, 0, NULL);
    path.acceleration = 1;
    int64_t way = path.done;
    while (cnc_path_rest(&path) > 0)
        way += cnc_path_step(&path, NULL, 1000, 0, NULL);
    ck_assert_int_eq(way, 1000);
    ck_assert_int_eq(path.left, 0);
}
END_TEST

/* NM4: a new n alone is another set, too. */
START_TEST(a_change_of_n_alone)
{
    cnc_path_begin(&path, ring, 1000000, 100, 10);
    for (unsigned i = 0; i < 5; i++)
        cnc_path_step(&path, ring, 1000, 0, NULL);
    const int64_t v = path.v;
    ck_assert(cnc_path_change(&path, ring, 100, 4));
    ck_assert_uint_eq(path.n, 4);
    ck_assert_int_eq(path.u, v);
    ck_assert_int_eq(path.sum, 4 * v);
    ck_assert_int_eq(path.left, cnc_path_rest(&path) - (v * 3 + 1) / 2);
}
END_TEST

START_TEST(a_change_keeps_speed_and_way)
{
    for (unsigned n = 2; n < 60; n++) {
        cnc_path_begin(&path, ring, 1000003, 10, n);
        for (unsigned i = 0; i < 50 + n; i++)
            cnc_path_step(&path, ring, 301, 0, NULL);
        const int64_t v = path.v;
        ck_assert(cnc_path_change(&path, ring, 7, n + 1));
        ck_assert_int_eq(path.v, v);
        ck_assert(cnc_path_change(&path, ring, 20, n));
        ck_assert(cnc_path_change(&path, ring, 20, n)); /* nothing changes */
        while (cnc_path_rest(&path) > 0)
            ck_assert_int_ge(cnc_path_step(&path, ring, 301, 0, NULL), 0);
        ck_assert_int_eq(path.done, 1000003);
    }
}
END_TEST

START_TEST(a_change_that_is_refused)
{
    cnc_path_begin(&path, ring, 5000, 100, 2);
    while (path.v < 600)
        cnc_path_step(&path, ring, 700, 0, NULL);
    const struct cnc_path before = path;
    ck_assert(!cnc_path_change(&path, ring, 1, 10));
    ck_assert_int_eq(memcmp(&path, &before, sizeof path), 0);
}
END_TEST

/* Random borders on a path of `length`. */
static void make_borders(struct cnc_borders *borders, int64_t length)
{
    int64_t border = 0;
    memset(borders, 0, sizeof *borders);
    borders->count = any(CNC_BORDERS_MAX + 1);
    for (unsigned i = 0; i < borders->count; i++) {
        border += 1 + any((unsigned)(length / (borders->count + 1)));
        borders->border[i] = (struct cnc_border){border, 50 + any(2000)};
    }
}

/* The segment of a place, by counting the borders before it; its end. */
static int64_t end_of(const struct cnc_borders *borders, int64_t length, int64_t place)
{
    for (unsigned i = 0; i < borders->count; i++)
        if (place < borders->border[i].at)
            return borders->border[i].at;
    return length;
}

START_TEST(gliding_is_stepping)
{
    static int64_t other_ring[CNC_AVERAGE_MAX];
    int64_t glided = 0;
    seed = 7;
    for (unsigned k = 0; k < 300; k++) {
        struct cnc_borders borders;
        const int64_t length = 10000 + any(1000000);
        make_borders(&borders, length);
        cnc_path_begin(&path, ring, length, 1 + any(50), any(2) ? 1 : 2 + any(60));
        int64_t target = 100 + any(3000);
        while (cnc_path_rest(&path) > 0) {
            if (any(100) == 0)
                target = 100 + any(3000);
            struct cnc_path other = path;
            memcpy(other_ring, ring, sizeof ring);
            const int64_t input = end_of(&borders, length, length - path.left);
            int64_t count = cnc_path_glide(&other, other_ring, target, &borders, input, end_of(&borders, length, path.done),
                                           1 + any(500));
            glided += count;
            if (count == 0) {
                cnc_path_step(&path, ring, target, 0, &borders);
                continue;
            }
            for (; count > 0; count--)
                if (cnc_path_step(&path, ring, target, 0, &borders) != target)
                    ck_abort_msg("motion %u does not glide at %d", k, (int)path.done);
            ck_assert_int_eq(other.left, path.left);
            ck_assert_int_eq(other.done, path.done);
        }
        ck_assert_int_eq(path.done, length);
    }
    ck_assert_int_gt(glided, 10000);
}
END_TEST

START_TEST(limits_along_a_path)
{
    ck_assert_int_eq(cnc_scale(100, 500, 300), 166);
    ck_assert_int_eq(cnc_scale(100, 500, -300), 166);
    ck_assert_int_eq(cnc_scale(1000000000, INT64_C(100000000000000), 1), CNC_SPEED_LIMIT);
    ck_assert_int_eq(cnc_scale(1092266666, 1000000, 1), CNC_SPEED_LIMIT);
    ck_assert_int_eq(cnc_scale(CNC_SPEED_LIMIT - 1, 1, 1), CNC_SPEED_LIMIT - 1);
    ck_assert_int_eq(cnc_scale(CNC_SPEED_LIMIT + 1, 1, 1), CNC_SPEED_LIMIT);
}
END_TEST

START_TEST(a_way_of_all_axes)
{
    char xml[2000] = "<ChannelConfig>", nc[1000] = "G0 X-200000 Y-200000 Z200000";
    strcat(xml, "<Axis Name=\"X\"/><Axis Name=\"Y\"/><Axis Name=\"Z\"/>");
    for (unsigned i = 4; i <= 16; i++) {
        char piece[40];
        snprintf(piece, sizeof piece, "<Axis Name=\"%u\"/>", i);
        strcat(xml, piece);
        snprintf(piece, sizeof piece, " A%u=%s200000", i, i % 2 ? "-" : "");
        strcat(nc, piece);
    }
    rig_begin_with(strcat(xml, "</ChannelConfig>"), strcat(nc, "\nG0 X200000 Y200000 Z-200000"));
    run_to(20000);
    ck_assert_int_eq(cnc.move.section.length, 4 * 200000 * MM);
    ck_assert_int_eq(cnc.move.section.segment[0].rapid, 4 * 13107200);
    for (unsigned i = 0; i < CNC_AXES; i++)
        ck_assert_int_eq(cnc.axis[i].position < 0 ? -cnc.axis[i].position : cnc.axis[i].position, cnc.move.path.done / 4);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_BlockLen, 0), 45404672689933.0 / 65536000.0);
}
END_TEST

START_TEST(a_change_of_acceleration_by_request)
{
    struct cnc_section section;
    static const int64_t zero[CNC_AXES];
    rig_power("<ChannelConfig AccelerationType=\"1\"/>", "G1 X10 F1000");
    static const struct {
        int64_t acceleration;
        double change;
        unsigned n;
        int64_t expected;
    } row[] = {{0, 0, 50, 32768}, {0, 655.36 * 2, 25, 32768}, {32768, 65536.0, 1, 32768}, {32768, 30000.0, 1, 32768},
               {100, 0.001, 1000, 100}, {INT64_C(1) << 50, 0, 1000, CNC_SPEED_LIMIT}, {0, 13107.2, 3, 32768},
               {-5, -1.0, 50, 32768}};
    for (unsigned i = 0; i < sizeof row / sizeof *row; i++) {
        cnc_section_build(&section, &config, &program, 0, zero, false);
        cnc_section_request(&section, &config, row[i].acceleration, row[i].change);
        ck_assert_uint_eq(section.n[CNC_SET_NORMAL], row[i].n);
        ck_assert_int_eq(section.acceleration[CNC_SET_NORMAL], row[i].expected);
        ck_assert_int_eq(section.acceleration[CNC_SET_RAPID], 65536);
        ck_assert_uint_eq(section.n[CNC_SET_RAPID], 50);
    }
}
END_TEST

static Suite *path_suite(void)
{
    Suite *suite = suite_create("cnc_path");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 60);
    tcase_add_test(all, an_endless_motion);
    tcase_add_test(all, the_fastest_motion_there_is);
    tcase_add_test(all, the_way_ends_before_the_ramp_does);
    tcase_add_test(all, a_change_of_n_alone);
    tcase_add_test(all, a_change_keeps_speed_and_way);
    tcase_add_test(all, a_change_that_is_refused);
    tcase_add_test(all, gliding_is_stepping);
    tcase_add_test(all, limits_along_a_path);
    tcase_add_test(all, a_way_of_all_axes);
    tcase_add_test(all, a_change_of_acceleration_by_request);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(path_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}

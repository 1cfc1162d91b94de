/* SPDX-License-Identifier: MIT */
/* 5000 random motions with overrides, holds, stops and restarts: they end exactly on their target, never pass it, and exceed no
 * limit of speed, acceleration or change of acceleration (NM1 to NM10 of docs/CNC872.md). */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cnc_rig.h"

#define MOTIONS 5000u
#define TURNS_MAX 60000u /* of a motion */

/* Check writes to a file for each of its assertions: there are millions of these. */
#define EXPECT(condition)                                                               \
    do {                                                                                \
        if (!(condition))                                                               \
            ck_abort_msg("T %" PRIu64 ": not " #condition, cnc.turn);                   \
    } while (0)

static uint64_t seed;

static unsigned any(unsigned count)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)(seed >> 33) % count;
}

static int64_t magnitude(int64_t value)
{
    return value < 0 ? -value : value;
}

/* A machine of three axes, with its limits as attributes. */
static void write_config(char *xml, size_t size)
{
    static const char *const names[] = {"X", "Y", "Z"};
    size_t length = (size_t)snprintf(xml, size, "<ChannelConfig AccelerationType=\"%u\">", any(2));
    for (unsigned i = 0; i < 3; i++) {
        const unsigned a = 200 + any(9800), p = 5 + any(95);
        length += (size_t)snprintf(xml + length, size - length,
                                   "<Axis Name=\"%s\" FeedRT=\"%u\" FeedSlow=\"%u\" Acceleration=\"%u\" "
                                   "AccelerationRT=\"%u\" AccelerationEmergency=\"%u\" LinearAccel=\"%u\" "
                                   "LinearAccelRT=\"%u\" LinearAccelEmergency=\"%u\" ParabAccel=\"%u\" "
                                   "ParabAccelRT=\"%u\" ParabAccelEmergency=\"%u\"/>",
                                   names[i], 500 + any(15000), 300 + any(1500), a, 100 + any(9900), 2 * a, a, 2 * a, 3 * a, p,
                                   2 * p,
                                   3 * p);
    }
    snprintf(xml + length, size - length, "</ChannelConfig>");
}

static int write_mm(char *text, size_t size, char name)
{
    return snprintf(text, size, " %c%s%u.%04u", name, any(2) ? "-" : "", any(2), any(10000));
}

static void write_program(char *nc, size_t size)
{
    const bool rapid = any(3) == 0, section = !rapid && any(3) == 0;
    size_t length = (size_t)snprintf(nc, size, "%sG%u", section ? "G23 " : "", rapid ? 0 : 1);
    const unsigned blocks = section ? 2 + any(4) : 1;
    double x = 0, y = 0;
    for (unsigned k = 0; k < blocks; k++) {
        if (section) { /* roughly straight on */
            x += 0.1 + any(500) / 1000.0;
            y += any(100) / 1000.0;
            length += (size_t)snprintf(nc + length, size - length, " X%.4f Y%.4f F%u\n", x, y, 1000 + any(10000));
            continue;
        }
        for (unsigned i = 0; i < 3; i++)
            if (i == 0 || any(2))
                length += (size_t)write_mm(nc + length, size - length, (char)('X' + i));
        length += (size_t)snprintf(nc + length, size - length, " F%u", 1000 + any(10000));
    }
}

/* Something from outside, sometimes. */
static void disturb(void)
{
    switch (any(80)) {
    case 0:
        cnc.panel.feed = (uint16_t)any(201);
        break;
    case 1:
        set_cell("FEED_OVR_MULTIPLIER", 0, any(1500));
        break;
    case 2:
        cnc_put_bit(&cnc.cells, CNC_BIT_MPxPI, any(2));
        break;
    case 3:
        set_bit("KHY1", any(2));
        break;
    case 4:
        cnc_stop(&cnc);
        break;
    case 5:
        set_bit("STOP_EMERGENCY_REQ", true);
        break;
    case 6:
        set_bit("ZPX0", any(2));
        break;
    case 7:
        set_cell("LIMIT_FEED", 0, any(2000000));
        set_bit("LIMIT_FEED_REQ", any(2));
        break;
    default:
        break;
    }
}

/* All back to what lets a motion go on. */
static void let_go(void)
{
    cnc.panel.feed = 100;
    set_cell("FEED_OVR_MULTIPLIER", 0, 1000);
    set_bit("MPXPI", true);
    set_bit("KHY1", false);
    set_bit("ZPX0", false);
    set_bit("LIMIT_FEED_REQ", false);
}

/* What the path did in the last T's. */
struct past {
    int64_t v, change, place[3];
    bool has_change; /* of the acceleration */
    int64_t acceleration;
    uint16_t n;
};

/* The steepest set of the path. */
static int64_t steepest(void)
{
    const int64_t *a = cnc.move.section.acceleration;
    int64_t most = a[0] > a[1] ? a[0] : a[1];
    return a[2] > most ? a[2] : most;
}

static void check_turn(struct past *past)
{
    const struct cnc_path *path = &cnc.move.path;
    const int64_t v = cnc.move.v, change = v - past->v;
    const bool is_enabled = cnc_bit(&cnc.cells, CNC_BIT_MPxPI);
    const bool is_halted = cnc_number(&cnc.cells, CNC_CELL_BZH13, 0) != 0 || (config.is_parabolic && !is_enabled);
    const bool at_end = path->done == path->length || cnc.move.section.count == 0;
    EXPECT(v >= 0);
    if (cnc.move.section.count > 0) {
        EXPECT(path->done <= path->length);
        EXPECT(path->left >= 0);
    }
    if (!is_halted && !at_end && cnc.move.is_going && cnc.move.section.count > 0) {
        EXPECT(magnitude(change) <= steepest() + 1);
        const bool same_set = path->acceleration == past->acceleration && path->n == past->n && past->has_change;
        if (config.is_parabolic && same_set && path->n > 1)
            EXPECT(magnitude(change - past->change) <= 2 * path->acceleration / path->n + 4);
    }
    for (unsigned i = 0; i < 3; i++) {
        const int64_t way = cnc.axis[i].position - past->place[i];
        EXPECT(magnitude(way) <= cnc_speed_of(config.axis[i].feed_rapid) + 1);
        past->place[i] = cnc.axis[i].position;
    }
    past->has_change = !is_halted && cnc.move.is_going;
    past->acceleration = path->acceleration;
    past->n = path->n;
    past->change = change;
    past->v = v;
}

/* The positions lie between where the motion began and its target. */
static void check_bounds(const int64_t target[3])
{
    for (unsigned i = 0; i < 3; i++) {
        const int64_t low = target[i] < 0 ? target[i] : 0, high = target[i] < 0 ? 0 : target[i];
        EXPECT(cnc.axis[i].position >= low);
        EXPECT(cnc.axis[i].position <= high);
    }
}

static void find_target(int64_t target[3])
{
    memset(target, 0, 3 * sizeof *target);
    for (uint32_t k = 0; k < program.block_count; k++)
        for (unsigned i = 0; i < 3; i++)
            cnc_nc_target(&program, &program.blocks[k], i, &target[i]);
}

static void run_motion(void)
{
    char xml[2000], nc[1000];
    int64_t target[3];
    struct past past = {.v = 0};
    write_config(xml, sizeof xml);
    write_program(nc, sizeof nc);
    rig_begin_with(xml, nc);
    find_target(target);
    const unsigned calm = 20 + any(300);
    run_to(1);
    while (cnc_bit(&cnc.cells, CNC_BIT_PO_F)) {
        if (cnc.turn >= TURNS_MAX)
            ck_abort_msg("no end: %s %s", xml, nc);
        if (cnc.turn < calm)
            disturb();
        else if (cnc.turn == calm)
            let_go();
        if (cnc_bit(&cnc.cells, CNC_BIT_PO_STOP) && (cnc.turn >= calm || any(50) == 0))
            ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
        run_to(cnc.turn + 1);
        check_turn(&past);
        check_bounds(target);
    }
    for (unsigned i = 0; i < 3; i++)
        ck_assert_msg(cnc.axis[i].position == target[i], "axis %u at %" PRId64 ", not at %" PRId64 ": %s %s", i,
                      cnc.axis[i].position, target[i], xml, nc);
    ck_assert(bit("SF_STOP") && !bit("PO_STOP") && !bit("PO_OSXPI"));
}

START_TEST(random_motions)
{
    seed = (uint64_t)_i + 1;
    for (unsigned i = 0; i < MOTIONS / 10; i++)
        run_motion();
}
END_TEST

/* Without disturbances the acceleration changes by p each T at most, and reaches a at most. */
START_TEST(calm_parabolic_motions)
{
    seed = 99;
    for (unsigned k = 0; k < 200; k++) {
        char xml[2000], nc[1000];
        write_config(xml, sizeof xml);
        write_program(nc, sizeof nc);
        rig_begin_with(xml, nc);
        if (!config.is_parabolic || program.block_count > 1)
            continue;
        int64_t v = 0, change = 0;
        run_to(1);
        const int64_t a = cnc.move.section.acceleration[program.blocks[0].motion == CNC_MOTION_RAPID];
        const int64_t n = cnc.move.section.n[program.blocks[0].motion == CNC_MOTION_RAPID];
        while (cnc_bit(&cnc.cells, CNC_BIT_PO_OSxPI)) {
            run_to(cnc.turn + 1);
            if (cnc.move.path.done < cnc.move.path.length)
                EXPECT(magnitude(cnc.move.v - v - change) <= 2 * a / n + 3);
            EXPECT(cnc.move.v - v <= a + 1);
            change = cnc.move.v - v;
            v = cnc.move.v;
        }
    }
}
END_TEST

static Suite *random_suite(void)
{
    Suite *suite = suite_create("cnc_random");
    TCase *motions = tcase_create("motions");
    tcase_set_timeout(motions, 200);
    tcase_add_loop_test(motions, random_motions, 0, 10);
    tcase_add_test(motions, calm_parabolic_motions);
    suite_add_tcase(suite, motions);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(random_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}

/* SPDX-License-Identifier: MIT */
/* AT1, AT2: however time is cut, the same comes out; nothing happens between two events; copies are snapshots. Random stories
 * (tests/digest/pmc_story.c). RKM04_TEST_SEED, RKM04_TEST_SCALE: others, more. */
#include <stdlib.h>
#include <string.h>

#include "pmc/pmc.h"

#include <check.h>

#include "digest/pmc_story.h"

#define STORIES 60u

static double setting(const char *name)
{
    const char *text = getenv(name);
    return text ? strtod(text, NULL) : 1;
}

START_TEST(AT1_however_time_is_cut_the_same_comes_out)
{
    const unsigned stories = 1 + (unsigned)(STORIES * setting("RKM04_TEST_SCALE"));
    uint64_t reports = 0;
    for (unsigned i = 0; i < stories; i++) {
        const unsigned number = (unsigned)setting("RKM04_TEST_SEED") * 1000 + i;
        struct pmc_digest first, other;
        pmc_story(number, PMC_WAY_AT_ONCE, &first);
        reports += first.reports;
        for (enum pmc_way way = PMC_WAY_IN_PIECES; way < PMC_WAYS; way++) {
            pmc_story(number, way, &other);
            const bool seen = way != PMC_WAY_UNSEEN;
            if (first.end != other.end || first.flash != other.flash || first.outputs != other.outputs || other.early != 0 ||
                (seen && (memcmp(first.axis, other.axis, sizeof first.axis) != 0 || first.pulses != other.pulses)))
                ck_abort_msg("story %u is another one in way %d, or has %u early reports", number, (int)way,
                             (unsigned)other.early);
        }
    }
    ck_assert_uint_gt(reports, stories * UINT64_C(100));
}
END_TEST

#define SLOT ((uint64_t)PMC_SLOT_TICKS)

static struct pmc_unit unit;

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)axis, (void)tick, (void)count, (void)position, (void)forward;
}

static const struct pmc_port loud = {.steps = on_steps}, quiet = {.steps = NULL};

START_TEST(AT2_nothing_is_due_in_a_unit_at_rest)
{
    const struct pmc_config config = {.axes = 1};
    pmc_init(&unit, &config, &loud, NULL);
    ck_assert_uint_eq(pmc_next_event(&unit), SLOT); /* the first slot looks at the inputs */
    pmc_advance(&unit, SLOT + 1);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    ck_assert_uint_eq(pmc_next_report(&unit), PMC_NEVER);
    pmc_set_inputs(&unit, 0);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    pmc_set_inputs(&unit, PMC_IN0);
    ck_assert_uint_eq(pmc_next_event(&unit), 2 * SLOT);
    pmc_advance(&unit, PMC_NEVER);
    ck_assert_uint_eq(pmc_now(&unit), PMC_NEVER);
}
END_TEST

START_TEST(AT2_a_day_of_unseen_pulses_costs_little)
{
    const struct pmc_config config = {.axes = 1};
    const struct pmc_request speed = {.kind = PMC_SET_SPEED, .axes = 1, .value = {8000}};
    const struct pmc_request jog = {.kind = PMC_JOG, .axes = 1, .value = {1}};
    pmc_init(&unit, &config, &quiet, NULL);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_FLAGS, 0x0103), PMC_OK);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_MULTIPLIER, 500), PMC_OK);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_START_SPEED, 8000), PMC_OK);
    ck_assert_int_eq(pmc_request(&unit, &speed), PMC_OK);
    ck_assert_int_eq(pmc_request(&unit, &jog), PMC_OK);
    pmc_advance(&unit, SLOT + UINT64_C(86400) * PMC_TICKS_PER_SECOND + 1); /* 345 600 000 000 pulses */
    const uint32_t made = (uint32_t)UINT64_C(345600000000);
    ck_assert_uint_eq(unit.axis[0].motion.made, made);
    ck_assert_int_eq(unit.axis[0].commanded, (int32_t)((made & 0xFFFFFF) ^ 0x800000) - 0x800000);
}
END_TEST

START_TEST(AT2_unseen_pulses_are_no_reports)
{
    const struct pmc_config config = {.axes = 2};
    pmc_init(&unit, &config, &quiet, NULL);
    const struct pmc_request speed = {.kind = PMC_SET_SPEED, .axes = 3, .value = {8000, 8000}};
    const struct pmc_request move = {.kind = PMC_MOVE_BY, .axes = 3, .value = {8000000, 100}};
    ck_assert_int_eq(pmc_request(&unit, &speed), PMC_OK);
    ck_assert_int_eq(pmc_request(&unit, &move), PMC_OK);
    pmc_advance(&unit, SLOT + 1);
    unsigned looks = 0;
    for (; unit.axis[0].motion.active; looks++) {
        const uint64_t next = pmc_next_report(&unit);
        ck_assert_uint_ne(next, PMC_NEVER);
        pmc_advance(&unit, next - pmc_now(&unit) + 1);
        ck_assert_uint_lt(looks, 200);
    }
    ck_assert_int_eq(unit.axis[0].commanded, 8000000);
    ck_assert_int_eq(unit.axis[1].commanded, 100);
    ck_assert_int_eq(pmc_set_parameter(&unit, 1, PMC_FLAGS, 0x0103), PMC_OK);
    const struct pmc_request jog = {.kind = PMC_JOG, .axes = 2, .value = {0, 1}};
    ck_assert_int_eq(pmc_request(&unit, &jog), PMC_OK);
    for (looks = 0; pmc_next_report(&unit) != PMC_NEVER; looks++) {
        pmc_advance(&unit, pmc_next_report(&unit) - pmc_now(&unit) + 1);
        ck_assert_uint_lt(looks, 10);
    }
    ck_assert_uint_ne(pmc_next_event(&unit), PMC_NEVER);
}
END_TEST

static Suite *time_suite(void)
{
    Suite *suite = suite_create("pmc_time");
    TCase *all = tcase_create("time");
    tcase_set_timeout(all, 200);
    tcase_add_test(all, AT1_however_time_is_cut_the_same_comes_out);
    tcase_add_test(all, AT2_nothing_is_due_in_a_unit_at_rest);
    tcase_add_test(all, AT2_a_day_of_unseen_pulses_costs_little);
    tcase_add_test(all, AT2_unseen_pulses_are_no_reports);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(time_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}

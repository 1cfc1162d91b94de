/* SPDX-License-Identifier: MIT */
/* test_power.c: the power goes at every operation of every kind of store (U5, P6). Prints how many cuts were made.
 * RKM04_TEST_LONG=1 makes more of them. One case alone: CK_RUN_CASE=CASE ./test_power */
#include <stdio.h>
#include <stdlib.h>

#include "power_rig.h"

/* So many at the least, if no case was chosen. */
#define CUTS_SHORT 10000ul
#define CUTS_LONG 1000000ul

static const enum flash_fault cut_kinds[] = {
    FLASH_CUT_BEFORE, FLASH_CUT_PREFIX, FLASH_CUT_SUFFIX, FLASH_CUT_BITS,
    FLASH_CUT_GARBAGE, FLASH_CUT_ZEROS, FLASH_CUT_FLIPS, FLASH_CUT_AFTER,
};
#define CUT_KINDS (sizeof cut_kinds / sizeof cut_kinds[0])

/* Does what the cut leaves depend on the seed? */
static bool by_chance(enum flash_fault fault)
{
    return fault != FLASH_CUT_BEFORE && fault != FLASH_CUT_AFTER;
}

/* Cut at every operation in every way, and at every read (or every so-many-th). */
static void cut_everywhere(const struct sequence *sequence, uint32_t seeds, unsigned read_step)
{
    unsigned operations, reads;
    power_prepare(sequence);
    power_uncut(&operations, &reads);
    for (unsigned n = 1; n <= operations; n++)
        for (size_t kind = 0; kind < CUT_KINDS; kind++)
            for (uint32_t seed = 0; seed < (by_chance(cut_kinds[kind]) ? seeds : 1); seed++)
                power_cut(&(struct cut){.fault = cut_kinds[kind], .operation = n, .seed = seed});
    for (unsigned n = 1; n <= reads; n += read_step)
        power_cut(&(struct cut){.read = n});
}

/* ---- Sound flash ---- */

static const struct sequence sound[] = {
    {"the first store", NOTHING, SHORT, .motor = 2},
    {"the first store of one command", NOTHING, ONE, .motor = 1},
    {"the first store of nothing", NOTHING, EMPTY, .motor = 4},
    {"the first store of all motors", NOTHING, SHORT, .motor = 0},
    {"the second store", ONE, SHORT, .motor = 3, .times = 1},
    {"the third store", SHORT, ONE, .motor = 1, .times = 2},
    {"the fourth store", SHORT, SHORT, .motor = 4, .times = 3},
    {"an emptied slot", SHORT, EMPTY, .motor = 2, .times = 2},
    {"a store to an emptied slot", EMPTY, SHORT, .motor = 2, .times = 1},
    {"all motors, second store", ONE, SHORT, .motor = 0, .times = 1},
    {"all motors, third store", SHORT, ONE, .motor = 0, .times = 2},
    {"all motors emptied", SHORT, EMPTY, .motor = 0, .times = 1},
    {"over what was never ours", NOTHING, SHORT, .motor = 1, .garbage = true},
    {"all motors over what was never ours", NOTHING, ONE, .motor = 0, .garbage = true},
    {"generation 0", SHORT, ONE, .motor = 3, .times = 1, .last_generation = true},
    {"generation 0, the other block", ONE, SHORT, .motor = 3, .times = 2, .last_generation = true},
};
#define SOUND (sizeof sound / sizeof sound[0])

static const struct sequence full[] = {
    {"the first store of a full memory", NOTHING, FULL, .motor = 1},
    {"a full memory over a full one", FULL, WRAPPED, .motor = 2, .times = 1},
    {"a full memory over a full one, the other block", WRAPPED, FULL, .motor = 3, .times = 2},
    {"a short program over a full one", FULL, SHORT, .motor = 4, .times = 2},
    {"a full memory over a short one", SHORT, FULL, .motor = 1, .times = 2},
    {"four full memories over four", FULL, WRAPPED, .motor = 0, .times = 1},
};
#define FULLS (sizeof full / sizeof full[0])

START_TEST(P6_a_power_cut_at_any_operation_of_a_store_leaves_the_old_or_the_new_program)
{
    cut_everywhere(&sound[_i], power_long() ? 600 : 4, 1);
}
END_TEST

START_TEST(P6_a_power_cut_in_the_store_of_a_full_memory_leaves_the_old_or_the_new_program)
{
    const struct sequence *sequence = &full[_i];
    if (power_long()) {
        cut_everywhere(sequence, sequence->motor == 0 ? 3 : 20, 7);
        return;
    }
    /* At every eighth operation, and at those at the end, in one way after the other. */
    unsigned operations, reads;
    power_prepare(sequence);
    power_uncut(&operations, &reads);
    for (unsigned n = 1; n <= operations; n += n + 10 < operations ? 8 : 1)
        power_cut(&(struct cut){.fault = cut_kinds[n % CUT_KINDS], .operation = n, .seed = n});
}
END_TEST

/* Tear every operation at every byte; the short form tears an erase near its ends and at some places between. */
static void tear_at_every_byte(enum flash_fault fault, unsigned operation)
{
    unsigned border = 1, length;
    do {
        length = power_cut(&(struct cut){.fault = fault, .operation = operation, .border = border});
        border += border < 100 || border + 20 > length || power_long() ? 1 : 93;
    } while (border < length);
}

START_TEST(P6_it_does_not_matter_at_which_byte_an_operation_was_torn)
{
    static const enum flash_fault kinds[] = {FLASH_CUT_PREFIX, FLASH_CUT_SUFFIX, FLASH_CUT_ZEROS};
    unsigned operations, reads;
    power_prepare(&sound[_i]);
    power_uncut(&operations, &reads);
    for (unsigned n = 1; n <= operations; n++)
        for (size_t kind = 0; kind < 3; kind++)
            tear_at_every_byte(kinds[kind], n);
}
END_TEST

/* ---- Flash with faults ---- */

START_TEST(P6_a_power_cut_beside_a_worn_block_leaves_the_old_or_the_new_program)
{
    static const enum contents contents[] = {EMPTY, ONE, SHORT};
    bool all = _i % 2 != 0, brief = all && !power_long(); /* a third of it */
    for (size_t new = brief ? 2 : 0; new < 3; new++) {
        for (unsigned times = brief ? 1 : 0; times < 3; times++) {
            struct sequence sequence = {
                "tries on a worn block", times > 0 ? ONE : NOTHING, contents[new], .motor = all ? 0 : 2, .times = times,
                .stores = brief ? 1 : 3, .wear = (enum flash_wear)(1 + _i / 2),
            };
            cut_everywhere(&sequence, power_long() ? 20 : 1, power_long() ? 1 : 11);
        }
    }
}
END_TEST

START_TEST(P6_a_power_cut_after_an_erase_that_failed_leaves_the_old_or_the_new_program)
{
    static const enum flash_fault failed[] = {FLASH_FAIL_NOTHING, FLASH_FAIL_TORN, FLASH_FAIL_DONE, FLASH_LIE};
    for (unsigned times = 0; times < 4; times++) {
        struct sequence sequence = {
            "two tries, the first erase fails", times > 0 ? SHORT : NOTHING, times > 1 ? ONE : SHORT,
            .motor = times == 3 ? 0 : times + 1, .times = times, .stores = 2, .first = failed[_i],
        };
        cut_everywhere(&sequence, power_long() ? 100 : 2, power_long() ? 1 : 3);
    }
}
END_TEST

/* ---- Cuts one after the other ---- */

START_TEST(P6_a_second_power_cut_in_the_store_after_the_first_leaves_the_old_or_the_new_program)
{
    static const struct sequence chosen[] = {
        {"the store after a cut first store", NOTHING, SHORT, .motor = 2},
        {"the store after a cut store", SHORT, SHORT, .motor = 3, .times = 1},
        {"the store of all motors after a cut one", ONE, ONE, .motor = 0, .times = 2},
    };
    const struct sequence *sequence = &chosen[_i];
    unsigned operations, reads;
    power_prepare(sequence);
    power_uncut(&operations, &reads);
    uint32_t seeds = power_long() ? 6 : 1;
    for (unsigned first = 1; first <= operations; first++) {
        for (uint32_t at = 0; at < CUT_KINDS * seeds; at++) {
            power_prepare(sequence);
            power_cut_and_stay(&(struct cut){.fault = cut_kinds[at % CUT_KINDS], .operation = first, .seed = at});
            for (unsigned second = 1; second <= operations; second++)
                for (uint32_t then = 0; then < CUT_KINDS * seeds; then += power_long() || sequence->motor > 0 ? 2 : 11)
                    power_cut(&(struct cut){.fault = cut_kinds[then % CUT_KINDS], .operation = second, .seed = then});
        }
    }
}
END_TEST

static Suite *power_suite(void)
{
    Suite *suite = suite_create("power");
    double limit = power_long() ? 7200 : 100;
    tcase_add_loop_test(add_store_case(suite, "sequences", limit),
                        P6_a_power_cut_at_any_operation_of_a_store_leaves_the_old_or_the_new_program, 0, SOUND);
    tcase_add_loop_test(add_store_case(suite, "full", limit),
                        P6_a_power_cut_in_the_store_of_a_full_memory_leaves_the_old_or_the_new_program, 0, FULLS);
    tcase_add_loop_test(add_store_case(suite, "bytes", limit), P6_it_does_not_matter_at_which_byte_an_operation_was_torn, 4, 6);
    TCase *faults = add_store_case(suite, "faults", limit);
    tcase_add_loop_test(faults, P6_a_power_cut_beside_a_worn_block_leaves_the_old_or_the_new_program, 0, 2 * (FLASH_WEARS - 1));
    tcase_add_loop_test(faults, P6_a_power_cut_after_an_erase_that_failed_leaves_the_old_or_the_new_program, 0, 4);
    tcase_add_loop_test(add_store_case(suite, "again", limit),
                        P6_a_second_power_cut_in_the_store_after_the_first_leaves_the_old_or_the_new_program, 0, 3);
    return suite;
}

int main(void)
{
    power_count_begin();
    SRunner *runner = srunner_create(power_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    printf("power cuts: %lu\n", power_cuts());
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=sequences|full|bytes|faults|again ./test_power\n");
    if (!getenv("CK_RUN_CASE") && power_cuts() < (power_long() ? CUTS_LONG : CUTS_SHORT)) {
        printf("fewer power cuts than promised\n");
        failed = 1;
    }
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

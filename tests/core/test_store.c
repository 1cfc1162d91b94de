/* SPDX-License-Identifier: MIT */
/* test_store.c: the flash slots, U5 and P6 of the specification. One case alone: CK_RUN_CASE=power ./test_store */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store_rig.h"

#define HEADER_SIZE 16 /* bytes of a record before its commands */

/* ---- Storing and loading ---- */

START_TEST(U5_a_new_flash_holds_four_empty_slots)
{
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        assert_slot(motor, &programs[EMPTY]);
}
END_TEST

START_TEST(U5_what_was_stored_for_a_motor_is_loaded_for_that_motor)
{
    static const enum contents of[RKM04_MOTORS + 1] = {0, ONE, SHORT, FULL, WRAPPED};
    for (int round = 0; round < 3; round++) {
        for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
            ck_assert_int_eq(save(motor, &programs[of[motor]]), 0);
        for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
            assert_slot(motor, &programs[of[motor]]);
    }
}
END_TEST

START_TEST(P6_a_program_of_any_length_is_stored_as_it_is)
{
    struct rkm04_program program;
    for (unsigned count = 0; count <= RKM04_PROGRAM_MAX; count++) {
        fill(&program, count, count);
        ck_assert_int_eq(save(2, &program), 0);
        assert_slot(2, &program);
    }
}
END_TEST

START_TEST(P6_a_loaded_program_has_its_labels_and_blocks)
{
    struct rkm04_program program, found;
    uint64_t number = 0;
    program_clear(&program);
    program_append(&program, (struct rkm04_command){'@', 7});
    program_append(&program, (struct rkm04_command){'@', 80});
    program_append(&program, (struct rkm04_command){'[', 0});
    program_append(&program, (struct rkm04_command){']', 0});
    ck_assert_int_eq(save(1, &program), 0);
    ck_assert_int_eq(load(1, &found), RKM04_SLOT_LOADED);
    ck_assert(program_label(&found, 80, &number));
    ck_assert_uint_eq(number, 1);
    ck_assert(!program_label(&found, 8, &number));
    ck_assert(program_closed_after(&found, 2));
}
END_TEST

START_TEST(P6_an_empty_program_empties_the_slot)
{
    ck_assert_int_eq(save(3, &programs[SHORT]), 0);
    ck_assert_int_eq(save(3, &programs[FULL]), 0);
    ck_assert_int_eq(save(3, &programs[EMPTY]), 0);
    assert_slot(3, &programs[EMPTY]);
}
END_TEST

START_TEST(P6_a_store_leaves_the_memory_and_the_slots_of_the_others_alone)
{
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        ck_assert_int_eq(save(motor, &programs[SHORT]), 0);
    struct rkm04_program program = programs[FULL];
    struct flash_fake before = flash;
    ck_assert_int_eq(save(3, &program), 0);
    ck_assert(memcmp(&program, &programs[FULL], sizeof program) == 0);
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        if (block / 2 != 3 - 1)
            ck_assert_mem_eq(flash.data[block], before.data[block], RKM04_FLASH_BLOCK_SIZE);
}
END_TEST

START_TEST(U5_the_newest_record_is_never_touched_by_the_next_store)
{
    ck_assert_int_eq(save(1, &programs[ONE]), 0);
    for (int i = 0; i < 6; i++) {
        struct flash_fake before = flash;
        ck_assert_int_eq(save(1, &programs[i & 1 ? ONE : SHORT]), 0);
        unsigned touched = flash.erases[0] > before.erases[0] ? 0 : 1;
        ck_assert_uint_eq(touched, (unsigned)(i & 1) ^ 1);
        ck_assert_mem_eq(flash.data[touched ^ 1], before.data[touched ^ 1], RKM04_FLASH_BLOCK_SIZE);
        ck_assert_uint_eq(flash.erases[touched ^ 1], before.erases[touched ^ 1]);
    }
}
END_TEST

START_TEST(U5_without_flash_a_store_fails_and_slots_are_empty)
{
    struct rkm04_program found;
    for (int missing = 0; missing < 3; missing++) {
        struct rkm04_port without = store_port;
        if (missing == 0)
            without.flash_read = NULL;
        else if (missing == 1)
            without.flash_erase = NULL;
        else
            without.flash_program = NULL;
        ck_assert_int_eq(store_save(&without, &flash, 1, &programs[ONE]), 1);
        ck_assert_int_eq(store_load(&without, &flash, 1, &found), RKM04_SLOT_EMPTY);
        ck_assert_uint_eq(program_count(&found), 0);
    }
}
END_TEST

/* ---- Faults ---- */

/* The flash with `old` in the slot of a motor, stored `times` times so that either block may hold it. */
static void prepare(unsigned motor, enum contents old, int times)
{
    flash_fake_init(&flash);
    if (old == NOTHING)
        return;
    for (int i = 0; i < times; i++)
        ck_assert_int_eq(save(motor, &programs[old]), 0);
}

/* Operations that a store takes. */
static unsigned operations_of(unsigned motor, enum contents new)
{
    struct flash_fake before = flash;
    flash_fake_arm(&flash, 0, FLASH_WELL, 0);
    ck_assert_int_eq(save(motor, &programs[new]), 0);
    unsigned operations = flash.operations;
    flash = before;
    return operations;
}

/* One store with a fault at one operation, looked at as after the next power-up. */
static void store_with_fault(unsigned motor, enum contents old, enum contents new, enum flash_fault fault, unsigned n,
                             uint32_t seed)
{
    char where[128];
    snprintf(where, sizeof where, "motor %u, program %d over %d, %s at operation %u, seed %u", motor, (int)new, (int)old,
             flash_fault_name(fault), n, seed);
    flash_fake_arm(&flash, n, fault, seed);
    int result = save(motor, &programs[new]);
    flash_fake_power_on(&flash);
    struct rkm04_program found;
    enum rkm04_slot slot = load(motor, &found);
    bool is_old = same(&found, &programs[old]), is_new = same(&found, &programs[new]);
    ck_assert_msg(is_old || is_new, "%s: neither the old nor the new program but %u commands", where, program_count(&found));
    ck_assert_msg(result == 0 ? is_new : fault >= FLASH_CUT_BEFORE || is_old, "%s: returned %d", where, result);
    if (fault == FLASH_CUT_BEFORE)
        ck_assert_msg(is_old, "%s: the new program came out of nothing", where);
    if (old >= ONE && new >= ONE)
        ck_assert_msg(slot == RKM04_SLOT_LOADED, "%s: slot %d", where, (int)slot);
    ck_assert_msg(flash.misuse == 0, "%s: a rule of the flash was broken", where);
    ck_assert_msg(save(motor, &programs[SHORT]) == 0, "%s: the next store failed", where);
    assert_slot(motor, &programs[SHORT]);
}

static void store_with_every_fault(unsigned motor, enum contents old, enum contents new, int times, uint32_t seeds)
{
    prepare(motor, old, times);
    struct flash_fake before = flash;
    unsigned operations = operations_of(motor, new);
    ck_assert_uint_ge(operations, 2);
    for (enum flash_fault fault = FLASH_FAIL_NOTHING; fault < FLASH_FAULTS; fault++) {
        for (unsigned n = 1; n <= operations; n++) {
            for (uint32_t seed = 0; seed < seeds; seed++) {
                flash = before;
                store_with_fault(motor, old, new, fault, n, seed);
            }
        }
    }
}

START_TEST(P6_a_fault_or_power_cut_at_any_operation_leaves_the_old_or_the_new_program)
{
    enum contents old = (enum contents)(_i % CONTENTS);
    enum contents new = (enum contents)(_i / CONTENTS);
    if (new == NOTHING)
        return; /* the same as EMPTY */
    uint32_t seeds = old < FULL && new < FULL ? 24 : 2;
    store_with_every_fault(1, old, new, 1, seeds);
    store_with_every_fault(1, old, new, 2, seeds);
}
END_TEST

START_TEST(P6_the_slot_of_every_motor_is_as_safe)
{
    store_with_every_fault((unsigned)_i, SHORT, ONE, 1, 4);
    store_with_every_fault((unsigned)_i, ONE, SHORT, 2, 4);
}
END_TEST

START_TEST(P6_a_header_of_which_only_the_first_bytes_were_written_does_not_count)
{
    ck_assert_int_eq(save(1, &programs[SHORT]), 0);
    ck_assert_int_eq(save(1, &programs[ONE]), 0);
    ck_assert_int_eq(save(1, &programs[FULL]), 0);
    struct flash_fake before = flash;
    for (unsigned written = 0; written < HEADER_SIZE; written++) {
        flash = before;
        memset(&flash.data[0][written], 0xff, HEADER_SIZE - written);
        ck_assert(before.data[0][HEADER_SIZE - 1] != 0xff);
        assert_slot(1, &programs[ONE]);
    }
}
END_TEST

START_TEST(P6_a_power_cut_in_the_store_after_a_power_cut_leaves_the_old_program)
{
    for (unsigned n = 1; n <= 3; n++) {
        for (unsigned again = 1; again <= 3; again++) {
            for (uint32_t seed = 0; seed < 8; seed++) {
                prepare(1, FULL, 2);
                flash_fake_arm(&flash, n, FLASH_CUT_GARBAGE, seed);
                ck_assert_int_eq(save(1, &programs[ONE]), 1);
                flash_fake_power_on(&flash);
                flash_fake_arm(&flash, again, FLASH_CUT_GARBAGE, seed + 100);
                ck_assert_int_eq(save(1, &programs[SHORT]), 1);
                flash_fake_power_on(&flash);
                assert_slot(1, &programs[FULL]);
            }
        }
    }
}
END_TEST

START_TEST(P6_through_any_sequence_of_stores_and_power_cuts_the_slots_hold_what_they_held_or_were_given)
{
    uint32_t random = 12345;
    struct rkm04_program held[RKM04_MOTORS + 1];
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        program_clear(&held[motor]);
    for (unsigned i = 0; i < 3000; i++) {
        random = random * 1664525u + 1013904223u;
        unsigned motor = 1 + (random >> 16) % RKM04_MOTORS, n = (random >> 20) % 8;
        enum flash_fault fault = (enum flash_fault)(FLASH_CUT_BEFORE + (random >> 24) % (FLASH_FAULTS - FLASH_CUT_BEFORE));
        struct rkm04_program new, found;
        fill(&new, i, (random >> 8) % 61);
        flash_fake_arm(&flash, n, fault, i);
        int result = save(motor, &new);
        flash_fake_power_on(&flash);
        (void)load(motor, &found);
        ck_assert_msg(same(&found, &new) || (result != 0 && same(&found, &held[motor])), "store %u of motor %u", i, motor);
        held[motor] = found;
        for (unsigned other = 1; other <= RKM04_MOTORS; other++) {
            (void)load(other, &found);
            ck_assert_msg(same(&found, &held[other]), "store %u of motor %u changed motor %u", i, motor, other);
        }
    }
}
END_TEST

START_TEST(P6_a_read_that_fails_once_costs_at_most_the_store)
{
    static const enum contents olds[] = {NOTHING, ONE, FULL};
    for (size_t i = 0; i < sizeof olds / sizeof olds[0]; i++) {
        prepare(2, olds[i], 3);
        struct flash_fake before = flash;
        flash_fake_arm_read(&flash, 0);
        ck_assert_int_eq(save(2, &programs[SHORT]), 0);
        unsigned reads = flash.reads;
        for (unsigned n = 1; n <= reads; n++) {
            flash = before;
            flash_fake_arm_read(&flash, n);
            int result = save(2, &programs[SHORT]);
            flash_fake_power_on(&flash);
            assert_slot(2, &programs[result == 0 ? SHORT : olds[i]]);
        }
    }
}
END_TEST

START_TEST(P6_a_read_that_fails_once_and_a_power_cut_in_the_same_store_leave_the_old_or_the_new_program)
{
    prepare(2, ONE, 1);
    ck_assert_int_eq(save(2, &programs[FULL]), 0);
    struct flash_fake before = flash;
    unsigned operations = operations_of(2, SHORT);
    for (unsigned read = 1; read <= 90; read++) { /* all that look for the newest record */
        for (unsigned n = 1; n <= operations; n++) {
            flash = before;
            flash_fake_arm(&flash, n, FLASH_CUT_AFTER, 0);
            flash_fake_arm_read(&flash, read);
            save(2, &programs[SHORT]);
            flash_fake_power_on(&flash);
            struct rkm04_program found;
            load(2, &found);
            ck_assert_msg(same(&found, &programs[FULL]) || same(&found, &programs[SHORT]),
                          "read %u fails, cut after operation %u: %u commands of neither", read, n, program_count(&found));
        }
    }
}
END_TEST

START_TEST(U5_a_read_that_fails_once_at_power_up_costs_at_most_the_newest_program)
{
    ck_assert_int_eq(save(3, &programs[SHORT]), 0);
    ck_assert_int_eq(save(3, &programs[FULL]), 0);
    unsigned n = 0;
    do {
        struct rkm04_program found;
        flash_fake_arm_read(&flash, ++n);
        enum rkm04_slot slot = load(3, &found);
        ck_assert_msg(slot == RKM04_SLOT_LOADED, "read %u fails: slot %d", n, (int)slot);
        ck_assert_msg(same(&found, &programs[FULL]) || same(&found, &programs[SHORT]), "read %u fails: a mixture", n);
    } while (flash.reads >= n);
    ck_assert_uint_gt(n, 90);
}
END_TEST

START_TEST(U5_a_flash_that_cannot_be_read_is_reported_and_gives_an_empty_program)
{
    ck_assert_int_eq(save(1, &programs[SHORT]), 0);
    flash.off = true;
    assert_untrusted(1);
    ck_assert_int_eq(save(1, &programs[ONE]), 1);
    flash_fake_power_on(&flash);
    assert_slot(1, &programs[SHORT]);
}
END_TEST

static Suite *store_suite(void)
{
    Suite *suite = suite_create("store");
    TCase *plain = add_store_case(suite, "plain", 30);
    tcase_add_test(plain, U5_a_new_flash_holds_four_empty_slots);
    tcase_add_test(plain, U5_what_was_stored_for_a_motor_is_loaded_for_that_motor);
    tcase_add_test(plain, P6_a_program_of_any_length_is_stored_as_it_is);
    tcase_add_test(plain, P6_a_loaded_program_has_its_labels_and_blocks);
    tcase_add_test(plain, P6_an_empty_program_empties_the_slot);
    tcase_add_test(plain, P6_a_store_leaves_the_memory_and_the_slots_of_the_others_alone);
    tcase_add_test(plain, U5_the_newest_record_is_never_touched_by_the_next_store);
    tcase_add_test(plain, U5_without_flash_a_store_fails_and_slots_are_empty);

    TCase *power = add_store_case(suite, "power", 120);
    tcase_add_loop_test(power, P6_a_fault_or_power_cut_at_any_operation_leaves_the_old_or_the_new_program, 0,
                        CONTENTS * CONTENTS);
    tcase_add_loop_test(power, P6_the_slot_of_every_motor_is_as_safe, 1, RKM04_MOTORS + 1);
    tcase_add_test(power, P6_a_header_of_which_only_the_first_bytes_were_written_does_not_count);
    tcase_add_test(power, P6_a_power_cut_in_the_store_after_a_power_cut_leaves_the_old_program);
    tcase_add_test(power, P6_through_any_sequence_of_stores_and_power_cuts_the_slots_hold_what_they_held_or_were_given);
    tcase_add_test(power, P6_a_read_that_fails_once_costs_at_most_the_store);
    tcase_add_test(power, P6_a_read_that_fails_once_and_a_power_cut_in_the_same_store_leave_the_old_or_the_new_program);
    tcase_add_test(power, U5_a_read_that_fails_once_at_power_up_costs_at_most_the_newest_program);
    tcase_add_test(power, U5_a_flash_that_cannot_be_read_is_reported_and_gives_an_empty_program);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(store_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=plain|power ./test_store\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

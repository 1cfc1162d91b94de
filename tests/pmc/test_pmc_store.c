/* SPDX-License-Identifier: MIT */
/* AP6: parameters and program of an axis in flash, whole or not at all, whatever fails and wherever the power goes. */
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "pmc_rig.h"

static const struct pmc_config two_axes = {.axes = 2};

/* A state of an axis: every parameter and register depends on `variant`. */
static void fill(unsigned axis, unsigned variant)
{
    for (unsigned i = 0; i < PMC_PARAMETERS; i++) {
        const struct pmc_parameter_row *row = &pmc_parameter_rows[i];
        const uint64_t range = (uint64_t)((int64_t)row->high - row->low) + 1;
        const uint64_t at = (variant * UINT64_C(2654435761) + i * UINT64_C(40503)) % range;
        set(axis, (enum pmc_parameter)i, (int32_t)(row->low + (int64_t)at));
    }
    set(axis, PMC_FLAGS, 0x0033); /* nothing begins at power-on */
    for (unsigned i = 0; i < PMC_REGISTERS; i++) {
        struct pmc_command command = {.op = PMC_JMP, .argument = (uint8_t)((variant + i) % 64)};
        if (i % 3 == 0)
            command = (struct pmc_command){
                .op = PMC_INC, .value = (int32_t)(variant * 1000 + i) - 40000, .speed = 2, .ms = 65535};
        if (i % 3 == 1)
            command = (struct pmc_command){
                .op = PMC_OTP, .ms = (uint16_t)(variant + 1), .number = i / 3 % 2, .wait = i / 6 % 2 != 0};
        reg(axis, i, command);
    }
}

static bool same(const struct pmc_axis *a, const struct pmc_axis *b)
{
    bool is_same = memcmp(&a->parameters, &b->parameters, sizeof a->parameters) == 0;
    for (unsigned i = 0; i < PMC_REGISTERS; i++) {
        const struct pmc_command *c = &a->program[i], *d = &b->program[i];
        is_same = is_same && c->value == d->value && c->ms == d->ms && c->op == d->op && c->speed == d->speed &&
                  c->argument == d->argument && c->number == d->number && c->wait == d->wait;
    }
    return is_same;
}

static struct pmc_axis states[4]; /* 0: as in T1; variants 1 to 3 */

static void begin(void)
{
    pmc_rig_begin(&two_axes);
    for (unsigned i = 0; i < 4 && states[3].parameters.value[PMC_MULTIPLIER] == 0; i++) { /* once */
        if (i > 0)
            fill(0, i);
        states[i] = unit.axis[0];
    }
}

/* Give X a state. */
static void put(unsigned state)
{
    ck_assert_int_eq(pmc_set_parameters(&unit, 0, &states[state].parameters), PMC_OK);
    ck_assert_int_eq(pmc_set_program(&unit, 0, states[state].program), PMC_OK);
}

/* Power up; how many of the states the axis has. 4: none of them. */
static unsigned state_after_restart(unsigned axis)
{
    unsigned state = 0;
    flash_fake_power_on(&flash);
    pmc_rig_restart(&two_axes);
    while (state < 4 && !same(&unit.axis[axis], &states[state]))
        state++;
    return state;
}

START_TEST(AP6_what_is_stored_is_there_after_power_up_and_reset)
{
    begin();
    fill(1, 2);
    ck_assert_int_eq(pmc_store(&unit, 1), PMC_OK);
    ck_assert_uint_eq(state_after_restart(1), 2);
    ck_assert_uint_eq(state_after_restart(0), 0); /* one axis alone */
    for (unsigned i = 0; i < 4; i++) { /* each in blocks of its own */
        fill(i % 2, 3 - i / 2);
        ck_assert_int_eq(pmc_store(&unit, i % 2), PMC_OK);
    }
    ck_assert_uint_eq(state_after_restart(0), 2);
    ck_assert_uint_eq(state_after_restart(1), 2);
    fill(1, 3);
    fill(0, 1);
    must(PMC_RESET, 0, 0, 0);
    run_through_slot(1);
    ck_assert(same(&unit.axis[1], &states[2]));
    ck_assert(same(&unit.axis[0], &states[2]));
    ck_assert_uint_eq(flash.misuse, 0);
}
END_TEST

START_TEST(AP6_without_flash_nothing_is_stored)
{
    static const struct pmc_port none;
    struct pmc_unit small;
    pmc_init(&small, &two_axes, &none, NULL);
    ck_assert(memcmp(&small.axis[0].parameters, &small.axis[1].parameters, sizeof small.axis[0].parameters) == 0);
    ck_assert_int_eq(small.axis[0].parameters.value[PMC_SPEED4], 8000);
    ck_assert_int_eq(pmc_store(&small, 0), PMC_STORE_FAILED);
    ck_assert_int_eq(pmc_store(&small, 2), PMC_NO_AXIS);
    const struct pmc_command on = {.op = PMC_OUT, .argument = 1}; /* nor reported */
    const struct pmc_request run = {.kind = PMC_RUN, .axes = 1}, jog = {.kind = PMC_JOG, .axes = 2, .value = {0, -1}};
    ck_assert_int_eq(pmc_set_command(&small, 0, 0, &on), PMC_OK);
    ck_assert_int_eq(pmc_request(&small, &run), PMC_OK);
    ck_assert_int_eq(pmc_request(&small, &jog), PMC_OK);
    pmc_advance(&small, 20 * SLOT);
    ck_assert_uint_eq(pmc_outputs(&small), 1);
    ck_assert_int_eq(small.axis[1].commanded, -1);
}
END_TEST

static int do_nothing(void *context, unsigned block)
{
    (void)context, (void)block;
    return 0;
}

static int program_nothing(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context, (void)block, (void)offset, (void)data, (void)length;
    return 0;
}

START_TEST(AP6_a_flash_that_lies_or_has_no_such_function)
{
    static const struct pmc_port ports[] = {
        {.flash_read = flash_fake_read, .flash_erase = do_nothing, .flash_program = program_nothing},
        {.flash_read = flash_fake_read, .flash_erase = flash_fake_erase},
        {.flash_read = flash_fake_read, .flash_program = flash_fake_program},
    };
    begin();
    for (unsigned i = 1; i <= 2; i++) {
        fill(0, i);
        ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    }
    fill(0, 3);
    unit.port = &ports[_i];
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_STORE_FAILED);
    ck_assert_uint_eq(state_after_restart(0), 2);
}
END_TEST

/* Bring the flash to where state 1, or with `times` 2 state 2 behind it, is stored, and state 3 is about to be. */
static void prepare(unsigned times)
{
    begin();
    for (unsigned i = 1; i <= times; i++) {
        put(i);
        ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    }
    put(3);
}

static const enum flash_fault faults[] = {
    FLASH_FAIL_NOTHING, FLASH_FAIL_TORN, FLASH_FAIL_DONE, FLASH_LIE,       FLASH_CUT_BEFORE, FLASH_CUT_PREFIX,
    FLASH_CUT_SUFFIX,   FLASH_CUT_BITS,  FLASH_CUT_GARBAGE, FLASH_CUT_ZEROS, FLASH_CUT_FLIPS,  FLASH_CUT_AFTER,
};
#define FAULTS (sizeof faults / sizeof faults[0])

/* How many erases and programs a store takes. */
static unsigned count_operations(unsigned times)
{
    prepare(times);
    flash_fake_arm(&flash, 0, FLASH_WELL, 0);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    ck_assert_uint_eq(state_after_restart(0), 3);
    return flash.operations;
}

/* _i: times something was stored before * kind of fault. */
START_TEST(AP6_a_power_cut_leaves_the_old_state_or_the_new_one)
{
    const unsigned times = (unsigned)_i / FAULTS;
    const enum flash_fault fault = faults[(unsigned)_i % FAULTS];
    const unsigned operations = count_operations(times);
    ck_assert_uint_eq(operations, 11);
    for (unsigned n = 1; n <= operations; n++)
        for (uint32_t seed = 1; seed <= 6; seed++) {
            prepare(times);
            flash_fake_arm(&flash, n, fault, seed);
            const enum pmc_answer answer = pmc_store(&unit, 0);
            const bool cut = flash.off;
            const unsigned state = state_after_restart(0);
            ck_assert_msg(state == times || state == 3, "%s at %u, seed %u: state %u", flash_fault_name(fault), n, (unsigned)seed,
                          state);
            if (!cut && answer == PMC_OK)
                ck_assert_uint_eq(state, 3);
            if (!cut && answer != PMC_OK)
                ck_assert_uint_eq(state, times);
            put(3); /* and it can be stored again */
            ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
            ck_assert_uint_eq(state_after_restart(0), 3);
            ck_assert_uint_eq(flash.misuse, 0);
        }
}
END_TEST

START_TEST(AP6_a_read_that_fails_once_or_with_the_power)
{
    prepare(2);
    flash_fake_arm_read(&flash, 0);
    flash.reads = 0;
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    const unsigned reads = flash.reads;
    for (unsigned n = 1; n <= reads; n++) {
        prepare(2);
        flash_fake_arm_read(&flash, n); /* is asked again */
        ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
        ck_assert_uint_eq(state_after_restart(0), 3);
        prepare(2);
        flash_fake_cut_at_read(&flash, n);
        pmc_store(&unit, 0);
        const unsigned state = state_after_restart(0);
        ck_assert_msg(state == 2 || state == 3, "read %u: state %u", n, state);
    }
    ck_assert_uint_gt(reads, 20);
}
END_TEST

START_TEST(AP6_reads_that_fail_at_power_up)
{
    prepare(2);
    flash.reads = 0;
    pmc_rig_restart(&two_axes);
    const unsigned reads = flash.reads;
    for (unsigned n = 1; n <= reads; n++) {
        flash_fake_arm_read(&flash, n);
        pmc_rig_restart(&two_axes);
        ck_assert(same(&unit.axis[0], &states[2]));
    }
    for (unsigned n = 1; n <= reads; n++) { /* all from one on: the axis has a whole state all the same */
        flash_fake_cut_at_read(&flash, n);
        pmc_rig_restart(&two_axes);
        flash_fake_power_on(&flash);
        ck_assert(same(&unit.axis[0], &states[0]) || same(&unit.axis[0], &states[1]) || same(&unit.axis[0], &states[2]));
        ck_assert(same(&unit.axis[1], &states[0]));
    }
}
END_TEST

/* Change a byte of the newest record of X, with a check value that fits. */
static void forge(unsigned offset, uint8_t value)
{
    uint8_t *block = flash.data[1];
    block[offset] = value;
    const uint32_t check = crc32_update(crc32_update(0, block, 12), block + 16, 4 * PMC_PARAMETERS + 11 * PMC_REGISTERS);
    for (unsigned i = 0; i < 4; i++)
        block[12 + i] = (uint8_t)(check >> 8 * i);
}

START_TEST(AP6_what_is_not_legal_is_no_state)
{
    static const struct {
        unsigned offset;
        uint8_t value;
        unsigned state;
    } rows[] = {
        {0, 'X', 1}, {4, 2, 1}, {5, 1, 1}, {6, 0, 1}, /* not of this format, or of another axis */
        {16, 0, 2},   {19, 255, 1}, {17, 2, 1}, /* multiplier */
        {104 + 6, 99, 1}, {104 + 7, 9, 1}, {104 + 11 * 63 + 6, PMC_OPS, 1}, /* commands */
    };
    prepare(2);
    ck_assert_uint_eq(state_after_restart(0), 2);
    forge(rows[_i].offset, _i == 4 ? (uint8_t)states[2].parameters.value[PMC_MULTIPLIER] : rows[_i].value);
    ck_assert_uint_eq(state_after_restart(0), rows[_i].state);
}
END_TEST

START_TEST(AP6_generations_count_through_0)
{
    prepare(2);
    for (unsigned i = 8; i < 12; i++)
        forge(i, 0xFF);
    ck_assert_uint_eq(state_after_restart(0), 1); /* older than 1 */
    prepare(1);
    memcpy(flash.data[1], flash.data[0], sizeof flash.data[1]);
    for (unsigned i = 8; i < 12; i++)
        forge(i, 0xFF);
    memset(flash.data[0], 0xFF, sizeof flash.data[0]);
    memset(flash.used[0], 0, sizeof flash.used[0]);
    ck_assert_uint_eq(state_after_restart(0), 1);
    put(3);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    ck_assert_uint_eq(state_after_restart(0), 3);
}
END_TEST

static Suite *store_suite(void)
{
    Suite *suite = suite_create("pmc_store");
    TCase *all = tcase_create("store");
    tcase_set_timeout(all, 60);
    tcase_add_test(all, AP6_what_is_stored_is_there_after_power_up_and_reset);
    tcase_add_test(all, AP6_without_flash_nothing_is_stored);
    tcase_add_loop_test(all, AP6_a_flash_that_lies_or_has_no_such_function, 0, 3);
    tcase_add_loop_test(all, AP6_a_power_cut_leaves_the_old_state_or_the_new_one, 0, 3 * FAULTS);
    tcase_add_test(all, AP6_a_read_that_fails_once_or_with_the_power);
    tcase_add_test(all, AP6_reads_that_fail_at_power_up);
    tcase_add_loop_test(all, AP6_what_is_not_legal_is_no_state, 0, 10);
    tcase_add_test(all, AP6_generations_count_through_0);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(store_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}

/* test_store.c: the flash slots, U5 and P6 of the specification. One case alone: CK_RUN_CASE=power ./test_store */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "flash_fake.h"
#include "program.h"
#include "store.h"

static const struct rkm04_port port = {
    .flash_read = flash_fake_read,
    .flash_erase = flash_fake_erase,
    .flash_program = flash_fake_program,
};

static struct flash_fake flash;

/* The programs that are stored over one another. */
enum contents { NOTHING, EMPTY, ONE, SHORT, FULL, WRAPPED, CONTENTS };
static struct rkm04_program programs[CONTENTS];

static struct rkm04_command some_command(unsigned i)
{
    switch (i % 6) {
    case 0:
        return (struct rkm04_command){'F', 1 + i * 21841u % 16000000u};
    case 1:
        return (struct rkm04_command){'@', 1 + i % 80};
    case 2:
        return (struct rkm04_command){'=', 0u - i * 2000001u % 2000000000u};
    case 3:
        return (struct rkm04_command){'I', (1 + i % 8) | (i / 6 & 1) << 8 | (1 + i % 80) << 16};
    case 4:
        return (struct rkm04_command){'G', i & 8 ? RKM04_G_BACK : 2000000000u - i};
    default:
        return (struct rkm04_command){'R', 0};
    }
}

static void fill(struct rkm04_program *program, unsigned first, unsigned count)
{
    program_clear(program);
    for (unsigned i = 0; i < count; i++)
        program_append(program, some_command(first + i));
}

static void set_up(void)
{
    flash_fake_init(&flash);
    fill(&programs[NOTHING], 0, 0);
    fill(&programs[EMPTY], 0, 0);
    fill(&programs[ONE], 0, 1);
    fill(&programs[SHORT], 100, 37);
    fill(&programs[FULL], 200, 700);
    fill(&programs[WRAPPED], 1000, 700 + 123);
}

static void tear_down(void)
{
    ck_assert_msg(flash.misuse == 0, "the store broke a rule of the flash %u times", flash.misuse);
}

static bool same(const struct rkm04_program *a, const struct rkm04_program *b)
{
    if (program_count(a) != program_count(b))
        return false;
    for (unsigned i = 0; i < program_count(a); i++) {
        struct rkm04_command x = program_at(a, program_oldest(a) + i), y = program_at(b, program_oldest(b) + i);
        if (x.op != y.op || x.argument != y.argument)
            return false;
    }
    return true;
}

static int save(unsigned motor, const struct rkm04_program *program)
{
    return store_save(&port, &flash, motor, program);
}

static enum rkm04_slot load(unsigned motor, struct rkm04_program *program)
{
    memset(program, 0x55, sizeof *program);
    return store_load(&port, &flash, motor, program);
}

static void assert_slot(unsigned motor, const struct rkm04_program *expected)
{
    struct rkm04_program found;
    enum rkm04_slot slot = load(motor, &found);
    ck_assert_msg(same(&found, expected), "motor %u: %u commands in place of %u", motor, program_count(&found),
                  program_count(expected));
    ck_assert_int_eq(slot, program_count(expected) > 0 ? RKM04_SLOT_LOADED : RKM04_SLOT_EMPTY);
}

static void assert_untrusted(unsigned motor)
{
    struct rkm04_program found;
    ck_assert_int_eq(load(motor, &found), RKM04_SLOT_UNTRUSTED);
    ck_assert_uint_eq(program_count(&found), 0);
}

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

START_TEST(P6_a_program_of_any_length_is_stored_as_it_stands)
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
        struct rkm04_port without = port;
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

/* ---- Bytes ---- */

/* Record of motor 2, generation 1: S100 V1000 F5 R =-7 I05H20. */
static const uint8_t record[] = {
    0x52, 0x4b, 0x34, 0x50, 0x01, 0x02, 0x06, 0x00, 0x01, 0x00, 0x00, 0x00, 0x52, 0x85, 0x1f, 0x7c, /* header */
    0x53, 0x64, 0x00, 0x00, 0x00, 0x56, 0xe8, 0x03, 0x00, 0x00, 0x46, 0x05, 0x00, 0x00, 0x00,       /* S V F */
    0x52, 0x00, 0x00, 0x00, 0x00, 0x3d, 0xf9, 0xff, 0xff, 0xff, 0x49, 0x05, 0x01, 0x14, 0x00,       /* R = I */
    0xff, 0xff,
};
#define COMMANDS_AT 16
#define COMMANDS_LENGTH 30

static void fill_example(struct rkm04_program *program)
{
    program_clear(program);
    program_append(program, (struct rkm04_command){'S', 100});
    program_append(program, (struct rkm04_command){'V', 1000});
    program_append(program, (struct rkm04_command){'F', 5});
    program_append(program, (struct rkm04_command){'R', 0});
    program_append(program, (struct rkm04_command){'=', (uint32_t)-7});
    program_append(program, (struct rkm04_command){'I', 5 | 1 << 8 | 20 << 16});
}

START_TEST(U5_the_check_value_of_123456789_is_CBF43926)
{
    ck_assert_uint_eq(crc32_update(0, (const uint8_t *)"123456789", 9), 0xcbf43926u);
    ck_assert_uint_eq(crc32_update(crc32_update(0, (const uint8_t *)"1234", 4), (const uint8_t *)"56789", 5), 0xcbf43926u);
}
END_TEST

START_TEST(U5_a_record_has_the_documented_bytes)
{
    struct rkm04_program program;
    fill_example(&program);
    ck_assert_int_eq(save(2, &program), 0);
    ck_assert_mem_eq(flash.data[2], record, sizeof record);
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        for (unsigned i = block == 2 ? sizeof record : 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
            ck_assert_uint_eq(flash.data[block][i], 0xff);
}
END_TEST

/* Put a record into a block as another writer might have, its check value made right again. */
static void plant(unsigned block, const uint8_t *bytes)
{
    uint8_t copy[sizeof record];
    memcpy(copy, bytes, sizeof copy);
    uint32_t check = crc32_update(crc32_update(0, copy, 12), copy + COMMANDS_AT, COMMANDS_LENGTH);
    for (int i = 0; i < 4; i++)
        copy[12 + i] = (uint8_t)(check >> 8 * i);
    memset(flash.data[block], 0xff, RKM04_FLASH_BLOCK_SIZE);
    memcpy(flash.data[block], copy, sizeof copy);
}

START_TEST(U5_the_documented_bytes_are_loaded)
{
    struct rkm04_program program;
    fill_example(&program);
    memcpy(flash.data[2], record, sizeof record);
    assert_slot(2, &program);
    memset(flash.data[2], 0xff, RKM04_FLASH_BLOCK_SIZE);
    memcpy(flash.data[3], record, sizeof record);
    assert_slot(2, &program);
}
END_TEST

static const struct {
    const char *what;
    unsigned at;
    uint8_t byte;
} spoiled[] = {
    {"another magic", 0, 'r'},
    {"another magic", 3, 'Q'},
    {"a later version", 4, 2},
    {"version 0", 4, 0},
    {"the record of another motor", 5, 3},
    {"a character that is no command", COMMANDS_AT, 'a'},
    {"an erased byte as a command", COMMANDS_AT, 0xff},
    {"a reset", COMMANDS_AT + 15, '\\'},
    {"K", COMMANDS_AT + 15, 'K'},
    {"S2148", COMMANDS_AT + 2, 8},
    {"V66536", COMMANDS_AT + 8, 1},
    {"R with a number", COMMANDS_AT + 16, 1},
    {"=-2130706439", COMMANDS_AT + 24, 0x80},
    {"I09H20", COMMANDS_AT + 26, 9},
    {"a level that is neither H nor L", COMMANDS_AT + 27, 2},
    {"I05H81", COMMANDS_AT + 28, 81},
    {"I05H00", COMMANDS_AT + 28, 0},
    {"an argument of I that says too much", COMMANDS_AT + 29, 1},
};

START_TEST(U5_a_record_with_a_right_check_value_and_a_wrong_content_is_not_trusted)
{
    uint8_t bytes[sizeof record];
    memcpy(bytes, record, sizeof bytes);
    bytes[spoiled[_i].at] = spoiled[_i].byte;
    plant(2, bytes);
    struct rkm04_program found;
    ck_assert_msg(load(2, &found) == RKM04_SLOT_UNTRUSTED && program_count(&found) == 0, "%s was trusted", spoiled[_i].what);
}
END_TEST

START_TEST(U5_a_label_out_of_range_or_C75_is_not_trusted)
{
    static const struct rkm04_command bad[] = {{'@', 0}, {'@', 81}, {'C', 75}, {'@', UINT32_MAX}, {'I', UINT32_MAX}, {0, 0}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        uint8_t bytes[sizeof record];
        memcpy(bytes, record, sizeof bytes);
        bytes[COMMANDS_AT] = bad[i].op;
        for (int j = 0; j < 4; j++)
            bytes[COMMANDS_AT + 1 + j] = (uint8_t)(bad[i].argument >> 8 * j);
        plant(2, bytes);
        assert_untrusted(2);
    }
}
END_TEST

START_TEST(U5_a_record_of_701_commands_is_not_trusted)
{
    static const uint8_t r[5] = {'R'};
    for (unsigned count = RKM04_PROGRAM_MAX; count <= RKM04_PROGRAM_MAX + 1; count++) {
        uint8_t *block = flash.data[2];
        memset(block, 0xff, RKM04_FLASH_BLOCK_SIZE);
        memcpy(block, record, COMMANDS_AT);
        block[6] = (uint8_t)count;
        block[7] = (uint8_t)(count >> 8);
        for (unsigned i = 0; i < count; i++)
            memcpy(block + COMMANDS_AT + 5 * i, r, sizeof r);
        uint32_t check = crc32_update(crc32_update(0, block, 12), block + COMMANDS_AT, 5 * count);
        for (int i = 0; i < 4; i++)
            block[12 + i] = (uint8_t)(check >> 8 * i);
        struct rkm04_program found;
        ck_assert_int_eq(load(2, &found), count <= RKM04_PROGRAM_MAX ? RKM04_SLOT_LOADED : RKM04_SLOT_UNTRUSTED);
    }
}
END_TEST

START_TEST(U5_a_record_with_any_bit_changed_is_not_trusted)
{
    struct rkm04_program program;
    fill_example(&program);
    ck_assert_int_eq(save(2, &program), 0);
    for (unsigned bit = 0; bit < 8 * (COMMANDS_AT + COMMANDS_LENGTH); bit++) {
        flash.data[2][bit / 8] ^= (uint8_t)(1u << bit % 8);
        assert_untrusted(2);
        flash.data[2][bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    assert_slot(2, &program);
}
END_TEST

START_TEST(U5_a_full_record_with_any_byte_changed_is_not_trusted)
{
    ck_assert_int_eq(save(4, &programs[WRAPPED]), 0);
    for (unsigned at = 0; at < COMMANDS_AT + 5 * RKM04_PROGRAM_MAX; at++) {
        flash.data[6][at] ^= 0xff;
        assert_untrusted(4);
        flash.data[6][at] ^= 0xff;
    }
    assert_slot(4, &programs[WRAPPED]);
}
END_TEST

START_TEST(U5_if_the_newest_record_is_spoiled_the_one_before_is_loaded)
{
    ck_assert_int_eq(save(1, &programs[SHORT]), 0);
    ck_assert_int_eq(save(1, &programs[FULL]), 0);
    flash.data[1][1234] ^= 0x10;
    assert_slot(1, &programs[SHORT]);
    ck_assert_int_eq(save(1, &programs[ONE]), 0);
    assert_slot(1, &programs[ONE]);
}
END_TEST

START_TEST(U5_generations_count_on_through_zero)
{
    uint8_t bytes[sizeof record];
    memcpy(bytes, record, sizeof bytes);
    memset(bytes + 8, 0xff, 4);
    bytes[8] = 0xfd;
    plant(3, bytes);
    for (unsigned i = 0; i < 6; i++) {
        fill(&programs[ONE], 50 + i, 1);
        ck_assert_int_eq(save(2, &programs[ONE]), 0);
        assert_slot(2, &programs[ONE]);
    }
    ck_assert_uint_eq(flash.data[3][8], 0x03);
    ck_assert_uint_eq(flash.data[3][11], 0x00);
    ck_assert_uint_eq(flash.data[2][8], 0x02);
}
END_TEST

START_TEST(U5_garbage_in_the_flash_is_not_trusted_and_can_be_stored_over)
{
    uint32_t random = 1;
    for (int round = 0; round < 200; round++) {
        for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++) {
            random = random * 1664525u + 1013904223u;
            flash.data[4][i] = (uint8_t)(random >> 24);
            flash.data[5][i] = (uint8_t)(random >> 16);
        }
        assert_untrusted(3);
    }
    ck_assert_int_eq(save(3, &programs[SHORT]), 0);
    assert_slot(3, &programs[SHORT]);
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
    for (unsigned written = 0; written < COMMANDS_AT; written++) {
        flash = before;
        memset(&flash.data[0][written], 0xff, COMMANDS_AT - written);
        ck_assert(before.data[0][COMMANDS_AT - 1] != 0xff);
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

static TCase *add_case(Suite *suite, const char *name, double seconds)
{
    TCase *tcase = tcase_create(name);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_set_timeout(tcase, seconds);
    suite_add_tcase(suite, tcase);
    return tcase;
}

static Suite *store_suite(void)
{
    Suite *suite = suite_create("store");
    TCase *plain = add_case(suite, "plain", 30);
    tcase_add_test(plain, U5_a_new_flash_holds_four_empty_slots);
    tcase_add_test(plain, U5_what_was_stored_for_a_motor_is_loaded_for_that_motor);
    tcase_add_test(plain, P6_a_program_of_any_length_is_stored_as_it_stands);
    tcase_add_test(plain, P6_a_loaded_program_has_its_labels_and_blocks);
    tcase_add_test(plain, P6_an_empty_program_empties_the_slot);
    tcase_add_test(plain, P6_a_store_leaves_the_memory_and_the_slots_of_the_others_alone);
    tcase_add_test(plain, U5_the_newest_record_is_never_touched_by_the_next_store);
    tcase_add_test(plain, U5_without_flash_a_store_fails_and_slots_are_empty);

    TCase *bytes = add_case(suite, "bytes", 30);
    tcase_add_test(bytes, U5_the_check_value_of_123456789_is_CBF43926);
    tcase_add_test(bytes, U5_a_record_has_the_documented_bytes);
    tcase_add_test(bytes, U5_the_documented_bytes_are_loaded);
    tcase_add_loop_test(bytes, U5_a_record_with_a_right_check_value_and_a_wrong_content_is_not_trusted, 0,
                        sizeof spoiled / sizeof spoiled[0]);
    tcase_add_test(bytes, U5_a_label_out_of_range_or_C75_is_not_trusted);
    tcase_add_test(bytes, U5_a_record_of_701_commands_is_not_trusted);
    tcase_add_test(bytes, U5_a_record_with_any_bit_changed_is_not_trusted);
    tcase_add_test(bytes, U5_a_full_record_with_any_byte_changed_is_not_trusted);
    tcase_add_test(bytes, U5_if_the_newest_record_is_spoiled_the_one_before_is_loaded);
    tcase_add_test(bytes, U5_generations_count_on_through_zero);
    tcase_add_test(bytes, U5_garbage_in_the_flash_is_not_trusted_and_can_be_stored_over);

    TCase *power = add_case(suite, "power", 120);
    tcase_add_loop_test(power, P6_a_fault_or_power_cut_at_any_operation_leaves_the_old_or_the_new_program, 0,
                        CONTENTS * CONTENTS);
    tcase_add_loop_test(power, P6_the_slot_of_every_motor_is_as_safe, 1, RKM04_MOTORS + 1);
    tcase_add_test(power, P6_a_header_of_which_only_the_first_bytes_were_written_does_not_count);
    tcase_add_test(power, P6_a_power_cut_in_the_store_after_a_power_cut_leaves_the_old_program);
    tcase_add_test(power, P6_through_any_sequence_of_stores_and_power_cuts_the_slots_hold_what_they_held_or_were_given);
    tcase_add_test(power, P6_a_read_that_fails_once_costs_at_most_the_store);
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
        printf("One case alone: CK_RUN_CASE=plain|bytes|power ./test_store\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* SPDX-License-Identifier: MIT */
#include "power_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "crc32.h"

#define STORE_FLASH 3
#define HEADER_SIZE 16
#define CHECKED_SIZE 12

/* A unit with its flash, which is `flash` of store_rig.h while it runs. */
struct bench {
    struct rkm04_unit unit;
    struct flash_fake flash;
    struct rkm04_program old[RKM04_MOTORS], new[RKM04_MOTORS];
    enum rkm04_slot slot[RKM04_MOTORS];
};

static struct bench start;
static struct rkm04_unit unit;
static const struct sequence *sequence;
static unsigned long *cuts;

/* ---- Counting ---- */

void power_count_begin(void)
{
    cuts = mmap(NULL, sizeof *cuts, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (cuts == MAP_FAILED)
        abort();
}

unsigned long power_cuts(void)
{
    return *cuts;
}

bool power_long(void)
{
    return getenv("RKM04_TEST_LONG") != NULL;
}

/* ---- The beginning ---- */

static void power_up(void)
{
    static const struct rkm04_config config = {.node = 1};
    rkm04_init(&unit, &config, &store_port, &flash);
}

static bool asked_for(unsigned motor)
{
    return sequence->motor == 0 || sequence->motor == motor;
}

/* A program of its own for every motor. */
static void make(struct rkm04_program *program, enum contents contents, unsigned motor, unsigned variant)
{
    static const unsigned count[CONTENTS] = {[ONE] = 1, [SHORT] = 37, [FULL] = 700, [WRAPPED] = 700 + 123};
    fill(program, 10000 * variant + 1000 * motor, count[contents]);
}

/* Message 3. Returns its err byte, or -1 if the power has gone meanwhile. */
static int store_flash(unsigned motor)
{
    uint8_t request[2] = {STORE_FLASH, (uint8_t)('0' + motor)}, answer[4] = {0};
    size_t length = rkm04_exchange(&unit, request, sizeof request, answer, sizeof answer);
    if (flash.off)
        return -1;
    ck_assert_uint_eq(length, 3);
    return answer[2];
}

static void make_last_generation(uint8_t *block)
{
    unsigned length = 5u * (block[6] | (unsigned)block[7] << 8);
    memset(block + 8, 0xff, 4);
    uint32_t check = crc32_update(crc32_update(0, block, CHECKED_SIZE), block + HEADER_SIZE, length);
    for (int i = 0; i < 4; i++)
        block[CHECKED_SIZE + i] = (uint8_t)(check >> 8 * i);
}

static void make_garbage(void)
{
    uint32_t random = 1;
    for (unsigned i = 0; i < sizeof flash.data; i++) {
        random = random * 1664525u + 1013904223u;
        flash.data[i / RKM04_FLASH_BLOCK_SIZE][i % RKM04_FLASH_BLOCK_SIZE] = (uint8_t)(random >> 24);
    }
    memset(flash.used, true, sizeof flash.used);
}

/* Old programs, in flash: those of motors that are not asked for have one command. */
static void store_old(void)
{
    power_up();
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        make(&start.old[i], sequence->old == NOTHING ? NOTHING : asked_for(i + 1) ? sequence->old : ONE, i + 1, 1);
        make(&start.new[i], sequence->new, i + 1, 2);
        unit.motor[i].program = start.old[i];
    }
    for (unsigned i = 0; i < sequence->times; i++)
        ck_assert_int_eq(store_flash(0), 0);
}

/* Power-up, and new programs in memory. */
static void begin(void)
{
    power_up();
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        start.slot[i] = (enum rkm04_slot)unit.motor[i].slot;
        ck_assert(same(&unit.motor[i].program, &start.old[i]));
        if (asked_for(i + 1))
            unit.motor[i].program = start.new[i];
    }
    start.unit = unit;
    start.flash = flash;
}

void power_prepare(const struct sequence *wanted)
{
    sequence = wanted;
    flash_fake_init(&flash);
    store_old();
    if (sequence->garbage)
        make_garbage();
    for (unsigned i = 0; i < RKM04_MOTORS && sequence->last_generation; i++)
        make_last_generation(flash.data[2 * i + (sequence->times + 1) % 2]);
    unsigned worn = sequence->motor == 0 ? 2 : sequence->motor;
    flash.wear[2 * (worn - 1) + sequence->times % 2] = sequence->wear;
    begin();
}

/* ---- A run ---- */

/* Ask for the stores. Returns whether one was answered with err 0, in *failed whether one was not. */
static bool do_stores(bool *failed)
{
    bool done = false;
    *failed = false;
    for (unsigned i = 0; i < sequence->stores || i == 0; i++) {
        int err = store_flash(sequence->motor);
        if (err < 0)
            break;
        *(err == 0 ? &done : failed) = true;
    }
    return done;
}

static void from_the_start(const struct cut *cut)
{
    unit = start.unit;
    flash = start.flash;
    flash_fake_arm(&flash, cut->operation, cut->fault, cut->seed);
    if (sequence->first != FLASH_WELL)
        flash_fake_arm_also(&flash, 1, sequence->first);
    flash.border = cut->border;
    flash_fake_cut_at_read(&flash, cut->read);
}

/* Does the motor have this program after power-up, and is the slot called what it is? */
static bool holds(unsigned i, const struct rkm04_program *program)
{
    enum rkm04_slot slot = (enum rkm04_slot)unit.motor[i].slot;
    if (!same(&unit.motor[i].program, program))
        return false;
    return program_count(program) > 0 ? slot == RKM04_SLOT_LOADED : slot != RKM04_SLOT_LOADED;
}

static void assert_untouched(unsigned i, const char *where)
{
    ck_assert_msg(holds(i, &start.old[i]), "%s: motor %u has lost its program", where, i + 1);
    ck_assert_msg(memcmp(flash.data[2 * i], start.flash.data[2 * i], 2 * RKM04_FLASH_BLOCK_SIZE) == 0,
                  "%s: a block of motor %u was touched", where, i + 1);
}

/* Look at every slot after a power-up. `stored`: the host was answered that it had worked. */
static void assert_old_or_new(bool stored, const char *where)
{
    bool new_so_far = true;
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        if (!asked_for(i + 1)) {
            assert_untouched(i, where);
            continue;
        }
        bool is_new = holds(i, &start.new[i]), is_old = holds(i, &start.old[i]);
        ck_assert_msg(is_new || is_old, "%s: motor %u: neither the old nor the new program but %u commands, slot %d", where,
                      i + 1, program_count(&unit.motor[i].program), (int)unit.motor[i].slot);
        ck_assert_msg(is_new || !stored, "%s: motor %u: the old program, after err 0", where, i + 1);
        ck_assert_msg(start.slot[i] != RKM04_SLOT_LOADED || unit.motor[i].slot != RKM04_SLOT_UNTRUSTED,
                      "%s: motor %u: the slot is not trusted", where, i + 1);
        /* The slots are written in turn: what comes after the cut is old, unless an operation fails. */
        ck_assert_msg(new_so_far || is_old || sequence->wear != FLASH_SOUND || sequence->first != FLASH_WELL,
                      "%s: motor %u: the new program, and the motor before it has the old one", where, i + 1);
        new_so_far = is_new;
    }
    ck_assert_msg(flash.misuse == 0, "%s: the store broke a rule of the flash", where);
}

/* What was cut must not hinder the next store. */
static void assert_stores_again(const char *where)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (asked_for(i + 1))
            unit.motor[i].program = start.new[i];
    int err = store_flash(sequence->motor);
    ck_assert_msg(err == 0 || sequence->wear != FLASH_SOUND, "%s: the next store failed", where);
    power_up();
    assert_old_or_new(err == 0, where);
}

static void describe(const struct cut *cut, char *where, size_t size)
{
    snprintf(where, size, "%s, motor %u: %s at %s %u, border %u, seed %u, flash %s", sequence->name, sequence->motor,
             flash_fault_name(cut->fault), cut->read > 0 ? "read" : "operation", cut->read > 0 ? cut->read : cut->operation,
             cut->border, (unsigned)cut->seed, flash_wear_name(sequence->wear));
}

static unsigned cut_and_restart(const struct cut *cut, char *where, size_t size)
{
    describe(cut, where, size);
    from_the_start(cut);
    bool failed, stored = do_stores(&failed);
    ck_assert_msg(flash.off, "%s: no cut", where);
    (*cuts)++;
    flash_fake_power_on(&flash);
    unsigned length = flash.length;
    power_up();
    assert_old_or_new(stored, where);
    return length;
}

unsigned power_cut(const struct cut *cut)
{
    char where[160];
    unsigned length = cut_and_restart(cut, where, sizeof where);
    assert_stores_again(where);
    return length;
}

void power_cut_and_stay(const struct cut *cut)
{
    char where[160];
    cut_and_restart(cut, where, sizeof where);
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        start.old[i] = unit.motor[i].program;
        make(&start.new[i], sequence->new, i + 1, 3);
    }
    begin();
}

void power_uncut(unsigned *operations, unsigned *reads)
{
    from_the_start(&(struct cut){0});
    bool failed, stored = do_stores(&failed);
    *operations = flash.operations;
    *reads = flash.reads;
    flash_fake_power_on(&flash);
    power_up();
    assert_old_or_new(stored, sequence->name);
    for (unsigned i = 0; i < RKM04_MOTORS && !stored && sequence->motor != 0; i++)
        ck_assert_msg(holds(i, &start.old[i]), "%s: refused, and yet stored", sequence->name);
    ck_assert(stored || failed);
}

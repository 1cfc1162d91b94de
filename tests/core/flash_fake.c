/* SPDX-License-Identifier: MIT */
#include "flash_fake.h"

#include <string.h>

void flash_fake_init(struct flash_fake *flash)
{
    memset(flash, 0, sizeof *flash);
    memset(flash->data, 0xff, sizeof flash->data);
}

void flash_fake_arm(struct flash_fake *flash, unsigned n, enum flash_fault fault, uint32_t seed)
{
    flash->operations = 0;
    flash->reads = 0;
    flash->fault_at[0] = n;
    flash->fault[0] = fault;
    flash->fault_at[1] = 0;
    flash->border = 0;
    flash->random = seed * 2654435761u + 1;
}

void flash_fake_arm_also(struct flash_fake *flash, unsigned n, enum flash_fault fault)
{
    flash->fault_at[1] = n;
    flash->fault[1] = fault;
}

void flash_fake_arm_read(struct flash_fake *flash, unsigned n)
{
    flash->reads = 0;
    flash->read_fault_at = n;
    flash->read_cuts = false;
}

void flash_fake_cut_at_read(struct flash_fake *flash, unsigned n)
{
    flash_fake_arm_read(flash, n);
    flash->read_cuts = true;
}

void flash_fake_power_on(struct flash_fake *flash)
{
    flash->off = false;
    flash->fault_at[0] = flash->fault_at[1] = 0;
    flash->read_fault_at = 0;
}

const char *flash_fault_name(enum flash_fault fault)
{
    static const char *const name[FLASH_FAULTS] = {
        "well",       "fail-nothing", "fail-torn", "fail-done",   "lie",      "cut-before",
        "cut-prefix", "cut-suffix",   "cut-bits",  "cut-garbage", "cut-zeros",
        "cut-flips",  "cut-after",
    };
    return (unsigned)fault < FLASH_FAULTS ? name[fault] : "?";
}

const char *flash_wear_name(enum flash_wear wear)
{
    static const char *const name[FLASH_WEARS] = {"sound", "no-erase", "half-erase", "no-program", "half-program", "stuck-cells"};
    return (unsigned)wear < FLASH_WEARS ? name[wear] : "?";
}

static uint32_t next_random(struct flash_fake *flash)
{
    flash->random = flash->random * 1664525u + 1013904223u;
    return flash->random >> 8;
}

/* What a range of `length` bytes becomes when an operation that would have made `wanted` of it goes wrong. */
static void change(struct flash_fake *flash, enum flash_fault fault, uint8_t *cell, const uint8_t *wanted, unsigned length)
{
    if (fault == FLASH_WELL || fault == FLASH_FAIL_DONE || fault == FLASH_CUT_FLIPS || fault == FLASH_CUT_AFTER) {
        memcpy(cell, wanted, length);
        return;
    }
    unsigned border = length > 1 ? 1 + next_random(flash) % (length - 1) : 0;
    if (flash->border > 0)
        border = flash->border;
    for (unsigned i = 0; i < length; i++) {
        switch (fault) {
        case FLASH_FAIL_NOTHING:
        case FLASH_CUT_BEFORE:
            break;
        case FLASH_CUT_PREFIX:
            if (i < border)
                cell[i] = wanted[i];
            break;
        case FLASH_CUT_SUFFIX:
            if (i >= border)
                cell[i] = wanted[i];
            break;
        case FLASH_FAIL_TORN:
        case FLASH_LIE:
        case FLASH_CUT_BITS:
            cell[i] = (uint8_t)(cell[i] ^ ((cell[i] ^ wanted[i]) & next_random(flash)));
            break;
        case FLASH_CUT_GARBAGE:
            cell[i] = (uint8_t)next_random(flash);
            break;
        case FLASH_CUT_ZEROS:
            if (i < border)
                cell[i] = 0;
            break;
        default:
            break;
        }
    }
}

/* Some bits of a block become wrong. */
static void flip(struct flash_fake *flash, unsigned block)
{
    for (unsigned left = 1 + next_random(flash) % 8; left > 0; left--) {
        unsigned bit = next_random(flash) % (8 * RKM04_FLASH_BLOCK_SIZE);
        flash->data[block][bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

/* What strikes at the present operation: an armed fault, else the wear of the block. */
static enum flash_fault due(const struct flash_fake *flash, unsigned block, bool erasing)
{
    for (int i = 0; i < 2; i++)
        if (flash->operations == flash->fault_at[i])
            return flash->fault[i];
    switch (flash->wear[block]) {
    case FLASH_NO_ERASE:
        return erasing ? FLASH_FAIL_NOTHING : FLASH_WELL;
    case FLASH_HALF_ERASE:
        return erasing ? FLASH_FAIL_TORN : FLASH_WELL;
    case FLASH_NO_PROGRAM:
        return erasing ? FLASH_WELL : FLASH_FAIL_NOTHING;
    case FLASH_HALF_PROGRAM:
        return erasing ? FLASH_WELL : FLASH_FAIL_TORN;
    default:
        return FLASH_WELL;
    }
}

/* Count an operation on a block, apply it with the fault that is due, if any. Returns what is reported to the caller. */
static int operate(struct flash_fake *flash, unsigned block, unsigned offset, const uint8_t *wanted, unsigned length,
                   bool erasing)
{
    flash->operations++;
    flash->length = length;
    enum flash_fault fault = due(flash, block, erasing);
    change(flash, fault, &flash->data[block][offset], wanted, length);
    if (fault == FLASH_CUT_FLIPS)
        flip(flash, block);
    for (unsigned i = 13; i < RKM04_FLASH_BLOCK_SIZE && flash->wear[block] == FLASH_STUCK_CELLS; i += 61)
        flash->data[block][i] &= (uint8_t)~(1u << i % 8);
    if (fault >= FLASH_CUT_BEFORE)
        flash->off = true;
    return fault != FLASH_WELL && fault != FLASH_LIE;
}

static int misuse(struct flash_fake *flash)
{
    flash->misuse++;
    return 1;
}

static bool inside(unsigned block, unsigned offset, unsigned length)
{
    return block < RKM04_FLASH_BLOCKS && offset <= RKM04_FLASH_BLOCK_SIZE && length <= RKM04_FLASH_BLOCK_SIZE - offset;
}

int flash_fake_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct flash_fake *flash = context;
    if (!inside(block, offset, length))
        return misuse(flash);
    flash->reads++;
    if (flash->off)
        return 1;
    if (flash->reads == flash->read_fault_at) {
        flash->off = flash->read_cuts;
        return 1;
    }
    memcpy(data, &flash->data[block][offset], length);
    return 0;
}

int flash_fake_erase(void *context, unsigned block)
{
    struct flash_fake *flash = context;
    if (block >= RKM04_FLASH_BLOCKS)
        return misuse(flash);
    if (flash->off)
        return 1;
    flash->erases[block]++;
    uint8_t erased[RKM04_FLASH_BLOCK_SIZE];
    memset(erased, 0xff, sizeof erased);
    int result = operate(flash, block, 0, erased, sizeof erased, true);
    /* What an erase left halfway has to be erased again before it is programmed, but the caller has to get an error. */
    bool whole = memcmp(flash->data[block], erased, sizeof erased) == 0;
    memset(flash->used[block], !whole && result != 0, sizeof flash->used[block]);
    return result;
}

int flash_fake_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct flash_fake *flash = context;
    if (!inside(block, offset, length) || offset % FLASH_FAKE_UNIT != 0 || length % FLASH_FAKE_UNIT != 0 || length == 0)
        return misuse(flash);
    if (flash->off)
        return 1;
    bool *used = &flash->used[block][offset / FLASH_FAKE_UNIT];
    for (unsigned i = 0; i < length / FLASH_FAKE_UNIT; i++)
        if (used[i])
            return misuse(flash);
    memset(used, true, length / FLASH_FAKE_UNIT);
    const uint8_t *cell = &flash->data[block][offset];
    uint8_t wanted[RKM04_FLASH_BLOCK_SIZE];
    for (unsigned i = 0; i < length; i++)
        wanted[i] = cell[i] & ((const uint8_t *)data)[i]; /* programming only makes 0 of 1 */
    return operate(flash, block, offset, wanted, length, false);
}

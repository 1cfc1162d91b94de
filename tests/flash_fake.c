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
    flash->fault_at = n;
    flash->fault = fault;
    flash->random = seed * 2654435761u + 1;
}

void flash_fake_arm_read(struct flash_fake *flash, unsigned n)
{
    flash->reads = 0;
    flash->read_fault_at = n;
}

void flash_fake_power_on(struct flash_fake *flash)
{
    flash->off = false;
    flash->fault_at = 0;
    flash->read_fault_at = 0;
}

const char *flash_fault_name(enum flash_fault fault)
{
    static const char *const name[FLASH_FAULTS] = {
        "well",       "fail-nothing", "fail-torn", "fail-done",   "lie",      "cut-before",
        "cut-prefix", "cut-suffix",   "cut-bits",  "cut-garbage", "cut-after",
    };
    return (unsigned)fault < FLASH_FAULTS ? name[fault] : "?";
}

static uint32_t next_random(struct flash_fake *flash)
{
    flash->random = flash->random * 1664525u + 1013904223u;
    return flash->random >> 8;
}

/* What a range of `length` bytes becomes when an operation that would have made `wanted` of it goes wrong. */
static void change(struct flash_fake *flash, enum flash_fault fault, uint8_t *cell, const uint8_t *wanted, unsigned length)
{
    unsigned border = length > 1 ? 1 + next_random(flash) % (length - 1) : 0;
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
        default:
            cell[i] = wanted[i];
            break;
        }
    }
}

/* Count an operation, apply it with the fault that is due, if any. Returns what the caller is told. */
static int operate(struct flash_fake *flash, uint8_t *cell, const uint8_t *wanted, unsigned length)
{
    enum flash_fault fault = flash->operations == flash->fault_at ? flash->fault : FLASH_WELL;
    change(flash, fault, cell, wanted, length);
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
    if (flash->off || flash->reads == flash->read_fault_at)
        return 1;
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
    flash->operations++;
    flash->erases[block]++;
    uint8_t erased[RKM04_FLASH_BLOCK_SIZE];
    memset(erased, 0xff, sizeof erased);
    int result = operate(flash, flash->data[block], erased, sizeof erased);
    /* What an erase left halfway has to be erased again before it is programmed, but the caller has to be told so. */
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
    flash->operations++;
    memset(used, true, length / FLASH_FAKE_UNIT);
    uint8_t *cell = &flash->data[block][offset], wanted[RKM04_FLASH_BLOCK_SIZE];
    for (unsigned i = 0; i < length; i++)
        wanted[i] = cell[i] & ((const uint8_t *)data)[i]; /* programming only makes 0 of 1 */
    return operate(flash, cell, wanted, length);
}

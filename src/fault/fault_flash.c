/* SPDX-License-Identifier: MIT */
/* Faults of the flash: operations that fail, and the power that goes in the middle of one. */
#include "fault_apply.h"

/* An operation done in part: of the bits that had to change some have. `data`: NULL for an erase. */
static void write_partly(struct faults *faults, unsigned unit, unsigned block, unsigned offset, const uint8_t *data,
                         unsigned length)
{
    uint8_t bytes[64];
    for (unsigned at = 0; at < length; at += sizeof bytes) {
        unsigned part = length - at < sizeof bytes ? length - at : (unsigned)sizeof bytes;
        if (faults->calls->flash_read(faults->context, unit, block, offset + at, bytes, part) != 0)
            return;
        for (unsigned i = 0; i < part; i++) {
            uint8_t goal = data ? data[at + i] : 0xff, some = (uint8_t)(faults_random(faults) >> 56);
            bytes[i] ^= (uint8_t)((bytes[i] ^ goal) & some);
        }
        if (faults->calls->flash_program(faults->context, unit, block, offset + at, bytes, part) != 0)
            return;
    }
}

static const char *name_of(enum fault_operation operation)
{
    return operation == FAULT_ERASE ? "an erase" : operation == FAULT_PROGRAM ? "a write" : "a read";
}

/* Returns whether an operation has been done completely; otherwise it has been done as far as the fault allows. */
static bool is_operation_done(struct faults *faults, unsigned unit, enum fault_operation operation, unsigned block,
                              unsigned offset, const void *data, unsigned length)
{
    struct fault *fault;
    if ((faults->dying >> unit & 1u) != 0)
        return false;
    if ((fault = fault_apply(faults, FAULT_POWER, unit, 0, operation))) {
        fault->victim = (uint8_t)unit;
        uint64_t now = segment_now(faults->segment);
        fault->ends = fault->ticks < DEVICE_NEVER - now ? now + fault->ticks : DEVICE_NEVER;
        faults->dying |= UINT32_C(1) << unit;
        fault_report(faults, fault, unit, "power is lost during %s of block %u", name_of(operation), block);
        write_partly(faults, unit, block, offset, data, length);
        return false;
    }
    if (!(fault = fault_apply(faults, FAULT_FLASH, unit, 0, operation)))
        return true;
    fault_report(faults, fault, unit, "%s of block %u fails", name_of(operation), block);
    if (fault->torn && operation != FAULT_READ)
        write_partly(faults, unit, block, offset, data, length);
    return false;
}

int faults_flash_read(struct faults *faults, unsigned unit, unsigned block, unsigned offset, void *data, unsigned length)
{
    bool done = is_operation_done(faults, unit, FAULT_READ, block, offset, NULL, length);
    return done ? faults->calls->flash_read(faults->context, unit, block, offset, data, length) : 1;
}

int faults_flash_erase(struct faults *faults, unsigned unit, unsigned block)
{
    unsigned size = segment_kind(faults->segment)->flash_block_size;
    bool done = is_operation_done(faults, unit, FAULT_ERASE, block, 0, NULL, size);
    return done ? faults->calls->flash_erase(faults->context, unit, block) : 1;
}

int faults_flash_program(struct faults *faults, unsigned unit, unsigned block, unsigned offset, const void *data,
                         unsigned length)
{
    bool done = is_operation_done(faults, unit, FAULT_PROGRAM, block, offset, data, length);
    return done ? faults->calls->flash_program(faults->context, unit, block, offset, data, length) : 1;
}

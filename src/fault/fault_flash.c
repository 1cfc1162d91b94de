/* SPDX-License-Identifier: MIT */
/* Faults of the flash: operations that fail, and the power that goes in the middle of one. */
#include "sim/sim.h"

/* An operation done in part: of the bits that had to change some have. `data`: NULL for an erase. */
static void tear(struct sim_unit *unit, unsigned block, unsigned offset, const uint8_t *data, unsigned length)
{
    struct faults *faults = &unit->sim->faults;
    uint8_t bytes[64];
    for (unsigned at = 0; at < length; at += sizeof bytes) {
        unsigned part = length - at < sizeof bytes ? length - at : (unsigned)sizeof bytes;
        if (sim_flash_read(unit, block, offset + at, bytes, part) != 0)
            return;
        for (unsigned i = 0; i < part; i++) {
            uint8_t goal = data ? data[at + i] : 0xff, some = (uint8_t)(faults_random(faults) >> 56);
            bytes[i] ^= (uint8_t)((bytes[i] ^ goal) & some);
        }
        if (sim_flash_program(unit, block, offset + at, bytes, part) != 0)
            return;
    }
}

static const char *name_of(enum fault_operation operation)
{
    return operation == FAULT_ERASE ? "an erase" : operation == FAULT_PROGRAM ? "a write" : "a read";
}

/* Does an operation go well? Otherwise it has been done as far as it gets. */
static bool goes_well(struct sim_unit *unit, enum fault_operation operation, unsigned block, unsigned offset, const void *data,
                      unsigned length)
{
    struct sim *sim = unit->sim;
    struct fault *fault;
    if ((sim->faults.dying >> unit->number & 1u) != 0)
        return false;
    if ((fault = fault_acts(sim, FAULT_POWER, unit->number, 0, operation))) {
        fault->victim = (uint8_t)unit->number;
        fault->ends = fault->ticks < RKM04_NEVER - sim_now(sim) ? sim_now(sim) + fault->ticks : RKM04_NEVER;
        sim->faults.dying |= UINT32_C(1) << unit->number;
        fault_tell(sim, fault, unit->number, "the power goes during %s of block %u", name_of(operation), block);
        tear(unit, block, offset, data, length);
        return false;
    }
    if (!(fault = fault_acts(sim, FAULT_FLASH, unit->number, 0, operation)))
        return true;
    fault_tell(sim, fault, unit->number, "%s of block %u fails", name_of(operation), block);
    if (fault->torn && operation != FAULT_READ)
        tear(unit, block, offset, data, length);
    return false;
}

int faults_flash_read(struct sim_unit *unit, unsigned block, unsigned offset, void *data, unsigned length)
{
    return goes_well(unit, FAULT_READ, block, offset, NULL, length) ? sim_flash_read(unit, block, offset, data, length) : 1;
}

int faults_flash_erase(struct sim_unit *unit, unsigned block)
{
    return goes_well(unit, FAULT_ERASE, block, 0, NULL, RKM04_FLASH_BLOCK_SIZE) ? sim_flash_erase(unit, block) : 1;
}

int faults_flash_program(struct sim_unit *unit, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return goes_well(unit, FAULT_PROGRAM, block, offset, data, length) ? sim_flash_program(unit, block, offset, data, length) : 1;
}

/* SPDX-License-Identifier: MIT */
/* The flash of a unit: what the config has, or memory. */
#include <stdlib.h>
#include <string.h>

#include "sim.h"

/* The memory is there once something has been written, and holds every byte inverted: what has not been is 0. */
static void invert(uint8_t *to, const uint8_t *from, unsigned length)
{
    for (unsigned i = 0; i < length; i++)
        to[i] = (uint8_t)~from[i];
}

static const struct device_kind *device_of(const struct sim_unit *unit)
{
    return segment_kind(&unit->sim->segment);
}

static uint8_t *memory_of(struct sim_unit *unit)
{
    if (!unit->memory)
        unit->memory = calloc(device_of(unit)->flash_blocks, device_of(unit)->flash_block_size);
    return unit->memory;
}

static bool within(const struct sim_unit *unit, unsigned block, unsigned offset, unsigned length)
{
    unsigned size = device_of(unit)->flash_block_size;
    return block < device_of(unit)->flash_blocks && offset <= size && length <= size - offset;
}

int sim_flash_read(struct sim_unit *unit, unsigned block, unsigned offset, void *data, unsigned length)
{
    const struct sim_flash *flash = &unit->sim->config.flash;
    if (flash->read)
        return flash->read(flash->context, unit->number, block, offset, data, length);
    if (!within(unit, block, offset, length))
        return 1;
    if (!unit->memory)
        memset(data, 0xFF, length);
    else
        invert(data, unit->memory + block * device_of(unit)->flash_block_size + offset, length);
    return 0;
}

int sim_flash_erase(struct sim_unit *unit, unsigned block)
{
    const struct sim_flash *flash = &unit->sim->config.flash;
    if (flash->erase)
        return flash->erase(flash->context, unit->number, block);
    if (!within(unit, block, 0, device_of(unit)->flash_block_size) || !memory_of(unit))
        return 1;
    memset(unit->memory + block * device_of(unit)->flash_block_size, 0, device_of(unit)->flash_block_size);
    return 0;
}

int sim_flash_program(struct sim_unit *unit, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const struct sim_flash *flash = &unit->sim->config.flash;
    if (flash->program)
        return flash->program(flash->context, unit->number, block, offset, data, length);
    if (!within(unit, block, offset, length) || !memory_of(unit))
        return 1;
    invert(unit->memory + block * device_of(unit)->flash_block_size + offset, data, length);
    return 0;
}

bool sim_flash_fill(struct sim_unit *unit)
{
    const struct sim_config *config = &unit->sim->config;
    if (!config->flash_image || config->flash.read)
        return true;
    if (!memory_of(unit))
        return false;
    invert(unit->memory, config->flash_image, device_of(unit)->flash_blocks * device_of(unit)->flash_block_size);
    return true;
}

void sim_store(struct sim *sim)
{
    const struct device_kind *kind = sim_device(sim); /* NULL: it has not begun */
    for (unsigned number = 1; kind && kind->end && number <= sim_units(sim); number++)
        if (sim_powered(sim, number))
            kind->end(sim_core(sim, number));
}

/* SPDX-License-Identifier: MIT */
#include "pmc_store.h"

#include "crc32.h"
#include "pmc_report.h"

/* A record, one to a block, two blocks an axis; numbers are little endian:
 *
 *     offset  bytes
 *          0      4  "PMCS"
 *          4      1  version of this format: 1
 *          5      1  axis: 0, 1
 *          6      2  FF
 *          8      4  generation, one more with each store
 *         12      4  CRC-32 over bytes 0..11 and all from 16 on
 *         16   4*22  parameters, in the order of enum pmc_parameter
 *        104  11*64  registers: value (4 bytes), ms (2), op, speed, argument, number, wait
 *
 * Order of a store, always in the block that does not hold the newest whole record: erase, all but the header, header, read all
 * back. The record begins to count with the last byte of its header; until then the other block does. */
#define VERSION 1
#define HEADER_SIZE 16u
#define CHECKED_SIZE 12u /* bytes of the header under the check value */
#define NUMBER_SIZE 4u
#define COMMAND_SIZE 11u
#define ITEMS (PMC_PARAMETERS + PMC_REGISTERS)
#define BODY_SIZE (NUMBER_SIZE * PMC_PARAMETERS + COMMAND_SIZE * PMC_REGISTERS)
#define CHUNK_SIZE 88u /* 22 parameters, or 8 registers */
#define COMMANDS_OF_CHUNK (CHUNK_SIZE / COMMAND_SIZE)

_Static_assert(CHUNK_SIZE == NUMBER_SIZE * PMC_PARAMETERS && CHUNK_SIZE % COMMAND_SIZE == 0, "chunks are whole");
_Static_assert(CHUNK_SIZE % 8 == 0 && HEADER_SIZE % 8 == 0, "programs are aligned");
_Static_assert(HEADER_SIZE + BODY_SIZE <= PMC_FLASH_BLOCK_SIZE && BODY_SIZE % CHUNK_SIZE == 0, "a record fits");

static void put32(uint8_t *at, uint32_t value)
{
    for (unsigned i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

static uint32_t get32(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static unsigned block_of(const struct pmc_unit *unit, const struct pmc_axis *axis, unsigned half)
{
    return 2 * pmc_index(unit, axis) + half;
}

/* ---- Contents ------------------------------------------------------------------------------------------------------ */

static void put_command(uint8_t *at, const struct pmc_command *command)
{
    put32(at, (uint32_t)command->value);
    at[4] = (uint8_t)command->ms;
    at[5] = (uint8_t)(command->ms >> 8);
    at[6] = command->op;
    at[7] = command->speed;
    at[8] = command->argument;
    at[9] = command->number;
    at[10] = command->wait;
}

static struct pmc_command get_command(const uint8_t *at)
{
    return (struct pmc_command){.value = (int32_t)get32(at),
                                .ms = (uint16_t)(at[4] | at[5] << 8),
                                .op = at[6],
                                .speed = at[7],
                                .argument = at[8],
                                .number = at[9],
                                .wait = at[10] != 0};
}

/* Chunk 0 are the parameters, the others registers. */
static void put_chunk(uint8_t bytes[CHUNK_SIZE], const struct pmc_axis *axis, unsigned chunk)
{
    if (chunk == 0)
        for (unsigned i = 0; i < PMC_PARAMETERS; i++)
            put32(bytes + NUMBER_SIZE * i, (uint32_t)axis->parameters.value[i]);
    else
        for (unsigned i = 0; i < COMMANDS_OF_CHUNK; i++)
            put_command(bytes + COMMAND_SIZE * i, &axis->program[COMMANDS_OF_CHUNK * (chunk - 1) + i]);
}

/* Returns false if it is no legal one. */
static bool get_chunk(const uint8_t bytes[CHUNK_SIZE], struct pmc_axis *axis, unsigned chunk)
{
    bool legal = true;
    if (chunk == 0) {
        for (unsigned i = 0; i < PMC_PARAMETERS; i++) {
            const int32_t value = (int32_t)get32(bytes + NUMBER_SIZE * i);
            legal = legal && value >= pmc_parameter_rows[i].low && value <= pmc_parameter_rows[i].high;
            axis->parameters.value[i] = value;
        }
        return legal;
    }
    for (unsigned i = 0; i < COMMANDS_OF_CHUNK; i++) {
        struct pmc_command *command = &axis->program[COMMANDS_OF_CHUNK * (chunk - 1) + i];
        *command = get_command(bytes + COMMAND_SIZE * i);
        legal = legal && pmc_command_valid(command);
    }
    return legal;
}

#define CHUNKS (BODY_SIZE / CHUNK_SIZE)

/* ---- Records ------------------------------------------------------------------------------------------------------- */

static void put_header(uint8_t bytes[HEADER_SIZE], const struct pmc_unit *unit, const struct pmc_axis *axis, uint32_t generation)
{
    const uint8_t begin[] = {'P', 'M', 'C', 'S', VERSION, (uint8_t)pmc_index(unit, axis)};
    for (unsigned i = 0; i < HEADER_SIZE; i++)
        bytes[i] = i < sizeof begin ? begin[i] : 0xFF;
    put32(bytes + 8, generation);
}

/* Read from a block, once more if that fails: a block passed over for a disturbance would be the next to be erased, whatever it
 * holds. */
static bool read_block(const struct pmc_unit *unit, unsigned block, unsigned offset, uint8_t *bytes, unsigned length)
{
    return unit->port->flash_read(unit->context, block, offset, bytes, length) == 0 ||
           unit->port->flash_read(unit->context, block, offset, bytes, length) == 0;
}

/* Is there a whole record? Then *generation is set, and with `into` the axis has its contents. */
static bool read_record(const struct pmc_unit *unit, const struct pmc_axis *axis, unsigned half, uint32_t *generation,
                        struct pmc_axis *into)
{
    uint8_t header[HEADER_SIZE], expected[HEADER_SIZE], bytes[CHUNK_SIZE];
    const unsigned block = block_of(unit, axis, half);
    if (!read_block(unit, block, 0, header, HEADER_SIZE))
        return false;
    *generation = get32(header + 8);
    put_header(expected, unit, axis, *generation);
    bool legal = true;
    for (unsigned i = 0; i < CHECKED_SIZE; i++)
        legal = legal && header[i] == expected[i];
    if (!legal)
        return false;
    uint32_t check = crc32_update(0, header, CHECKED_SIZE);
    for (unsigned chunk = 0; chunk < CHUNKS; chunk++) {
        if (!read_block(unit, block, HEADER_SIZE + CHUNK_SIZE * chunk, bytes, CHUNK_SIZE))
            return false;
        check = crc32_update(check, bytes, CHUNK_SIZE);
        if (into)
            legal = get_chunk(bytes, into, chunk) && legal;
    }
    return legal && check == get32(header + 12);
}

/* Is generation a newer than b? They count on through 0. */
static bool is_newer(uint32_t a, uint32_t b)
{
    return a - b < UINT32_C(0x80000000);
}

/* Which half has the newest whole record; -1: none. */
static int newest_half(const struct pmc_unit *unit, const struct pmc_axis *axis, uint32_t *generation)
{
    uint32_t found[2];
    const bool first = read_record(unit, axis, 0, &found[0], NULL), second = read_record(unit, axis, 1, &found[1], NULL);
    const int half = !first && !second ? -1 : second && (!first || is_newer(found[1], found[0]));
    *generation = half < 0 ? 0 : found[half];
    return half;
}

/* Returns false if the record does not stand there as it should. */
static bool write_record(const struct pmc_unit *unit, const struct pmc_axis *axis, unsigned half, uint32_t generation)
{
    const struct pmc_port *port = unit->port;
    const unsigned block = block_of(unit, axis, half);
    uint8_t header[HEADER_SIZE], bytes[CHUNK_SIZE];
    uint32_t found;
    put_header(header, unit, axis, generation);
    uint32_t check = crc32_update(0, header, CHECKED_SIZE);
    if (port->flash_erase(unit->context, block) != 0)
        return false;
    for (unsigned chunk = 0; chunk < CHUNKS; chunk++) {
        put_chunk(bytes, axis, chunk);
        check = crc32_update(check, bytes, CHUNK_SIZE);
        if (port->flash_program(unit->context, block, HEADER_SIZE + CHUNK_SIZE * chunk, bytes, CHUNK_SIZE) != 0)
            return false;
    }
    put32(header + 12, check);
    if (port->flash_program(unit->context, block, 0, header, HEADER_SIZE) == 0 &&
        read_record(unit, axis, half, &found, NULL) && found == generation)
        return true;
    /* A store that was reported as failed must not be there after the next power-up. */
    (void)port->flash_erase(unit->context, block);
    return false;
}

bool pmc_store_save(const struct pmc_unit *unit, const struct pmc_axis *axis)
{
    const struct pmc_port *port = unit->port;
    uint32_t generation;
    if (!port->flash_read || !port->flash_erase || !port->flash_program)
        return false;
    const int newest = newest_half(unit, axis, &generation);
    return write_record(unit, axis, newest == 0, generation + 1);
}

static void clear(struct pmc_axis *axis)
{
    pmc_parameters_clear(&axis->parameters);
    for (unsigned i = 0; i < PMC_REGISTERS; i++)
        axis->program[i] = (struct pmc_command){.op = PMC_NOP};
}

void pmc_store_load(const struct pmc_unit *unit, struct pmc_axis *axis)
{
    uint32_t generation;
    clear(axis);
    if (!unit->port->flash_read)
        return;
    const int newest = newest_half(unit, axis, &generation);
    /* What could be read a moment ago and now cannot: the other record is better than none. */
    if (newest >= 0 && !read_record(unit, axis, (unsigned)newest, &generation, axis) &&
        !read_record(unit, axis, !newest, &generation, axis))
        clear(axis);
}

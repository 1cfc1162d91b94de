/* SPDX-License-Identifier: MIT */
#include "store.h"

#include "crc32.h"
#include "program.h"

/* A record, one to a block; numbers are little endian:
 *
 *     offset  bytes
 *          0      4  "RK4P"
 *          4      1  version of this format: 1
 *          5      1  motor 1..4
 *          6      2  number of commands 0..700
 *          8      4  generation, one more with each store
 *         12      4  CRC-32 over bytes 0..11 and the commands
 *         16    5*n  commands, the oldest first: op, argument (4 bytes)
 *                    FF up to a multiple of 8
 *
 * Order of a store, always in the block that does not hold the newest whole record: erase, commands, header, read all back.
 * The record begins to count with the last byte of its header; until then the other block does. */
#define VERSION 1
#define HEADER_SIZE 16
#define CHECKED_SIZE 12 /* bytes of the header under the check value */
#define COMMAND_SIZE 5
#define CHUNK_COMMANDS 16 /* their bytes are a multiple of 8 */
#define CHUNK_SIZE (CHUNK_COMMANDS * COMMAND_SIZE)
#define UNIT 8 /* bytes that a flash programs together */
#define ERASED 0xff

static const uint8_t magic[4] = {'R', 'K', '4', 'P'};

_Static_assert(CHUNK_SIZE % UNIT == 0 && HEADER_SIZE % UNIT == 0, "programs are aligned");
_Static_assert(HEADER_SIZE + COMMAND_SIZE * RKM04_PROGRAM_MAX + UNIT <= RKM04_FLASH_BLOCK_SIZE, "a full memory fits a block");

/* Where a slot is. */
struct slot {
    const struct rkm04_port *port;
    void *context;
    unsigned motor;
};

struct header {
    uint16_t count;
    uint32_t generation;
    uint32_t check;
};

enum content {
    CONTENT_BLANK,  /* the header was never written */
    CONTENT_RECORD, /* a whole record */
    CONTENT_BROKEN  /* anything else; also what cannot be read, as some flashes refuse to read what a power cut left torn */
};

/* What the two blocks of a slot hold. */
struct survey {
    enum content content[2];
    struct header header[2];
    int newest; /* 0 or 1; -1: no whole record */
};

static void put16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

static void put32(uint8_t *at, uint32_t value)
{
    put16(at, (uint16_t)value);
    put16(at + 2, (uint16_t)(value >> 16));
}

static uint16_t get16(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static uint32_t get32(const uint8_t *at)
{
    return get16(at) | (uint32_t)get16(at + 2) << 16;
}

static void put_header(uint8_t *at, unsigned motor, const struct header *header)
{
    for (unsigned i = 0; i < sizeof magic; i++)
        at[i] = magic[i];
    at[4] = VERSION;
    at[5] = (uint8_t)motor;
    put16(at + 6, header->count);
    put32(at + 8, header->generation);
    put32(at + 12, header->check);
}

static enum content get_header(const uint8_t *at, unsigned motor, struct header *header)
{
    unsigned blank = 0;
    while (blank < HEADER_SIZE && at[blank] == ERASED)
        blank++;
    if (blank == HEADER_SIZE)
        return CONTENT_BLANK;
    for (unsigned i = 0; i < sizeof magic; i++)
        if (at[i] != magic[i])
            return CONTENT_BROKEN;
    *header = (struct header){get16(at + 6), get32(at + 8), get32(at + 12)};
    return at[4] == VERSION && at[5] == motor && header->count <= RKM04_PROGRAM_MAX ? CONTENT_RECORD : CONTENT_BROKEN;
}

static unsigned block_of(const struct slot *slot, int half)
{
    return 2 * (slot->motor - 1) + (unsigned)half;
}

/* Can this command be in a memory? `\`, K and C75 are executed at once and never stored. */
static bool is_storable(struct rkm04_command command)
{
    return rkm04_command_valid(command) && command.op != '\\' && command.op != 'K' &&
           !(command.op == 'C' && command.argument == 75);
}

/* Read from a block, once more if that fails: a block passed over for a disturbance would be the next to be erased, whatever it
 * holds. Returns 0 or 1. */
static int read_block(const struct slot *slot, unsigned block, unsigned offset, uint8_t *bytes, unsigned length)
{
    for (unsigned tries = 2; tries > 0; tries--)
        if (slot->port->flash_read(slot->context, block, offset, bytes, length) == 0)
            return 0;
    return 1;
}

/* Read the commands of a record, continue with the check value over them, and append them to `program` unless it is NULL.
 * Returns CONTENT_RECORD if all of them are commands. */
static enum content read_commands(const struct slot *slot, unsigned block, unsigned count, uint32_t *check,
                                  struct rkm04_program *program)
{
    uint8_t bytes[CHUNK_SIZE];
    for (unsigned done = 0; done < count;) {
        unsigned now = count - done < CHUNK_COMMANDS ? count - done : CHUNK_COMMANDS;
        unsigned offset = HEADER_SIZE + done * COMMAND_SIZE;
        if (read_block(slot, block, offset, bytes, now * COMMAND_SIZE) != 0)
            return CONTENT_BROKEN;
        *check = crc32_update(*check, bytes, now * COMMAND_SIZE);
        for (unsigned i = 0; i < now; i++) {
            const uint8_t *at = bytes + i * COMMAND_SIZE;
            struct rkm04_command command = {at[0], get32(at + 1)};
            if (!is_storable(command))
                return CONTENT_BROKEN;
            if (program)
                program_append(program, command);
        }
        done += now;
    }
    return CONTENT_RECORD;
}

/* Check one block. With CONTENT_RECORD *header is set and `program`, unless it is NULL, holds the commands. */
static enum content read_record(const struct slot *slot, unsigned block, struct header *header, struct rkm04_program *program)
{
    uint8_t bytes[HEADER_SIZE];
    if (read_block(slot, block, 0, bytes, HEADER_SIZE) != 0)
        return CONTENT_BROKEN;
    enum content content = get_header(bytes, slot->motor, header);
    if (content != CONTENT_RECORD)
        return content;
    uint32_t check = crc32_update(0, bytes, CHECKED_SIZE);
    content = read_commands(slot, block, header->count, &check, program);
    if (content != CONTENT_RECORD)
        return content;
    return check == header->check ? CONTENT_RECORD : CONTENT_BROKEN;
}

/* Is generation a newer than b? They count on through 0. */
static bool is_newer(uint32_t a, uint32_t b)
{
    uint32_t ahead = a - b;
    return ahead != 0 && ahead < UINT32_C(0x80000000);
}

static void survey_slot(const struct slot *slot, struct survey *survey)
{
    survey->newest = -1;
    for (int half = 0; half < 2; half++) {
        survey->content[half] = read_record(slot, block_of(slot, half), &survey->header[half], NULL);
        if (survey->content[half] != CONTENT_RECORD)
            continue;
        if (survey->newest < 0 || is_newer(survey->header[half].generation, survey->header[survey->newest].generation))
            survey->newest = half;
    }
}

/* Bytes of the commands from the n-th oldest on, up to CHUNK_COMMANDS of them. Returns the number of bytes. */
static unsigned put_commands(uint8_t *bytes, const struct rkm04_program *program, unsigned n)
{
    uint64_t oldest = program_oldest(program);
    unsigned count = program_count(program), length = 0;
    for (unsigned i = n; i < count && i < n + CHUNK_COMMANDS; i++) {
        struct rkm04_command command = program_at(program, oldest + i);
        bytes[length] = command.op;
        put32(bytes + length + 1, command.argument);
        length += COMMAND_SIZE;
    }
    return length;
}

/* Continue with the check value over the commands of a memory. */
static uint32_t check_commands(uint32_t check, const struct rkm04_program *program)
{
    uint8_t bytes[CHUNK_SIZE];
    for (unsigned n = 0; n < program_count(program); n += CHUNK_COMMANDS)
        check = crc32_update(check, bytes, put_commands(bytes, program, n));
    return check;
}

/* Write the commands of a memory to an erased block. Returns 0 or 1. */
static int write_commands(const struct slot *slot, unsigned block, const struct rkm04_program *program)
{
    uint8_t bytes[CHUNK_SIZE];
    for (unsigned n = 0; n < program_count(program); n += CHUNK_COMMANDS) {
        unsigned length = put_commands(bytes, program, n);
        while (length % UNIT != 0)
            bytes[length++] = ERASED;
        if (slot->port->flash_program(slot->context, block, HEADER_SIZE + n * COMMAND_SIZE, bytes, length) != 0)
            return 1;
    }
    return 0;
}

/* Erase a block and write a record there. Returns 0, or 1 if it is not there as it should be; then no record is, as
 * far as the flash works. */
static int write_record(const struct slot *slot, unsigned block, uint32_t generation, const struct rkm04_program *program)
{
    uint8_t bytes[HEADER_SIZE];
    struct header header = {(uint16_t)program_count(program), generation, 0}, found;
    put_header(bytes, slot->motor, &header);
    header.check = check_commands(crc32_update(0, bytes, CHECKED_SIZE), program);
    put_header(bytes, slot->motor, &header);

    if (slot->port->flash_erase(slot->context, block) != 0 || write_commands(slot, block, program) != 0)
        return 1;
    if (slot->port->flash_program(slot->context, block, 0, bytes, HEADER_SIZE) == 0 &&
        read_record(slot, block, &found, NULL) == CONTENT_RECORD && found.check == header.check &&
        found.generation == generation)
        return 0;
    /* A store that was reported as failed must not leave its program there after the next power-up. */
    (void)slot->port->flash_erase(slot->context, block);
    return 1;
}

int store_save(const struct rkm04_port *port, void *context, unsigned motor, const struct rkm04_program *program)
{
    if (!port->flash_read || !port->flash_erase || !port->flash_program)
        return 1;
    struct slot slot = {port, context, motor};
    struct survey survey;
    survey_slot(&slot, &survey);
    int target = survey.newest == 0;
    uint32_t generation = survey.newest < 0 ? 1 : survey.header[survey.newest].generation + 1;
    return write_record(&slot, block_of(&slot, target), generation, program);
}

enum rkm04_slot store_load(const struct rkm04_port *port, void *context, unsigned motor, struct rkm04_program *program)
{
    program_clear(program);
    if (!port->flash_read)
        return RKM04_SLOT_EMPTY;
    struct slot slot = {port, context, motor};
    struct survey survey;
    survey_slot(&slot, &survey);
    if (survey.newest < 0) {
        bool blank = survey.content[0] == CONTENT_BLANK && survey.content[1] == CONTENT_BLANK;
        return blank ? RKM04_SLOT_EMPTY : RKM04_SLOT_UNTRUSTED;
    }
    /* Whatever could be read a moment ago and now cannot: the other record is better than none. */
    for (int half = survey.newest, left = 2; left > 0; half = !half, left--) {
        struct header header;
        if (survey.content[half] != CONTENT_RECORD)
            continue;
        if (read_record(&slot, block_of(&slot, half), &header, program) == CONTENT_RECORD)
            return header.count > 0 ? RKM04_SLOT_LOADED : RKM04_SLOT_EMPTY;
        program_clear(program);
    }
    return RKM04_SLOT_UNTRUSTED;
}

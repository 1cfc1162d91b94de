/* SPDX-License-Identifier: MIT */
/* fuzz_flash.c: flash images at power-up (U5). Bytes of records come from the input; header, check value and generation are
 * put right unless the input says otherwise, so that it gets as far as the commands. A slot holds a whole program of valid
 * commands or none; the unit runs; what it stores then is there after the next power-up, and it never breaks the other slots. */
#include <string.h>

#include "crc32.h"
#include "fuzz.h"
#include "program.h"

static uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
static struct rkm04_unit unit, second;

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS && offset + length <= RKM04_FLASH_BLOCK_SIZE, "%u %u %u", block, offset, length);
    memcpy(data, &flash[block][offset], length);
    return 0;
}

static int flash_erase(void *context, unsigned block)
{
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS, "%u", block);
    memset(flash[block], 0xff, sizeof flash[block]);
    return 0;
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const uint8_t *bytes = data;
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS && offset + length <= RKM04_FLASH_BLOCK_SIZE, "%u %u %u", block, offset, length);
    for (unsigned i = 0; i < length; i++) {
        FUZZ_CHECK(flash[block][offset + i] == 0xff, "byte %u of block %u is not erased", offset + i, block);
        flash[block][offset + i] = bytes[i];
    }
    return 0;
}

static const struct rkm04_port port = {.flash_read = flash_read, .flash_erase = flash_erase, .flash_program = flash_program};

static void put32(uint8_t *at, uint32_t value)
{
    for (unsigned i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

/* A command that may be stored, most of the time. */
static void make_command(struct fuzz *fuzz, uint8_t *at)
{
    static const char ops[] = "@ABCDEFGHIJLMNORSTUVWXYZ)(='.[]";
    uint8_t choice = fuzz_byte(fuzz);
    uint32_t argument = fuzz_byte(fuzz);
    at[0] = choice == 255 ? fuzz_byte(fuzz) : (uint8_t)ops[choice % (sizeof ops - 1)];
    if (strchr("DEHRUY.[]", at[0]))
        argument = choice >= 224 ? argument : 0;
    else if (at[0] == 'I')
        argument = (argument & 7) + 1 + ((argument >> 3 & 1) << 8) + (((argument >> 4) + 1) << 16);
    else if (strchr("ABFGSVW=", at[0]))
        argument |= (uint32_t)fuzz_byte(fuzz) << 8;
    put32(at + 1, argument);
}

/* One block: flags, count, generation, then commands. Flags: 1 as it comes, 2 erased, 4 wrong check value, 8 wrong motor,
 * 16 wrong version, 32 the last byte is missing. */
static void make_block(struct fuzz *fuzz, unsigned block)
{
    uint8_t *at = flash[block], flags = fuzz_byte(fuzz);
    uint32_t count, generation, check;
    size_t length;
    if (flags & 2)
        return;
    if (flags & 1) {
        const uint8_t *bytes = fuzz_take(fuzz, fuzz_byte(fuzz), &length);
        memcpy(at, bytes, length);
        return;
    }
    count = flags & 64 ? fuzz_number(fuzz, 2) % 710 : fuzz_byte(fuzz) & 15;
    generation = flags & 128 ? fuzz_number(fuzz, 4) : fuzz_byte(fuzz);
    memcpy(at, "RK4P\1", 5);
    at[4] = (uint8_t)(at[4] + (flags >> 4 & 1));
    at[5] = (uint8_t)(block / 2 + 1 + (flags >> 3 & 1));
    at[6] = (uint8_t)count;
    at[7] = (uint8_t)(count >> 8);
    put32(at + 8, generation);
    for (uint32_t i = 0; i < count; i++)
        make_command(fuzz, at + 16 + 5 * (size_t)i);
    check = crc32_update(crc32_update(0, at, 12), at + 16, 5 * (size_t)count);
    put32(at + 12, check + (flags >> 2 & 1));
    if (flags & 32)
        at[16 + 5 * (size_t)count - 1] = 0xff;
}

static bool same_program(const struct rkm04_program *a, const struct rkm04_program *b)
{
    unsigned count = program_count(a);
    if (program_count(b) != count)
        return false;
    for (unsigned i = 0; i < count; i++) {
        struct rkm04_command x = program_at(a, program_oldest(a) + i), y = program_at(b, program_oldest(b) + i);
        if (x.op != y.op || x.argument != y.argument)
            return false;
    }
    return true;
}

static void check_loaded(const struct rkm04_unit *loaded)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        const struct rkm04_program *program = &loaded->motor[i].program;
        FUZZ_CHECK(loaded->motor[i].slot == RKM04_SLOT_LOADED || program_count(program) == 0, "motor %u", i + 1);
        for (unsigned k = 0; k < program_count(program); k++) {
            struct rkm04_command command = program_at(program, program_oldest(program) + k);
            FUZZ_CHECK(rkm04_command_valid(command) && !strchr("\\K", command.op) &&
                           (command.op != 'C' || command.argument != 75), "motor %u: %c", i + 1, command.op);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    struct rkm04_config config = {.node = 1};
    uint8_t answer[8], store = fuzz_byte(&fuzz);
    memset(flash, 0xff, sizeof flash);
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS && fuzz.left > 0; block++)
        make_block(&fuzz, block);
    rkm04_init(&unit, &config, &port, NULL);
    check_loaded(&unit);
    rkm04_advance(&unit, (uint64_t)(store & 15) * 7001);
    if (store & 16)
        rkm04_set_command(&unit, (char)('0' + (store >> 5) % 5), "F5 R", 4, NULL);
    uint8_t motor = (uint8_t)('0' + (store >> 4) % 5);
    FUZZ_CHECK(rkm04_exchange(&unit, (const uint8_t[]){3, motor}, 2, answer, sizeof answer) == 3 && answer[2] == 0,
               "storing %c fails with %u", motor, answer[2]);
    second = unit;
    rkm04_init(&unit, &config, &port, NULL);
    check_loaded(&unit);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (motor == '0' || motor == '1' + (int)i)
            FUZZ_CHECK(same_program(&second.motor[i].program, &unit.motor[i].program), "motor %u has another program", i + 1);
        else
            FUZZ_CHECK(second.motor[i].slot == unit.motor[i].slot, "motor %u: the slot is another", i + 1);
    return 0;
}

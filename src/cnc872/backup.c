/* SPDX-License-Identifier: MIT */
/* backup.c: the backup memory in flash (NO3). Two images by turns: the one with the higher number that is whole counts, so that a
 * power cut leaves the old content or the new one. An image is a head, then the bytes. */
#include "backup.h"

#include <string.h>

#include "crc32.h"

#define MAGIC UINT32_C(0x434E4342) /* "BCNC" */
#define HEAD 16u                   /* magic, number, size, check value of these and the bytes */
#define IMAGE_BLOCKS (CNC_BACKUP_BLOCKS / 2u)

_Static_assert(HEAD + CNC_BACKUP_SIZE <= IMAGE_BLOCKS * CNC_BACKUP_BLOCK, "an image fits its blocks");

static uint32_t word_at(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    for (unsigned i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(word >> (8 * i));
}

static uint32_t check_of(const uint8_t *head, const uint8_t *bytes)
{
    return crc32_update(crc32_update(0, head, HEAD - 4u), bytes, CNC_BACKUP_SIZE);
}

/* Where the bytes of an image from number `done` on are. Returns how many of them are in that block. */
static unsigned find_piece(unsigned done, unsigned *block, unsigned *offset)
{
    const unsigned left = CNC_BACKUP_SIZE - done;
    *block = (HEAD + done) / CNC_BACKUP_BLOCK;
    *offset = (HEAD + done) % CNC_BACKUP_BLOCK;
    return CNC_BACKUP_BLOCK - *offset < left ? CNC_BACKUP_BLOCK - *offset : left;
}

static bool read_bytes(const struct cnc_flash *flash, unsigned image, uint8_t bytes[CNC_BACKUP_SIZE])
{
    for (unsigned done = 0, length; done < CNC_BACKUP_SIZE; done += length) {
        unsigned block, offset;
        length = find_piece(done, &block, &offset);
        if (flash->read(flash->context, image * IMAGE_BLOCKS + block, offset, bytes + done, length) != 0)
            return false;
    }
    return true;
}

static bool program_bytes(const struct cnc_flash *flash, unsigned image, const uint8_t bytes[CNC_BACKUP_SIZE])
{
    for (unsigned done = 0, length; done < CNC_BACKUP_SIZE; done += length) {
        unsigned block, offset;
        length = find_piece(done, &block, &offset);
        if (flash->program(flash->context, image * IMAGE_BLOCKS + block, offset, bytes + done, length) != 0)
            return false;
    }
    return true;
}

/* Reads an image; true if it is whole, then *number is its number. */
static bool read_image(const struct cnc_flash *flash, unsigned image, uint8_t bytes[CNC_BACKUP_SIZE], uint32_t *number)
{
    uint8_t head[HEAD];
    if (flash->read(flash->context, image * IMAGE_BLOCKS, 0, head, HEAD) != 0 || word_at(head) != MAGIC ||
        word_at(head + 8) != CNC_BACKUP_SIZE || !read_bytes(flash, image, bytes))
        return false;
    *number = word_at(head + 4);
    return word_at(head + 12) == check_of(head, bytes);
}

bool cnc_backup_load(const struct cnc_flash *flash, uint8_t bytes[CNC_BACKUP_SIZE], uint32_t *number)
{
    uint32_t first = 0, second = 0;
    const bool has_first = read_image(flash, 0, bytes, &first), has_second = read_image(flash, 1, bytes, &second);
    const bool is_second = has_second && (!has_first || (int32_t)(second - first) > 0);
    *number = is_second ? second : has_first ? first : 0;
    if (!is_second && has_first)
        return read_image(flash, 0, bytes, &first);
    if (!is_second)
        memset(bytes, 0, CNC_BACKUP_SIZE);
    return is_second;
}

bool cnc_backup_store(const struct cnc_flash *flash, const uint8_t bytes[CNC_BACKUP_SIZE], uint32_t *number)
{
    uint8_t head[HEAD];
    const unsigned image = (*number + 1u) & 1u; /* not the one that counts */
    put_word(head, MAGIC);
    put_word(head + 4, *number + 1u);
    put_word(head + 8, CNC_BACKUP_SIZE);
    put_word(head + 12, check_of(head, bytes));
    for (unsigned block = 0; block < IMAGE_BLOCKS; block++)
        if (flash->erase(flash->context, image * IMAGE_BLOCKS + block) != 0)
            return false;
    if (!program_bytes(flash, image, bytes) ||
        flash->program(flash->context, image * IMAGE_BLOCKS, 0, head, HEAD) != 0)
        return false;
    *number += 1u;
    return true;
}

/* SPDX-License-Identifier: MIT */
/* Texts of a CNC872 for tests. */
#include "text_rig.h"

#include <check.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#define HOLE ((size_t)32 << 20) /* behind room for the longest text there is */

char text_reported[8192];

void text_report(void *context, const struct cnc_text_error *error)
{
    size_t length = strlen(text_reported);
    (void)context;
    snprintf(text_reported + length, sizeof text_reported - length, "%u:%u: %s\n", error->line, error->column, error->text);
}

const char *text_before_hole(const char *text, size_t length)
{
    static char *room;
    if (room == NULL) {
        room = mmap(NULL, HOLE + 65536, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        ck_assert(room != MAP_FAILED && mprotect(room, HOLE, PROT_READ | PROT_WRITE) == 0);
    }
    ck_assert_uint_le(length, HOLE);
    return memcpy(room + HOLE - length, text, length);
}

bool text_read_config(const char *text, struct cnc_config *config)
{
    text_reported[0] = '\0';
    return cnc_config_read(text_before_hole(text, strlen(text)), strlen(text), config, text_report, NULL);
}

bool text_read_nc(const char *text, const struct cnc_config *config, struct cnc_nc_program *program)
{
    static struct cnc_nc_block blocks[2000];
    static int64_t values[10000];
    uint32_t block_count, value_count;
    text_reported[0] = '\0';
    cnc_nc_measure(text, strlen(text), &block_count, &value_count);
    ck_assert_uint_le(block_count, 2000);
    ck_assert_uint_le(value_count, 10000);
    *program = (struct cnc_nc_program){.blocks = blocks, .values = values, .block_room = block_count, .value_room = value_count};
    return cnc_nc_read(text_before_hole(text, strlen(text)), strlen(text), config, program, text_report, NULL);
}

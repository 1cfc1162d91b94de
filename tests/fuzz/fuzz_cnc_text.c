/* SPDX-License-Identifier: MIT */
/* fuzz_cnc_text.c: any bytes as CONFIG.xml and as an NC program of a CNC872. What is taken is within its limits; what is not has
 * an error in a line that there is. */
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc872.h"
#include "fuzz.h"

struct reading {
    uint32_t lines, errors;
};

static void report(void *context, const struct cnc_text_error *error)
{
    struct reading *reading = context;
    FUZZ_CHECK(error->line >= 1 && error->line <= reading->lines, "line %u of %u", error->line, reading->lines);
    FUZZ_CHECK(error->column >= 1 && strlen(error->text) < CNC_TEXT_ERROR_SIZE, "column %u", error->column);
    reading->errors++;
}

static uint32_t count_lines(const char *text, size_t length)
{
    uint32_t lines = 1;
    for (size_t i = 0; i < length; i++)
        lines += text[i] == '\n';
    return lines;
}

static void check_axis(const struct cnc_axis_config *axis)
{
    FUZZ_CHECK(axis->feed >= 1 && axis->feed_rapid >= 1 && axis->feed_slow >= 1 && axis->feed_reference >= 1, "feeds of 0");
    FUZZ_CHECK(axis->lag >= 1 && axis->reference_method <= 2, "lag %u", axis->lag);
    for (unsigned set = 0; set < CNC_SETS; set++) {
        FUZZ_CHECK(axis->acceleration[set] >= 1 && axis->linear[set] >= 1 && axis->parabolic[set] >= 1, "acceleration of 0");
        FUZZ_CHECK(axis->smoothing[set] >= 1 && axis->smoothing[set] <= 1000, "n %u", axis->smoothing[set]);
    }
}

static void check_config(const char *text, size_t length)
{
    struct reading reading = {.lines = count_lines(text, length)};
    struct cnc_config config;
    bool is_right = cnc_config_read(text, length, &config, report, &reading);
    FUZZ_CHECK(is_right == (reading.errors == 0), "%u errors", reading.errors);
    FUZZ_CHECK(config.axes != 0, "no axes");
    for (unsigned axis = 0; axis < CNC_AXES; axis++) {
        FUZZ_CHECK(config.axis[axis].is_configured == ((config.axes >> axis & 1) != 0), "axis %u", axis);
        if (config.axis[axis].is_configured)
            check_axis(&config.axis[axis]);
    }
    for (unsigned m = 0; m <= CNC_M_MAX; m++)
        FUZZ_CHECK(config.m[m].group >= 1 && config.m[m].group <= CNC_M_GROUPS, "group of M%u", m);
}

static void check_block(const struct cnc_config *config, const struct cnc_nc_program *program, uint32_t i)
{
    const struct cnc_nc_block *block = &program->blocks[i];
    int64_t target = 0, most = (int64_t)CNC_POSITION_MAX_MM * CNC_U_PER_MM;
    FUZZ_CHECK((block->axes & ~(unsigned)config->axes) == 0, "an axis without configuration");
    FUZZ_CHECK((block->axes != 0) == (block->motion != CNC_MOTION_NONE), "motion without axes");
    FUZZ_CHECK(block->axes == 0 || block->motion == CNC_MOTION_RAPID || cnc_nc_value(program, block->feed) > 0, "no feed");
    for (unsigned axis = 0; axis < CNC_AXES; axis++)
        FUZZ_CHECK(!cnc_nc_target(program, block, axis, &target) || (target >= -most && target <= most), "axis %u", axis);
    for (int word = 0; word < CNC_NC_WORDS; word++)
        (void)cnc_nc_word(program, block, (enum cnc_nc_word)word);
    for (unsigned group = 1; group <= CNC_M_GROUPS; group++)
        FUZZ_CHECK(block->m[group] == CNC_NC_NO_M || config->m[block->m[group]].group == group, "M%u", block->m[group]);
}

static void check_program(const char *text, size_t length)
{
    struct reading reading = {.lines = count_lines(text, length)};
    static struct cnc_config config;
    struct cnc_nc_program program = {0};
    cnc_config_clear(&config);
    cnc_nc_measure(text, length, &program.block_room, &program.value_room);
    program.blocks = malloc(program.block_room * sizeof *program.blocks);
    program.values = malloc((program.value_room + 1u) * sizeof *program.values);
    FUZZ_CHECK(program.blocks != NULL && program.values != NULL, "no memory");
    bool is_right = cnc_nc_read(text, length, &config, &program, report, &reading);
    FUZZ_CHECK(is_right == (reading.errors == 0), "%u errors", reading.errors);
    for (uint32_t i = 0; i < program.block_count; i++)
        check_block(&config, &program, i);
    free(program.blocks);
    free(program.values);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_config((const char *)data, size);
    check_program((const char *)data, size);
    return 0;
}

/* SPDX-License-Identifier: MIT */
/* m_functions.c: what a block says to the PLC program: M, T, H (NG1, NG2). */
#include "frame.h"

/* Bits that M functions of a group decode to; the function that sets the bit, or another one that does, too. */
struct decoded {
    uint16_t bit;
    uint8_t group, m, other;
};
static const struct decoded for_the_block[] = {
    {CNC_BIT_M00_PID, 1, 0, 0},   {CNC_BIT_M01_PID, 1, 1, 1},   {CNC_BIT_M02_PID, 1, 2, 2}, {CNC_BIT_M30_PID, 1, 30, 30},
    {CNC_BIT_M10PID, 7, 10, 10},  {CNC_BIT_M11PID, 7, 11, 11},  {CNC_BIT_M06PID, 9, 6, 6},  {CNC_BIT_M60PI, 9, 60, 60},
};
static const struct decoded from_now_on[] = {
    {CNC_BIT_M03PI, 2, 3, 3},    {CNC_BIT_M04PI, 2, 4, 4},    {CNC_BIT_M19PI, 2, 19, 19},   {CNC_BIT_M07PI, 5, 7, 17},
    {CNC_BIT_M08PI, 5, 8, 17},   {CNC_BIT_M50PI, 6, 50, 52},  {CNC_BIT_M51PI, 6, 51, 52},
};
#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Byte of the group's function. */
static const struct {
    uint8_t group;
    enum cnc_cell cell;
} bytes[] = {{2, CNC_CELL_PB06}, {10, CNC_CELL_PB03}, {11, CNC_CELL_PB13}, {12, CNC_CELL_PB14}, {13, CNC_CELL_PB15},
             {14, CNC_CELL_PB16}};

void cnc_end_functions(struct cnc *cnc)
{
    for (size_t i = 0; i < COUNT(for_the_block); i++)
        cnc_set(cnc, for_the_block[i].bit, false);
    for (unsigned i = 0; i < CNC_M_GROUPS; i++)
        cnc_set(cnc, CNC_BIT_ZMMnPI + i, false);
    cnc_set(cnc, CNC_BIT_ZMSHPI, false);
    cnc_set(cnc, CNC_BIT_ZMSTPI, false);
}

static bool is_programmed(const struct decoded *decoded, const struct cnc_nc_block *block)
{
    return block->m[decoded->group] == decoded->m || block->m[decoded->group] == decoded->other;
}

static bool has_group(const struct cnc_nc_block *block, unsigned group)
{
    return block->m[group] != CNC_NC_NO_M;
}

static void publish_m(struct cnc *cnc, const struct cnc_nc_block *block)
{
    for (unsigned group = 1; group <= CNC_M_GROUPS; group++) {
        if (!has_group(block, group))
            continue;
        cnc->machine.m[group] = block->m[group];
        cnc_set(cnc, CNC_BIT_ZMMnPI + group - 1, true);
    }
    for (size_t i = 0; i < COUNT(for_the_block); i++)
        cnc_set(cnc, for_the_block[i].bit, is_programmed(&for_the_block[i], block));
    for (size_t i = 0; i < COUNT(from_now_on); i++)
        if (has_group(block, from_now_on[i].group))
            cnc_set(cnc, from_now_on[i].bit, is_programmed(&from_now_on[i], block));
    for (size_t i = 0; i < COUNT(bytes); i++)
        if (has_group(block, bytes[i].group))
            cnc_put_number(&cnc->cells, bytes[i].cell, 0, cnc_bcd(block->m[bytes[i].group]));
    cnc_publish_gear(cnc, block);
    if (block->m[8] == 48 || block->m[8] == 49)
        cnc->machine.override_cancelled = block->m[8] == 48;
}

void cnc_publish_functions(struct cnc *cnc, const struct cnc_nc_block *block)
{
    publish_m(cnc, block);
    cnc_publish_spindle(cnc, block);
    if ((block->words & 1u << CNC_NC_T) != 0) {
        int64_t t = cnc_nc_word(cnc->program, block, CNC_NC_T);
        cnc_set(cnc, CNC_BIT_ZMSTPI, true);
        for (unsigned i = 0; i < 4; i++, t /= 100)
            cnc_put_number(&cnc->cells, CNC_CELL_PB07, i, cnc_bcd(t));
    }
    if ((block->words & 1u << CNC_NC_H) != 0) {
        cnc_set(cnc, CNC_BIT_ZMSHPI, true);
        cnc_put_number(&cnc->cells, CNC_CELL_PB05, 0, cnc_bcd(cnc_nc_word(cnc->program, block, CNC_NC_H) / 1000000));
    }
}

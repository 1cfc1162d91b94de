/* SPDX-License-Identifier: MIT */
/* queue.c: BLK[n], the present block and the next ones as a PLC program reads them (NQ1). */
#include "frame.h"

#define U_PER_MM ((double)CNC_U_PER_MM)

/* Index of BLK[n] in the NC program; CNC_NO_BLOCK: there is none. */
static uint32_t find_block(const struct cnc *cnc, unsigned n)
{
    if (n == 0)
        return cnc->machine.block;
    return n <= cnc_queue_length(cnc) ? cnc->machine.next + (n - 1) : CNC_NO_BLOCK;
}

/* Does a block end the prepared queue behind it (NJ3)? */
static bool changes_position(const struct cnc *cnc, const struct cnc_nc_block *block)
{
    return cnc_has_attribute(cnc->config, block, CNC_M_CHANGE_POS);
}

unsigned cnc_queue_length(const struct cnc *cnc)
{
    unsigned length = 0;
    const struct cnc_nc_block *present = cnc_present_block(cnc);
    if (cnc->program == NULL || (present != NULL && changes_position(cnc, present)))
        return 0;
    for (uint32_t index = cnc->machine.next; index < cnc->program->block_count && length < CNC_QUEUE_MAX; index++) {
        length++;
        if (changes_position(cnc, &cnc->program->blocks[index]))
            break;
    }
    return length;
}

bool cnc_queue_has(const struct cnc *cnc, unsigned n)
{
    return find_block(cnc, n) != CNC_NO_BLOCK;
}

/* ---- Way ---------------------------------------------------------------------------------------------------------------- */

/* Where the axes are before BLK[n] if all goes on as programmed. */
static void find_start(const struct cnc *cnc, unsigned n, int64_t position[CNC_AXES])
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        position[i] = cnc->axis[i].position;
    for (unsigned k = 0; k < n; k++) {
        const uint32_t index = find_block(cnc, k);
        for (unsigned i = 0; index != CNC_NO_BLOCK && i < CNC_AXES; i++)
            cnc_nc_target(cnc->program, &cnc->program->blocks[index], i, &position[i]);
    }
}

/* The way of BLK[n]: as it is moved, or as it will be. */
static void find_way(const struct cnc *cnc, unsigned n, struct cnc_segment *segment)
{
    const struct cnc_move *move = &cnc->move;
    if (n == 0 && move->section.count > 0) {
        *segment = move->section.segment[move->segment];
        return;
    }
    int64_t position[CNC_AXES];
    find_start(cnc, n, position);
    cnc_segment_build(segment, cnc->config, cnc->program, find_block(cnc, n), position);
}

static double mm_per_minute(int64_t speed)
{
    return (double)(speed * 15) / 16384.0;
}

/* The speed at the border to the block before it in the same section: the lower of the two feeds, within the limits of both. */
static double criterial_feed(const struct cnc *cnc, uint32_t index)
{
    const struct cnc_section *section = &cnc->move.section;
    int64_t lowest = CNC_SPEED_LIMIT;
    if (index <= section->first || index - section->first >= section->count)
        return 0;
    for (uint32_t k = index - section->first - 1; k <= index - section->first; k++) {
        const struct cnc_nc_block *block = &cnc->program->blocks[section->first + k];
        const int64_t feed = cnc_programmed_speed(cnc, block, (struct cnc_override){1000, 1000});
        lowest = feed < lowest ? feed : lowest;
        lowest = section->segment[k].rapid < lowest ? section->segment[k].rapid : lowest;
    }
    return mm_per_minute(lowest);
}

/* ---- Fields ------------------------------------------------------------------------------------------------------------- */

/* The function of a group in force in BLK[n], BCD. */
static int64_t function_in_force(const struct cnc *cnc, unsigned n, unsigned group)
{
    uint8_t m = cnc->machine.m[group];
    for (unsigned k = 0; k <= n; k++) {
        const uint32_t index = find_block(cnc, k);
        if (index != CNC_NO_BLOCK && cnc->program->blocks[index].m[group] != CNC_NC_NO_M)
            m = cnc->program->blocks[index].m[group];
    }
    return m == CNC_NC_NO_M ? 0 : cnc_bcd(m);
}

static bool moves_axis(const struct cnc *cnc, unsigned n, unsigned axis)
{
    struct cnc_segment segment;
    find_way(cnc, n, &segment);
    return segment.way[axis] != 0;
}

static bool is_continued(const struct cnc *cnc, unsigned n, bool is_selected)
{
    return n == 0 ? cnc->machine.is_continued : is_selected && cnc_is_elsewhere(cnc);
}

int64_t cnc_queue_number(const struct cnc *cnc, unsigned n, enum cnc_queue_field field, unsigned index)
{
    const uint32_t at = find_block(cnc, n);
    if (at == CNC_NO_BLOCK)
        return 0;
    const struct cnc_nc_block *block = &cnc->program->blocks[at];
    const bool is_selected = at == cnc->machine.selected;
    switch (field) {
    case CNC_QUEUE_Mn:
        return block->m[index] != CNC_NC_NO_M;
    case CNC_QUEUE_FirstBlock:
        return at == 0;
    case CNC_QUEUE_LastBlock:
        return at + 1 == cnc->program->block_count;
    case CNC_QUEUE_Stop:
        return block->m[1] == 0;
    case CNC_QUEUE_CondStop:
        return block->m[1] == 1;
    case CNC_QUEUE_SelBlock:
        return is_selected;
    case CNC_QUEUE_Cont:
        return is_continued(cnc, n, is_selected);
    case CNC_QUEUE_TchlOff:
        return is_selected && cnc->machine.technology_off;
    case CNC_QUEUE_Partial:
        return n == 0 && cnc_is_set(cnc, CNC_BIT_BLOCK_RESTART);
    case CNC_QUEUE_HProg:
        return block->words >> CNC_NC_H & 1;
    case CNC_QUEUE_TProg:
        return block->words >> CNC_NC_T & 1;
    case CNC_QUEUE_RevFeed:
        return (block->modes & CNC_NC_PER_REVOLUTION) != 0;
    case CNC_QUEUE_ContinuousMode:
        return (block->modes & CNC_NC_CONTINUOUS) != 0;
    case CNC_QUEUE_ConstCutSpeed:
        return (block->modes & CNC_NC_CONSTANT_CUT) != 0;
    case CNC_QUEUE_AxNCnMove:
        return moves_axis(cnc, n, index);
    case CNC_QUEUE_IPlcn:
        return block->words >> (CNC_NC_I0 + (int)index) & 1;
    case CNC_QUEUE_RPlcn:
        return block->words >> (CNC_NC_R0 + (int)index) & 1;
    case CNC_QUEUE_M:
        return function_in_force(cnc, n, index);
    case CNC_QUEUE_IPlcParams:
        return cnc_nc_word(cnc->program, block, (enum cnc_nc_word)(CNC_NC_I0 + (int)index));
    case CNC_QUEUE_T:
        return cnc_nc_word(cnc->program, block, CNC_NC_T);
    case CNC_QUEUE_AxG:
        return cnc->config->geometry[index];
    default:
        return 0;
    }
}

/* Fields that follow from the way of BLK[n]: BlockLen, FeedMax, ParabAccel, LinearAccel. */
static double way_field(const struct cnc *cnc, unsigned n, enum cnc_queue_field field)
{
    struct cnc_segment segment;
    find_way(cnc, n, &segment);
    if (segment.axes == 0)
        return 0;
    switch (field) {
    case CNC_QUEUE_BlockLen:
        return (double)segment.length / U_PER_MM;
    case CNC_QUEUE_FeedMax:
        return mm_per_minute(segment.rapid);
    case CNC_QUEUE_ParabAccel:
        return cnc_segment_change(&segment, cnc->config);
    default:
        return (double)cnc_segment_linear(&segment, cnc->config);
    }
}

double cnc_queue_real(const struct cnc *cnc, unsigned n, enum cnc_queue_field field, unsigned index)
{
    const uint32_t at = find_block(cnc, n);
    if (at == CNC_NO_BLOCK)
        return 0;
    const struct cnc_nc_program *program = cnc->program;
    const struct cnc_nc_block *block = &program->blocks[at];
    int64_t position[CNC_AXES];
    switch (field) {
    case CNC_QUEUE_H:
        return (double)cnc_nc_word(program, block, CNC_NC_H) / 1e6;
    case CNC_QUEUE_RPlcParams:
        return (double)cnc_nc_word(program, block, (enum cnc_nc_word)(CNC_NC_R0 + (int)index)) / 1e6;
    case CNC_QUEUE_Delay:
        return (double)cnc_nc_word(program, block, CNC_NC_DELAY) / 1e6;
    case CNC_QUEUE_AxNC:
        find_start(cnc, n + 1, position);
        return (double)position[index] / U_PER_MM;
    case CNC_QUEUE_Scale:
        return 1;
    case CNC_QUEUE_FeedProgr:
        return (double)cnc_nc_value(program, block->feed) / 1e6;
    case CNC_QUEUE_FeedCriterial:
        return criterial_feed(cnc, at);
    case CNC_QUEUE_SpindleSpeed:
        return (double)cnc_nc_value(program, block->speed) / 1e6;
    case CNC_QUEUE_SpindleSpeedLimit:
        return (double)cnc_nc_value(program, block->speed_limit) / 1e6;
    case CNC_QUEUE_ConstCuttingSpeed: /* m/min in the text, mm/min here */
        return (double)cnc_nc_value(program, block->cutting_speed) / 1000.0;
    default:
        return way_field(cnc, n, field);
    }
}

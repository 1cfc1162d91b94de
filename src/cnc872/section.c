/* SPDX-License-Identifier: MIT */
#include "section.h"

#include <string.h>

#include "wide.h"

#define LIMBS 8u /* of 32 bits */

int64_t cnc_scale(int64_t value, int64_t by, int64_t divisor)
{
    const struct wide product = wide_product((uint64_t)value, (uint64_t)by);
    const uint64_t size = size_of(divisor);
    if (product.high >= size)
        return CNC_SPEED_LIMIT;
    uint64_t rest;
    const uint64_t result = wide_divide(product, size, &rest);
    return result < (uint64_t)CNC_SPEED_LIMIT ? (int64_t)result : CNC_SPEED_LIMIT;
}

/* The smallest of the axes' values along the path. */
static int64_t project_all(const struct cnc_segment *segment, const int64_t value[CNC_AXES])
{
    int64_t least = CNC_SPEED_LIMIT;
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (segment->way[i] != 0) {
            const int64_t along = cnc_scale(value[i], segment->length, segment->way[i]);
            least = along < least ? along : least;
        }
    return least;
}

int64_t cnc_segment_acceleration(const struct cnc_segment *segment, const struct cnc_config *config, enum cnc_set set)
{
    int64_t value[CNC_AXES];
    for (unsigned i = 0; i < CNC_AXES; i++)
        value[i] = config->is_parabolic ? config->axis[i].linear[set] : config->axis[i].acceleration[set];
    const int64_t along = project_all(segment, value);
    return along > 1 ? along : 1;
}

int64_t cnc_segment_linear(const struct cnc_segment *segment, const struct cnc_config *config)
{
    int64_t value[CNC_AXES];
    for (unsigned i = 0; i < CNC_AXES; i++)
        value[i] = config->axis[i].linear[CNC_SET_NORMAL];
    return project_all(segment, value);
}

double cnc_segment_change(const struct cnc_segment *segment, const struct cnc_config *config)
{
    double least = 0;
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (segment->way[i] != 0) {
            const double own = (double)((int64_t)config->axis[i].parabolic[CNC_SET_NORMAL] * CNC_U_PER_UM) / 1e6;
            const double along = own * (double)segment->length / (double)size_of(segment->way[i]);
            least = least > 0 && least < along ? least : along;
        }
    return least;
}

bool cnc_segment_build(struct cnc_segment *segment, const struct cnc_config *config, const struct cnc_nc_program *program,
                       uint32_t block, const int64_t from[CNC_AXES])
{
    struct wide square = {0, 0};
    memset(segment, 0, sizeof *segment);
    for (unsigned i = 0; i < CNC_AXES; i++) {
        int64_t target;
        if (!cnc_nc_target(program, &program->blocks[block], i, &target) || target == from[i])
            continue;
        segment->way[i] = target - from[i];
        segment->axes = (uint16_t)(segment->axes | 1u << i);
        square = wide_sum(square, wide_product(size_of(segment->way[i]), size_of(segment->way[i])));
    }
    if (segment->axes == 0)
        return false;
    bool inexact;
    segment->length = segment->border = (int64_t)wide_root(square, 0, &inexact).low;
    int64_t rapid[CNC_AXES], slow[CNC_AXES];
    for (unsigned i = 0; i < CNC_AXES; i++) {
        rapid[i] = cnc_speed_of(config->axis[i].feed_rapid);
        slow[i] = cnc_speed_of(config->axis[i].feed_slow);
    }
    segment->rapid = project_all(segment, rapid);
    segment->slow = project_all(segment, slow);
    return true;
}

/* ---- Sections ------------------------------------------------------------------------------------------------------ */

bool cnc_has_attribute(const struct cnc_config *config, const struct cnc_nc_block *block, unsigned attribute)
{
    for (unsigned group = 1; group <= CNC_M_GROUPS; group++)
        if (block->m[group] != CNC_NC_NO_M && (config->m[block->m[group]].attributes & attribute) != 0)
            return true;
    return false;
}

/* May a block be in a section at all? */
static bool is_continuous(const struct cnc_nc_block *block)
{
    return (block->modes & CNC_NC_CONTINUOUS) != 0 && (block->words & 1u << CNC_NC_DELAY) == 0 &&
           (block->motion == CNC_MOTION_FEED || block->motion == CNC_MOTION_THREAD);
}

/* product += a * b. */
static void add_product(uint32_t product[LIMBS], const uint32_t a[LIMBS], const uint32_t b[LIMBS])
{
    for (unsigned i = 0; i < LIMBS; i++) {
        uint64_t carry = 0;
        for (unsigned j = 0; i + j < LIMBS; j++) {
            carry += (uint64_t)a[i] * b[j] + product[i + j];
            product[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
    }
}

static void put_wide(uint32_t limb[LIMBS], struct wide number)
{
    memset(limb, 0, LIMBS * sizeof *limb);
    limb[0] = (uint32_t)number.low;
    limb[1] = (uint32_t)(number.low >> 32);
    limb[2] = (uint32_t)number.high;
    limb[3] = (uint32_t)(number.high >> 32);
}

/* a * b * c^2, below 2^256. */
static void multiply(uint32_t product[LIMBS], struct wide a, struct wide b, uint64_t c)
{
    uint32_t left[LIMBS], right[LIMBS], both[LIMBS] = {0};
    put_wide(left, a);
    put_wide(right, b);
    add_product(both, left, right);
    put_wide(right, wide_product(c, c));
    memset(product, 0, LIMBS * sizeof *product);
    add_product(product, both, right);
}

/* Is the angle between two ways 10 degrees at most: cosine >= 984 807 / 1 000 000? */
static bool is_straight(const struct cnc_segment *a, const struct cnc_segment *b)
{
    struct wide along = {0, 0}, against = {0, 0}, square_a = {0, 0}, square_b = {0, 0};
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const struct wide product = wide_product(size_of(a->way[i]), size_of(b->way[i]));
        if ((a->way[i] < 0) == (b->way[i] < 0))
            along = wide_sum(along, product);
        else
            against = wide_sum(against, product);
        square_a = wide_sum(square_a, wide_product(size_of(a->way[i]), size_of(a->way[i])));
        square_b = wide_sum(square_b, wide_product(size_of(b->way[i]), size_of(b->way[i])));
    }
    if (!wide_less(against, along))
        return false;
    uint32_t left[LIMBS], right[LIMBS];
    multiply(left, wide_difference(along, against), wide_difference(along, against), 1000000);
    multiply(right, square_a, square_b, 984807);
    for (unsigned i = LIMBS; i-- > 0;)
        if (left[i] != right[i])
            return left[i] > right[i];
    return true;
}

/* Does the next block, whose way is `next`, go on in the section (NM8)? A stop of the program ends it in any case. */
static bool goes_on(const struct cnc_config *config, const struct cnc_nc_block *block, const struct cnc_segment *way,
                    const struct cnc_segment *next)
{
    return block->m[1] == CNC_NC_NO_M && !cnc_has_attribute(config, block, CNC_M_BREAK_CONT_END) && is_continuous(block + 1) &&
           !cnc_has_attribute(config, block + 1, CNC_M_BREAK_CONT) && is_straight(way, next);
}

/* The sets of the whole: the smallest acceleration, the greatest n. */
static void merge_sets(struct cnc_section *section, const struct cnc_config *config)
{
    for (unsigned set = 0; set < CNC_SETS; set++) {
        section->acceleration[set] = CNC_SPEED_LIMIT;
        section->n[set] = 1;
        for (unsigned k = 0; k < section->count; k++) {
            const int64_t own = cnc_segment_acceleration(&section->segment[k], config, (enum cnc_set)set);
            if (own < section->acceleration[set])
                section->acceleration[set] = own;
        }
        for (unsigned i = 0; i < CNC_AXES; i++)
            if (config->is_parabolic && cnc_has_axis(section->axes, i) && config->axis[i].smoothing[set] > section->n[set])
                section->n[set] = config->axis[i].smoothing[set];
    }
}

void cnc_section_build(struct cnc_section *section, const struct cnc_config *config, const struct cnc_nc_program *program,
                       uint32_t first, const int64_t position[CNC_AXES], bool only_one)
{
    int64_t from[CNC_AXES];
    memset(section, 0, sizeof *section);
    memcpy(section->start, position, sizeof section->start);
    memcpy(from, position, sizeof from);
    section->first = first;
    for (uint32_t block = first; block < program->block_count && section->count < CNC_SEGMENTS_MAX; block++) {
        struct cnc_segment *next = &section->segment[section->count];
        const bool moves = cnc_segment_build(next, config, program, block, from);
        if (!moves || (block > first && !goes_on(config, &program->blocks[block - 1], next - 1, next)))
            break;
        section->length += next->length;
        next->border = section->length;
        section->axes |= next->axes;
        section->count++;
        for (unsigned i = 0; i < CNC_AXES; i++)
            from[i] += next->way[i];
        if (only_one || !is_continuous(&program->blocks[block]))
            break;
    }
    merge_sets(section, config);
}

/* Nearest whole number, 1 ... CNC_AVERAGE_MAX. */
static uint16_t whole_n(double n)
{
    if (!(n >= 1))
        return 1;
    return n < CNC_AVERAGE_MAX ? (uint16_t)(n + 0.5) : (uint16_t)CNC_AVERAGE_MAX;
}

void cnc_section_request(struct cnc_section *section, const struct cnc_config *config, int64_t acceleration, double change)
{
    const int64_t most = acceleration < CNC_SPEED_LIMIT ? acceleration : CNC_SPEED_LIMIT;
    const bool is_requested = most > 0 || change > 0;
    if (!config->is_parabolic || !is_requested)
        return;
    uint16_t n = 1;
    for (unsigned k = 0; k < section->count; k++) {
        const struct cnc_segment *own = &section->segment[k];
        const double a = (double)(most > 0 ? most : cnc_segment_acceleration(own, config, CNC_SET_NORMAL));
        const uint16_t n_own = whole_n(a / (change > 0 ? change : cnc_segment_change(own, config)));
        n = n_own > n ? n_own : n;
    }
    section->n[CNC_SET_NORMAL] = n;
    if (most > 0)
        section->acceleration[CNC_SET_NORMAL] = most;
}

unsigned cnc_section_at(const struct cnc_section *section, int64_t done)
{
    unsigned k = 0;
    while (k + 1 < section->count && done >= section->segment[k].border)
        k++;
    return k;
}

void cnc_section_place(const struct cnc_section *section, int64_t done, int64_t position[CNC_AXES])
{
    const unsigned at = cnc_section_at(section, done);
    const struct cnc_segment *now = &section->segment[at];
    const uint64_t way = (uint64_t)(done - (now->border - now->length));
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (!cnc_has_axis(section->axes, i))
            continue;
        position[i] = section->start[i];
        for (unsigned k = 0; k < at; k++)
            position[i] += section->segment[k].way[i];
        if (now->way[i] == 0)
            continue;
        uint64_t rest;
        const int64_t part = (int64_t)wide_divide(wide_product(size_of(now->way[i]), way), (uint64_t)now->length, &rest);
        position[i] += now->way[i] > 0 ? part : -part;
    }
}

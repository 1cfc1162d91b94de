/* SPDX-License-Identifier: MIT */
/* nc.h: the NC program as text and as blocks (section 13). Blocks and values lie in memory of the caller, outside of struct cnc;
 * they are const once they are read. */
#ifndef CNC872_NC_H
#define CNC872_NC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "config.h"
#include "text_error.h"

#define CNC_NC_BLOCKS_MAX 1000000u /* NL4 */
#define CNC_NC_NONE UINT32_MAX     /* index of a value: not programmed */
#define CNC_NC_NO_M 255u
#define CNC_NC_PARAMETERS 5u       /* I0 to I4, R0 to R4 */

enum cnc_motion { CNC_MOTION_NONE, CNC_MOTION_RAPID, CNC_MOTION_FEED, CNC_MOTION_THREAD }; /* G00, G01, G33 */

/* Modes in force in a block. */
enum { CNC_NC_CONTINUOUS = 1 /* G23 */, CNC_NC_PER_REVOLUTION = 2 /* G95 */, CNC_NC_CONSTANT_CUT = 4 /* G96 */ };

/* What a block may have besides axes: bits of `words`, in the order of its values behind those of the axes. */
enum cnc_nc_word {
    CNC_NC_DELAY,                                      /* G04 P: seconds in millionths, 0 to 10^12 */
    CNC_NC_T,                                          /* 0 to 99 999 999 */
    CNC_NC_H,                                          /* millionths, 0 to 10^12 */
    CNC_NC_I0,                                         /* ... I4: whole, a signed DWORD */
    CNC_NC_R0 = CNC_NC_I0 + (int)CNC_NC_PARAMETERS,    /* ... R4: millionths, within +-10^15 */
    CNC_NC_WORDS = CNC_NC_R0 + (int)CNC_NC_PARAMETERS
};

struct cnc_nc_block {
    uint32_t line;   /* of the text, from 1 */
    uint32_t values; /* index of its first own value: targets of its axes, X first, then its words */
    /* Index of the value in force, or CNC_NC_NONE: F in millionths of mm/min (G95, G33: mm/rev); S of G97 in millionths of
     * rev/min; S of G96 in millionths of m/min; L in millionths of rev/min. Each 1 to 10^12. */
    uint32_t feed, speed, cutting_speed, speed_limit;
    uint16_t axes;   /* bit of each axis that is programmed here; targets are u, absolute in POS0 */
    uint16_t words;  /* bits of enum cnc_nc_word */
    uint8_t motion;  /* enum cnc_motion in force; CNC_MOTION_NONE in a block without axes */
    uint8_t modes;
    bool has_speed;  /* S is programmed in this block */
    uint8_t m[CNC_M_GROUPS + 1]; /* the function of each group that is programmed here, or CNC_NC_NO_M; so is m[0] */
};

struct cnc_nc_program {
    struct cnc_nc_block *blocks;
    int64_t *values;
    uint32_t block_count, block_room;
    uint32_t value_count, value_room;
};

/* How many blocks and values a text has at most: the room that reading it takes. */
void cnc_nc_measure(const char *text, size_t length, uint32_t *blocks, uint32_t *values);

/* Read a text into the memory of `program` (blocks, values and their rooms are set by the caller). A line that has words is a
 * block. Returns whether there was no error; else the program has no blocks. One error a line, the first 20 go to report(). */
bool cnc_nc_read(const char *text, size_t length, const struct cnc_config *config, struct cnc_nc_program *program,
                 cnc_text_report *report, void *context);

/* Target of an axis, u. Returns false, and leaves *target, if the block does not program it. */
bool cnc_nc_target(const struct cnc_nc_program *program, const struct cnc_nc_block *block, unsigned axis, int64_t *target);

/* A word's value, 0 if the block does not have it. */
int64_t cnc_nc_word(const struct cnc_nc_program *program, const struct cnc_nc_block *block, enum cnc_nc_word word);

/* A value in force by its index, 0 for CNC_NC_NONE. */
int64_t cnc_nc_value(const struct cnc_nc_program *program, uint32_t index);

#endif

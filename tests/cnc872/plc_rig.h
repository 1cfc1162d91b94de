/* SPDX-License-Identifier: MIT */
/* plc_rig.h: a PLC program with cells of its own and a queue of one's choice, without the rest of a CNC872. */
#ifndef PLC_RIG_H
#define PLC_RIG_H

#include "cnc872/plc.h"

/* What has been reported to the surroundings, and what they answer. */
struct plc_rig {
    struct cnc_plc_program program;
    struct cnc_plc plc;
    struct cnc_cells cells;
    char errors[4000];       /* "LINE:COLUMN: text\n" each */
    unsigned error_count;
    int64_t queue[3][CNC_QUEUE_FIELDS][16]; /* blocks 0 ... 2 */
    double queue_real[3][CNC_QUEUE_FIELDS][16];
    enum cnc_plc_event event; /* the last one */
    int64_t event_value;
    unsigned event_line, events;
    unsigned axes; /* bits: for which SPI_AX_x has been called */
};

extern struct plc_rig rig;
extern const struct cnc_plc_surroundings plc_rig_surroundings;

/* Translates; the rig is cleared before. False: rig.errors says why. */
bool rig_translate(const char *text);
/* The same, which has to succeed; power-up with a pass of MODULE_INIT. */
void rig_load(const char *text);
/* A call of a section. */
bool rig_pass(enum cnc_plc_section section);
/* What an operand is now: bits and whole numbers; type REAL. */
int64_t rig_value(const char *operand);
double rig_real(const char *operand);
void rig_put(const char *operand, int64_t value);
/* Runs the lines as a MODULE_MAIN behind these declarations, and gives DR. */
int64_t rig_run(const char *data, const char *lines);

#endif

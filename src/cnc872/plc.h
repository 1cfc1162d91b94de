/* SPDX-License-Identifier: MIT */
/* plc.h: PLC programs (section 14): the text becomes code once, the code is run a call at a time.
 *
 *     static struct cnc_plc_program program;                                 // constant after the translation: copies share it
 *     if (!cnc_translate_plc(text, length, &program, report, context)) ...   // report() has had what is wrong
 *     cnc_begin_plc(&plc, &program, &cells);                                 // power-up; then a pass of CNC_PLC_INIT
 *     done = cnc_pass_plc(&plc, &program, &cells, CNC_PLC_MAIN, &surroundings, context);
 */
#ifndef CNC872_PLC_H
#define CNC872_PLC_H

#include "names.h"
#include "operand.h"
#include "text_error.h"

#define CNC_PLC_CODE_MAX 65535u    /* instructions; TEX0 takes three (NP8) */
#define CNC_PLC_CALL_MAX 100000u   /* instructions of one call (NP8) */
#define CNC_PLC_MECHANISMS_MAX 250u
#define CNC_PLC_TEXT_MAX 16777216u /* bytes of a text */

enum cnc_plc_section {
    CNC_PLC_INIT,       /* MODULE_INIT */
    CNC_PLC_MAIN,       /* MODULE_MAIN with its mechanisms */
    CNC_PLC_BLOCK_INIT, /* MODULE_BLOCK_INIT */
    CNC_PLC_BLOCK_DONE, /* MODULE_BLOCK_DONE */
    CNC_PLC_EVENT,      /* _ON_EVENT */
    CNC_PLC_SECTIONS    /* mechanisms count on from here */
};
#define CNC_PLC_PLACES (CNC_PLC_SECTIONS + CNC_PLC_MECHANISMS_MAX)

struct cnc_instruction {
    struct cnc_operand operand; /* of jumps: value is the target */
    uint32_t line;
    uint8_t code; /* enum cnc_plc_code */
};

struct cnc_plc_part {
    uint16_t begin, end; /* first instruction, its end instruction */
    bool is_there;
};

/* A translated program: about 2 MB, constant after the translation. What lies behind code[length - 1] is not used then. */
struct cnc_plc_program {
    struct cnc_plc_part parts[CNC_PLC_PLACES]; /* sections, then mechanisms */
    struct cnc_names names;                    /* for operands of the control socket, too */
    uint32_t length;                           /* instructions */
    uint16_t mechanisms;
    uint16_t memory, bits; /* how many bytes and bits of its own it has */
    struct cnc_instruction code[CNC_PLC_CODE_MAX];
};

/* The state of a running program: plain memory. */
struct cnc_plc {
    int64_t dr;                     /* DR64 */
    double real;                    /* DR_REAL */
    uint16_t place[CNC_PLC_PLACES]; /* where the next call of each section and mechanism begins */
    uint16_t bx;
    uint16_t no_license; /* bits: licences that are not valid, as in struct cnc_config */
    bool rlo;
    bool is_halted; /* after a fault nothing of it runs */
    /* For who looks at it. */
    uint16_t waits[CNC_PLC_PLACES]; /* instruction at which the last call has ended, from 1; 0: it does not wait */
    uint16_t halted_at;             /* instruction */
    uint32_t done[CNC_PLC_SECTIONS], most[CNC_PLC_SECTIONS]; /* instructions of the last call, and of the longest one */
};

enum cnc_plc_event {
    CNC_PLC_ERROR_SET, /* ESET; value: DR */
    CNC_PLC_DIVISION,  /* division by 0 */
    CNC_PLC_FAULT      /* more instructions than CNC_PLC_CALL_MAX in one call: the program is halted */
};

/* What a program reaches beside the cells. */
struct cnc_plc_surroundings {
    /* A field of block `block` of the queue, 0 behind its end (NQ1): bits and whole numbers, and those of type REAL. */
    int64_t (*queue_number)(void *context, unsigned block, enum cnc_queue_field field, unsigned index);
    double (*queue_real)(void *context, unsigned block, enum cnc_queue_field field, unsigned index);
    /* SPI_AX_x (NF6). */
    void (*seek_zero_pulse)(void *context, unsigned axis);
    void (*report)(void *context, enum cnc_plc_event event, int64_t value, uint32_t line);
};

/* Translates a text of at most CNC_PLC_TEXT_MAX bytes (more are an error). report() has what is wrong, in the order of the
 * lines: "unknown instruction `TIM'". False: there are errors, and *program is no program. */
bool cnc_translate_plc(const char *text, size_t length, struct cnc_plc_program *program, cnc_text_report *report, void *context);

/* Power-up: the presets of the program's own cells, registers 0, every part at its beginning. no_license stays. */
void cnc_begin_plc(struct cnc_plc *plc, const struct cnc_plc_program *program, struct cnc_cells *cells);

/* A call of a section (NP6). True: the section has ended, or there is none; false: it waits, or the program is halted.
 * After a fault STOP_EMERGENCY_REQ is 1. */
bool cnc_pass_plc(struct cnc_plc *plc, const struct cnc_plc_program *program, struct cnc_cells *cells,
                  enum cnc_plc_section section, const struct cnc_plc_surroundings *surroundings, void *context);

/* The cell that an instruction names; NULL: it names none. */
const struct cnc_operand *cnc_plc_cell(const struct cnc_instruction *instruction);

/* The next call of the section begins at its beginning (NB7). */
void cnc_restart_section(struct cnc_plc *plc, const struct cnc_plc_program *program, enum cnc_plc_section section);

#endif

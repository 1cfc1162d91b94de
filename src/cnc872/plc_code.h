/* SPDX-License-Identifier: MIT */
/* plc_code.h: what instructions become, for the translator and the interpreter. */
#ifndef CNC872_PLC_CODE_H
#define CNC872_PLC_CODE_H

#include "plc.h"

enum cnc_plc_code {
    /* RLO and bits */
    CODE_LDR,
    CODE_LA,
    CODE_LO,
    CODE_LX,
    CODE_WR,
    CODE_CA,
    CODE_FL, /* operand: the bit; value 0 or 1 */
    CODE_FL1,
    CODE_LICENCE, /* value: which */
    /* DR, or DR_REAL if the operand's type is REAL */
    CODE_LOD,
    CODE_AD,
    CODE_SU,
    CODE_MULB,
    CODE_DIVB,
    CODE_EQ,
    CODE_LE,
    CODE_LT,
    CODE_GE,
    CODE_GT,
    CODE_STO,
    /* DR alone */
    CODE_ORB,
    CODE_ANDB,
    CODE_XORB,
    CODE_ABS, /* type */
    CODE_RR,  /* type, value */
    CODE_BX,
    CODE_ESET,
    CODE_NOTHING,
    CODE_SPINDLE_AXIS, /* value: axis */
    /* the way through the code */
    CODE_JUM, /* value: target */
    CODE_JL0,
    CODE_JL1,
    CODE_EX,
    CODE_EX0,
    CODE_EX1,
    CODE_TEX0, /* operand: counter, value: code; behind it: CODE_TIME with the time, CODE_JUM */
    CODE_TIME,
    CODE_MECHANISM,     /* operand: its bit; value: its number */
    CODE_END_MECHANISM, /* the same */
    CODE_END            /* of a section */
};

#endif

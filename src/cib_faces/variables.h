/* SPDX-License-Identifier: MIT */
/* variables.h: names, types and values of what PLCComS clients see of CIB modules (docs/CIB.md, BN2). */
#ifndef RKM04_CIB_FACES_VARIABLES_H
#define RKM04_CIB_FACES_VARIABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cib/cib.h"

#define CIB_UNIT_VARIABLES 57u  /* of one module */
#define CIB_LINE_UNITS 16u      /* modules that one server can have */
#define CIB_VARIABLES (1u + CIB_LINE_UNITS * CIB_UNIT_VARIABLES)
#define CIB_VARIABLE_NAME_SIZE 24u /* bytes, with the end */

/* The modules of a server, in the order of their addresses on the bus. */
struct cib_modules {
    unsigned count;
    struct cib_unit *unit[CIB_LINE_UNITS]; /* NULL: it has no power */
    uint8_t address[CIB_LINE_UNITS];
};

/* How many variables there are: 0 is __PLC_RUN, then those of the first module, of the second, … */
unsigned cib_variables(const struct cib_modules *modules);

/* Writes the name of a variable, 0..cib_variables()-1, with a zero after it. Returns its length. */
size_t cib_variable_name(const struct cib_modules *modules, unsigned variable, char name[CIB_VARIABLE_NAME_SIZE]);

/* "BOOL", "UINT", "INT" or "DINT". */
const char *cib_variable_type(unsigned variable);

/* Its value; without power 0. */
int32_t cib_variable_value(const struct cib_modules *modules, unsigned variable);

enum cib_set {
    CIB_SET_DONE,
    CIB_SET_READ_ONLY, /* of the input zone, or its module has no power */
    CIB_SET_VALUE      /* it does not take the value */
};

enum cib_set cib_variable_set(const struct cib_modules *modules, unsigned variable, int64_t value);

/* Can clients set it? */
bool cib_variable_is_open(const struct cib_modules *modules, unsigned variable);

/* Is it a BOOL? */
bool cib_variable_is_bit(unsigned variable);

#endif

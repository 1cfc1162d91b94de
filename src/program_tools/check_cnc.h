/* SPDX-License-Identifier: MIT */
/* check_cnc.h: texts of a CNC872: what is wrong with CONFIG.xml, NC programs (.nc) and PLC programs (.plc). */
#ifndef RKM04_PROGRAM_TOOLS_CHECK_CNC_H
#define RKM04_PROGRAM_TOOLS_CHECK_CNC_H

#include "cnc872/cnc872.h"
#include "diagnostic.h"

/* Is a file of this name such a text? */
bool check_cnc_takes(const char *name);

/* Check one. machine: that of NC programs. Of a configuration, *machine becomes what it says. What is found is in *found, in
 * order; diagnostics_free() is due in any case. Returns false if out of memory. */
bool check_cnc(const struct program_source *source, struct cnc_config *machine, struct diagnostics *found);

#endif

/* SPDX-License-Identifier: MIT */
/* check_cnc_names.h: the name that was probably meant in a PLC program of a CNC872. */
#ifndef RKM04_PROGRAM_TOOLS_CHECK_CNC_NAMES_H
#define RKM04_PROGRAM_TOOLS_CHECK_CNC_NAMES_H

#include "diagnostic.h"

/* What a hint says about an error of this text, "did you mean `STOPPI'?": the nearest cell, variable or mechanism for one that
 * there is not, or the nearest instruction. Valid until the next call; NULL: none is near, or the error is another. */
const char *check_cnc_hint(const struct program_source *source, const char *error);

#endif

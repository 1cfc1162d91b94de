/* SPDX-License-Identifier: MIT */
/* methods.h: the tables of methods of this room. Private. */
#ifndef RKM04_COMMAND_METHODS_H
#define RKM04_COMMAND_METHODS_H

#include "command.h"

extern const struct command_method unit_methods[];  /* command_unit.c */
extern const struct command_method plant_methods[]; /* plant_command.c */
extern const struct command_method service_methods[]; /* service_command.c */
extern const struct command_method fault_methods[]; /* fault_command.c */

#endif

/* SPDX-License-Identifier: MIT */
/* text.h: reading and writing text; the face of the room.
 *
 *     config_tree    YAML and JSON files as a tree whose nodes know their line and column
 *     number, digits, time_value    numbers and times as people write them: "1.5s", "20ms"
 *     program_text, diagnose        program texts of a unit, and what a unit would refuse in them
 *     error_lines    errors of a text, up to a limit
 *     file_guess     what a file seems to be, for users who have mixed files up
 *     readings       names and values of the readings of the manual
 *     nearest        the known name next to a wrong one, for messages
 *     trace_names    endings of names of traces, for help texts
 *     wire_text      text of limited length, put together piece by piece
 *     exit_status    exit statuses of all programs
 *
 * Knows nothing of buses and units but the public headers of the core. */
#ifndef RKM04_TEXT_ROOM_H
#define RKM04_TEXT_ROOM_H

#include "config_tree.h"
#include "diagnose.h"
#include "digits.h"
#include "error_lines.h"
#include "exit_status.h"
#include "file_guess.h"
#include "invisible.h"
#include "nearest.h"
#include "number.h"
#include "program_text.h"
#include "readings.h"
#include "time_value.h"
#include "trace_names.h"
#include "wire_text.h"

#endif

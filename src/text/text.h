/* SPDX-License-Identifier: MIT */
/* text.h: the face of the room for reading and writing text: YAML with places (config_tree), times, numbers, digits, bytes and
 * words for people, program
 * texts with their mistakes, option texts. Knows nothing of buses and units but the public headers of the core. */
#ifndef RKM04_TEXT_ROOM_H
#define RKM04_TEXT_ROOM_H

#include "config_tree.h"
#include "diagnose.h"
#include "digits.h"
#include "exit_status.h"
#include "invisible.h"
#include "number.h"
#include "program_text.h"
#include "readings.h"
#include "time_value.h"
#include "wire_text.h"

#endif

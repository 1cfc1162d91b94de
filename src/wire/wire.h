/* SPDX-License-Identifier: MIT */
/* wire.h: the face of the room for the two wires of a bus in virtual time: levels, bytes, units, collisions; and a monitor
 * that finds the messages in the bytes, and their description in words. No file, no clock. */
#ifndef RKM04_WIRE_H
#define RKM04_WIRE_H

#include "segment.h"
#include "wire_message.h"
#include "wire_monitor.h"
#include "wire_words.h"

#endif

/* SPDX-License-Identifier: MIT */
/* wire.h: the two wires of a bus in virtual time; the face of the room.
 *
 *     levels        one wire: a 0 wins over a 1, and a receiver samples the middle of each bit
 *     segment       host and units on two wires: bytes, turnaround, collisions
 *     wire_monitor  finds the messages in the bytes
 *     wire_message  one message that has passed
 *     wire_words    the same in words, for logs and people
 *
 * No file, no clock: ticks and bytes come in as arguments. */
#ifndef RKM04_WIRE_H
#define RKM04_WIRE_H

#include "segment.h"
#include "wire_message.h"
#include "wire_monitor.h"
#include "wire_words.h"

#endif

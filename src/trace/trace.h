/* SPDX-License-Identifier: MIT */
/* trace.h: files about what happens on a bus; the face of the room.
 *
 *     trace_file    CSV, VCD, JSON Lines: pulses, inputs, outputs, states (--trace); one trace_NAME.c a format
 *     wire_file     messages on the wires: a log for people, pcapng for Wireshark (--wire)
 *     trace_set     files started and stopped while a bus runs
 *     event_json    one event as JSON, for JSON Lines and for clients of the control socket
 *     event_filter  which events a client wants
 *
 * A file watches a sim from its beginning to its end and changes nothing in it. docs/TRACES.md describes the formats. */
#ifndef RKM04_TRACE_H
#define RKM04_TRACE_H

#include "event_filter.h"
#include "event_json.h"
#include "trace_file.h"
#include "trace_set.h"
#include "wire_file.h"

#endif

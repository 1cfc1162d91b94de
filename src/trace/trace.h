/* SPDX-License-Identifier: MIT */
/* trace.h: the face of the room for files about what happens on a bus: CSV, VCD, JSON lines; the log of the wires and pcapng;
 * events as JSON. */
#ifndef RKM04_TRACE_H
#define RKM04_TRACE_H

#include "event_json.h"
#include "trace_file.h"
#include "wire_file.h"

#endif

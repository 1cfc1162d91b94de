/* SPDX-License-Identifier: MIT */
/* device.h: the face of the room for what a device on a bus is to everything around it: its names and numbers, its state as
 * JSON and in words. */
#ifndef RKM04_ROOM_DEVICE_H
#define RKM04_ROOM_DEVICE_H

#include "coverage.h"
#include "serve_names.h"
#include "state_json.h"
#include "unit_json.h"

#endif

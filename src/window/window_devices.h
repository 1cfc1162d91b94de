/* SPDX-License-Identifier: MIT */
/* window_devices.h: the serial devices of this machine. src/windows has another one. */
#ifndef RKM04_WINDOW_DEVICES_H
#define RKM04_WINDOW_DEVICES_H

#include <jansson.h>

/* [{"port", "device"}]: what to open, and which device that is. New reference; NULL: no memory. */
json_t *window_devices_find(void);

#endif

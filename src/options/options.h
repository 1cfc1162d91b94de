/* SPDX-License-Identifier: MIT */
/* options.h: the face of the room for the command line: options that several programs share, numbers that fit, addresses,
 * names that are near. */
#ifndef RKM04_OPTIONS_H
#define RKM04_OPTIONS_H

#include "arguments.h"
#include "nearest.h"
#include "process.h"
#include "readings_option.h"
#include "socket_address.h"

#endif

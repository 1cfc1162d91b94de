/* SPDX-License-Identifier: MIT */
/* serve.h: the face of the room for `rkm04 serve`: buses with clocks in one event loop, from the options to the exit status; confinement, readiness. */
#ifndef RKM04_ROOM_SERVE_H
#define RKM04_ROOM_SERVE_H

#include "serve_options.h"

#endif

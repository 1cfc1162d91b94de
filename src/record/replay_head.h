/* SPDX-License-Identifier: MIT */
/* replay_head.h: the head of a recording, and the bus that it describes. Only replay_head.c writes into it. */
#ifndef RKM04_RECORD_REPLAY_HEAD_H
#define RKM04_RECORD_REPLAY_HEAD_H

#include "sim/sim.h"

struct replay;

struct replay_head {
    struct sim *sim;
    uint8_t *flash;             /* of all units, inverted */
    const struct device_kind *device;
    json_t *settings;           /* of the units */
    char *emulator;             /* that recorded; NULL: not known */
    bool outputs;               /* the recording has them */
};

/* Read the head and the flash images, and power the bus up. */
bool replay_begin(struct replay *replay);

/* End the sim, too. */
void replay_head_free(struct replay *replay);

#endif

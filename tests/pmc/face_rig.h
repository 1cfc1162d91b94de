/* SPDX-License-Identifier: MIT */
/* face_rig.h: a PMC at a line, without plant and flash. */
#ifndef TESTS_FACE_RIG_H
#define TESTS_FACE_RIG_H

#include "pmc/pmc.h"

#define FACE_US 8u      /* ticks */
#define FACE_MS 8000u

struct face_rig {
    struct pmc_unit unit;
    uint32_t pulses[PMC_AXES]; /* reported */
    bool stores;               /* flash works */
    uint8_t flash[PMC_FLASH_BLOCKS][PMC_FLASH_BLOCK_SIZE];
    char answer[1024];         /* of the last call, as text or "01 06 00"; "": none */
};

void face_begin(struct face_rig *rig, const struct pmc_config *config);

/* Advance by so many ms. */
void face_wait(struct face_rig *rig, unsigned ms);

/* A line with its CR; the answer, which may come at once only. */
const char *face_line(struct face_rig *rig, const char *line);

/* Bytes as hexadecimal digits with blanks, "01 03", at the present tick; then the answer after `us` more. */
const char *face_frame(struct face_rig *rig, const char *hex, unsigned us);

/* The same, with the check value added, and without that of the answer; 5 ms. */
const char *face_ask(struct face_rig *rig, const char *hex);

int32_t face_position(const struct face_rig *rig, unsigned axis);

#endif

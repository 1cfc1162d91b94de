/* SPDX-License-Identifier: MIT */
/* pmc_face.h: what the faces of a PMC keep in its unit (ascii.c, modbus.c). */
#ifndef PMC_PMC_FACE_H
#define PMC_PMC_FACE_H

#include <stdbool.h>
#include <stdint.h>

union pmc_face_state {
    uint8_t none;
};

#endif

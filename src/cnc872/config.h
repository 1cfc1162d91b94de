/* SPDX-License-Identifier: MIT */
/* config.h: the configuration of the machine, CONFIG.xml (section 12). Plain data, outside of struct cnc; const once
 * it is read. */
#ifndef CNC872_CONFIG_H
#define CNC872_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cells.h"
#include "text_error.h"

#define CNC_GEARS 32u
#define CNC_M_MAX 100u      /* M00 to M100 */
#define CNC_M_GROUPS 14u    /* groups 1 to 14; arrays have a place 0 that is not used */
#define CNC_U_PER_UM 65536  /* NU4: 1 u = 2^-16 um */
#define CNC_U_PER_MM 65536000
#define CNC_POSITION_MAX_MM 200000 /* positions and offsets are within +-200 000 mm */

/* The three sets of acceleration of an axis (NM5). */
enum cnc_set { CNC_SET_NORMAL, CNC_SET_RAPID, CNC_SET_EMERGENCY, CNC_SETS };

struct cnc_axis_config {
    bool is_configured;
    bool needs_reference;      /* NeedRef or AutNeedRef */
    bool is_rotary;            /* 1/1000 degree in place of 1 um */
    bool searches_plus;        /* RefDir="+" */
    bool has_sls_minus, has_sls_plus;
    uint8_t reference_method;  /* RefMethod 0 to 2 (NH3) */
    uint32_t feed, feed_rapid, feed_slow, feed_reference; /* 1/1000 mm/min, 1 to 10^9 */
    uint32_t lag;              /* T, 1 to 1 000 000 (NS3) */
    uint32_t max_lag;          /* um; 0: never (NS5) */
    int64_t max_difference;    /* u */
    int64_t acceleration[CNC_SETS]; /* Acceleration..., u/T^2, >= 1 */
    int64_t linear[CNC_SETS];       /* LinearAccel..., u/T^2, >= 1 */
    uint32_t parabolic[CNC_SETS];   /* ParabAccel..., 1/1000 m/s^3, 1 to 10^9; 1 m/s^3 = 65.536 u/T^3 */
    uint16_t smoothing[CNC_SETS];   /* n of NM3: LinearAccel / ParabAccel in T, 1 to 1000 */
    int64_t null_point, sls_minus, sls_plus;              /* u, POS5 */
    int64_t length_correction, offset1, offset2;          /* u (NS1) */
};

struct cnc_gear {
    bool is_configured;
    uint32_t min_speed, max_speed; /* 1/1000 rev/min, max_speed 1 to 10^9 */
};

/* Attributes of an M function (NJ3). */
enum { CNC_M_BREAK_CONT = 1, CNC_M_BREAK_CONT_END = 2, CNC_M_CHANGE_POS = 4 };
struct cnc_m_function {
    uint8_t group; /* 1 to 14 */
    uint8_t attributes;
};

/* Licences (8.4.7): bits of cnc_config.no_license. FeaturePlc0 to FeaturePlc9 are bits 1 to 10. */
enum { CNC_LICENSE_HW_KEY = 0, CNC_LICENSE_FEATURE_PLC0 = 1, CNC_LICENSES = 11 };

struct cnc_config {
    bool is_parabolic;             /* AccelerationType="1" */
    bool manual_by_man;            /* ManualEnable="MAN": MPxMAN in place of MPxPI in manual moves (NA, NE2) */
    uint16_t no_license;           /* bit of each licence that is not valid */
    uint16_t axes;                 /* bit of each axis that is configured */
    uint8_t geometry[3];           /* AxG: index of the axis */
    struct cnc_axis_config axis[CNC_AXES];
    struct cnc_gear gear[CNC_GEARS + 1]; /* 1 to 32 */
    struct cnc_m_function m[CNC_M_MAX + 1];
};

/* The configuration of a text without elements: X, Y, Z with the defaults of NJ2, one gear 0-4000, the fixed groups of M. */
void cnc_config_clear(struct cnc_config *config);

/* Read CONFIG.xml: root ChannelConfig, or MFunctions alone. Without an Axis: X, Y, Z; without a Gear: gear 1, 0-4000 rev/min.
 * Returns whether there was no error. Errors go to report(), the first 20; after the first one of its structure reading ends.
 * The text needs no final 0; nothing of it is kept. */
bool cnc_config_read(const char *text, size_t length, struct cnc_config *config, cnc_text_report *report, void *context);

/* The licence of this name, "HwKeyConnected", "FeaturePlc0" ...; -1: there is none. */
int cnc_find_license(const char *text, size_t length);

/* Is the function in one of the groups of section 11 whatever the configuration says? Returns its group, or 0. */
unsigned cnc_fixed_group(unsigned m);

/* mm/min -> u/T (NU4): floor of F * 16384 / 15, F in 1/1000 mm/min. */
int64_t cnc_speed_of(int64_t feed);

/* mm/s^2 -> u/T^2 (NU4): nearest of A * 65.536, at least 1; A in 1/1000 mm/s^2. */
int64_t cnc_acceleration_of(int64_t acceleration);

#endif

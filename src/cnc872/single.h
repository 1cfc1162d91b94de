/* SPDX-License-Identifier: MIT */
/* single.h: motions of single axes, beside the path: manual moves, references, spindle axes (sections 7 to 9). */
#ifndef CNC872_SINGLE_H
#define CNC872_SINGLE_H

#include <stdbool.h>
#include <stdint.h>

/* What moves an axis by itself. */
enum cnc_single_kind { CNC_SINGLE_NONE, CNC_SINGLE_MANUAL, CNC_SINGLE_REFERENCE, CNC_SINGLE_SPINDLE };

/* A reference of an axis (NH2). */
enum cnc_reference_state {
    CNC_REFERENCE_NONE,
    CNC_REFERENCE_WAITS,     /* for the INIT pass */
    CNC_REFERENCE_SEARCH,    /* in RefDir, for KRx */
    CNC_REFERENCE_STOP,      /* KRx has been seen: to rest */
    CNC_REFERENCE_TO_BACK,   /* KRRx has been seen: to rest */
    CNC_REFERENCE_BACK,      /* against RefDir, until KRx has been 1 and is 0 */
    CNC_REFERENCE_TO_SEARCH, /* KRx has been left: to rest */
    CNC_REFERENCE_ENDS       /* it has failed: to rest */
};
struct cnc_reference {
    uint8_t state;           /* enum cnc_reference_state */
    bool is_slow;            /* after BACK: SEARCH at FeedRef */
    bool was_kr, was_krr;    /* in the T before */
    bool has_seen_kr;        /* in BACK */
    bool by_emergency;       /* ends by STOP EMERGENCY */
    int64_t seen_at;         /* position at which KRx was seen */
};

#endif

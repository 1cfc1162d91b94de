/* SPDX-License-Identifier: MIT */
/* rkm04/readings.h: what the manual leaves open and a real unit may do otherwise than decided here, as settings
 * (docs/SPEC.md, section 10). All zero: the decisions of the specification.
 *
 * Members are named after the readings, with '_' for '-'. Values beyond the range given are not defined. */
#ifndef RKM04_READINGS_H
#define RKM04_READINGS_H

#include <stdint.h>

/* 0: a port without readings. The unit does what is specified whatever the settings are, but for speed_change. */
#ifndef RKM04_READINGS
#define RKM04_READINGS 1
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum rkm04_label { RKM04_LABEL_WAIT, RKM04_LABEL_FAULT };
enum rkm04_fault_exit { RKM04_FAULT_EXIT_RESET, RKM04_FAULT_EXIT_NEW };
enum rkm04_hold_exit { RKM04_HOLD_EXIT_NEW, RKM04_HOLD_EXIT_LATCH };
enum rkm04_x_after { RKM04_X_AFTER_ARMED, RKM04_X_AFTER_ONCE };
enum rkm04_guard_start { RKM04_GUARD_START_NONE, RKM04_GUARD_START_STEP };
enum rkm04_v_alone { RKM04_V_ALONE_BLANKS, RKM04_V_ALONE_FIRST };
enum rkm04_y_eleventh { RKM04_Y_ELEVENTH_RUN, RKM04_Y_ELEVENTH_Y };
enum rkm04_reset_t41 { RKM04_RESET_T41_KEEP, RKM04_RESET_T41_CLEAR };
enum rkm04_negative_position { RKM04_NEGATIVE_POSITION_YES, RKM04_NEGATIVE_POSITION_NO };

/* Whole bytes without gaps: two of them can be compared byte by byte. */
struct rkm04_readings {
    uint8_t label;             /* C7: a jump or call to a label that is not in memory 0 waits for it, 1 is a fault */
    uint8_t fault_exit;        /* C3, E1: a fault lasts 0 until `\`, 1 until new commands begin */
    uint8_t hold_exit;         /* C3: a hold is ended 0 by C75, `\` and new commands, 1 by C75 and `\` alone */
    uint8_t x_after;           /* C6: an X that has fired 0 stays armed, 1 is used up */
    uint8_t guard_start;       /* C5: M or N true when a motion begins: 0 no step, 1 it begins and is stopped in the next slot */
    uint8_t v_alone;           /* C3, C4: V, K, C75 are stand-alone 0 with blanks and comments, 1 as the whole text alone */
    uint8_t y_eleventh;        /* E1: too many Y are an error 0 at R, 1 at the eleventh Y */
    uint8_t reset_t41;         /* C1: `\` 0 leaves T41 alone, 1 switches it off */
    uint8_t negative_position; /* section 5: `=-5` is 0 right, 1 a bad value */
    uint8_t input_filter;      /* U2: ms 0..100, an input counts when it has been constant for this time */
    uint16_t speed_change;     /* C4: ms 0..2000 until a change of speed takes effect */
    uint16_t planning;         /* R1: ms 0..2000 from the slot of a motion's command to that in which it begins */
    uint16_t store_time;       /* P6: ms 0..1000 until Store Flash is answered; no motor executes a command meanwhile */
};

#ifdef __cplusplus
}
#endif

#endif

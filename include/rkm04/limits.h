/* SPDX-License-Identifier: MIT */
/* rkm04/limits.h: the fixed figures of an RKM04 and the compile-time figures of a port.
 *
 * A port may set RKM04_MESSAGE_MAX before it includes any header of the core; library and user must agree on it. */
#ifndef RKM04_LIMITS_H
#define RKM04_LIMITS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Longest request the unit takes, in bytes, 64..9216 (L4). A small port may take 1024. */
#ifndef RKM04_MESSAGE_MAX
#define RKM04_MESSAGE_MAX 9216
#endif

#define RKM04_VERSION "0.1.0"             /* of this library */
#define RKM04_VERSION_TEXT "01.02,06.03.2009" /* what message 1 answers unless configured (manual 5.3.1) */

/* The unit (U1, U2, U4). */
#define RKM04_MOTORS 4
#define RKM04_INPUTS 8             /* DI 01..08 */
#define RKM04_OUTPUTS 8            /* DO 01..08 */
#define RKM04_VARIABLES 16         /* VAR 80..95 */
#define RKM04_FIRST_VARIABLE 80
#define RKM04_NODE_MAX 16          /* DNode 1..16; 0 addresses all */

/* The program of a motor (U5, section 5). */
#define RKM04_PROGRAM_MAX 700      /* commands */
#define RKM04_LABELS 80
#define RKM04_LOOP_LEVELS 8
#define RKM04_CALL_LEVELS 6
#define RKM04_COMMAND_TEXT_MAX 12  /* characters of the longest canonical command, "=-2000000000" */

/* Motion (U3, section 6). */
#define RKM04_SPEED_MAX 16000      /* steps/s */
#define RKM04_START_SPEED_MAX 2000 /* steps/s */
#define RKM04_ACCELERATION_MAX 60000 /* steps/s^2 */
#define RKM04_SEGMENTS_MAX 10      /* of a compound motion */
#define RKM04_COMPOUND_STEPS_MAX 160000000u
#define RKM04_BREAKS_MAX 34        /* break points kept of one motion: 31 of the longest compound, 3 of changes */

/* Time (K1, K2). */
#define RKM04_TICKS_PER_SECOND 1000000u
#define RKM04_SLOT_TICKS 1000u
#define RKM04_PULSE_TICKS 10u      /* width of a pulse (R7) */
#define RKM04_NEVER UINT64_MAX     /* no tick */

/* Flash (U5): two generations of each motor's slot, one block each. */
#define RKM04_FLASH_BLOCKS 8
#define RKM04_FLASH_BLOCK_SIZE 4096

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: MIT */
/* rkm04/limits.h: the fixed figures of an RKM04 and the compile-time figures of a port.
 *
 * A port for a small chip may set the figures below with an #ifndef around them before it includes any header of the core;
 * library and user must agree on them. RAM is that on a Cortex-M3, of struct rkm04_unit. docs/PORTING.md has a table of what
 * fits where. */
#ifndef RKM04_LIMITS_H
#define RKM04_LIMITS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Longest request the unit takes, in bytes, 64..9216 (L4): as many bytes of RAM. A longer one is dropped and counted. */
#ifndef RKM04_MESSAGE_MAX
#define RKM04_MESSAGE_MAX 9216
#endif
#if RKM04_MESSAGE_MAX < 64 || RKM04_MESSAGE_MAX > 9216
#error "RKM04_MESSAGE_MAX: expected 64..9216 bytes"
#endif

/* Motors, 1..4 (U1). One takes 660 bytes, and what the figures below say. Requests for a motor that is not there are refused as
 * those for motor 5 are (P1). */
#ifndef RKM04_MOTORS
#define RKM04_MOTORS 4
#endif
#if RKM04_MOTORS < 1 || RKM04_MOTORS > 4
#error "RKM04_MOTORS: expected 1..4"
#endif

/* Commands in the memory of a motor, 50..700 (U5): 5 bytes each. One more overwrites the oldest, and the answer says so (flag 3,
 * P1). A program in flash that is longer counts as empty. */
#ifndef RKM04_PROGRAM_MAX
#define RKM04_PROGRAM_MAX 700
#endif
#if RKM04_PROGRAM_MAX < 50 || RKM04_PROGRAM_MAX > 700
#error "RKM04_PROGRAM_MAX: expected 50..700 commands"
#endif

/* Segments of a compound motion, 1..10 (U3): 24 bytes each, and three break points. One more is a fault (E1). */
#ifndef RKM04_SEGMENTS_MAX
#define RKM04_SEGMENTS_MAX 10
#endif
#if RKM04_SEGMENTS_MAX < 1 || RKM04_SEGMENTS_MAX > 10
#error "RKM04_SEGMENTS_MAX: expected 1..10"
#endif

/* Break points kept of one motion: 32 bytes each and motor, and 8 of the answer. The longest compound has 3 a segment and 1; a
 * change of the speed on the way needs up to 3 more, else the oldest passed one is forgotten (P7). */
#ifndef RKM04_BREAKS_MAX
#define RKM04_BREAKS_MAX (3 * RKM04_SEGMENTS_MAX + 4)
#endif
#if RKM04_BREAKS_MAX < 3 * RKM04_SEGMENTS_MAX + 4 || RKM04_BREAKS_MAX > 34
#error "RKM04_BREAKS_MAX: expected 3 * RKM04_SEGMENTS_MAX + 4 to 34"
#endif

#define RKM04_VERSION "0.1.0"             /* of this library */
#define RKM04_VERSION_TEXT "01.02,06.03.2009" /* what message 1 answers unless configured (manual 5.3.1) */

/* The unit (U2, U4). */
#define RKM04_INPUTS 8             /* DI 01..08 */
#define RKM04_OUTPUTS 8            /* DO 01..08 */
#define RKM04_VARIABLES 16         /* VAR 80..95 */
#define RKM04_FIRST_VARIABLE 80
#define RKM04_NODE_MAX 16          /* DNode 1..16; 0 addresses all */

/* The program of a motor (section 5). */
#define RKM04_LABELS 80
#define RKM04_LOOP_LEVELS 8
#define RKM04_CALL_LEVELS 6
#define RKM04_COMMAND_TEXT_MAX 12  /* characters of the longest canonical command, "=-2000000000" */

/* Motion (U3, section 6). */
#define RKM04_SPEED_MAX 16000      /* steps/s */
#define RKM04_START_SPEED_MAX 2000 /* steps/s */
#define RKM04_ACCELERATION_MAX 60000 /* steps/s^2 */
#define RKM04_COMPOUND_STEPS_MAX 160000000u

/* Time (K1, K2). */
#define RKM04_TICKS_PER_SECOND 1000000u
#define RKM04_SLOT_TICKS 1000u
#define RKM04_PULSE_TICKS 10u      /* width of a pulse (R7) */
#define RKM04_NEVER UINT64_MAX     /* no tick */

/* Flash (U5): two generations of each motor's slot, one block each. */
#define RKM04_FLASH_BLOCKS (2 * RKM04_MOTORS)
#define RKM04_FLASH_BLOCK_SIZE 4096

#ifdef __cplusplus
}
#endif

#endif

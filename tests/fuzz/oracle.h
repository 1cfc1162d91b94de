/* SPDX-License-Identifier: MIT */
/* oracle.h: what must hold of the pulses of any unit, whatever its programs, inputs and messages are: a port that looks at
 * them as they come, and aborts. */
#ifndef RKM04_TESTS_FUZZ_ORACLE_H
#define RKM04_TESTS_FUZZ_ORACLE_H

#include <rkm04/unit.h>

#define ORACLE_PULSES 128 /* pulses of a motion that are remembered; a power of 2 */

/* What has been seen of one motor. */
struct oracle_motor {
    uint64_t steps, rest;       /* digests: of its pulses, of everything else */
    int32_t position;           /* of the counter, reckoned from pulses and commands */
    bool known;                 /* it could be reckoned */
    uint64_t last_pulse, turned; /* ticks of the last pulse, of the last change of the direction output; 0: none */

    bool moving, whole;         /* between begin and end; all its pulses have been seen */
    uint64_t begin;             /* of the motion, tick */
    int32_t begin_position;
    uint32_t begin_done, count; /* steps done before; pulses since */
    bool jumps;                 /* it may: a change (C4) to a speed up to S is a ramp down to S, then a jump (R6) */
    uint64_t pulse[ORACLE_PULSES]; /* ticks; of pulse n at n % ORACLE_PULSES, the begin as pulse 0 */
    uint16_t speed[RKM04_SEGMENTS_MAX], fastest[RKM04_SEGMENTS_MAX], slowest; /* of its segments: V now, and so far */
    uint8_t guard_m, guard_n;   /* at the begin */
};

/* A unit under observation. It may be copied as a whole and put back. */
struct oracle {
    struct rkm04_unit unit;
    struct oracle_motor motor[RKM04_MOTORS];
    uint64_t common;            /* digest of outputs, variables, answers */
    uint64_t calls;             /* of the port */
    uint64_t switched;          /* tick at which T41 or C41 was executed last */
    uint64_t held_up;           /* tick of the slot before which no motor executes a command (reading `store-time`) */
    bool in_message;            /* a message is being executed */
    uint8_t writers;            /* motors that wrote VAR or T41, also by `\` (reading `reset-t41`): motor 1 in bit 0 */
    uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
};

/* Power up at tick 0; the flash stays. `seen`: pulses are reported, otherwise skipped over. */
void oracle_power_up(struct oracle *oracle, const struct rkm04_config *config, bool seen);

/* Report pulses, or skip over them, from now on. */
void oracle_see_pulses(struct oracle *oracle, bool seen);

/* Let time pass; the counters must be what pulses and commands make of them. */
void oracle_advance(struct oracle *oracle, uint64_t ticks);

/* Obey a message; the answer goes into the digest `into`. Returns its length. */
size_t oracle_exchange(struct oracle *oracle, const uint8_t *message, size_t length, uint64_t *into);

/* Is it Store Flash, of one motor or of all, and not refused? */
bool oracle_is_store(const uint8_t *message, size_t length);

/* Continue with a digest. */
uint64_t oracle_mix(uint64_t digest, uint64_t value);

#endif

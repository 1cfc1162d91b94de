/* SPDX-License-Identifier: MIT */
/* flash_fake.h: a flash in memory that knows the rules of real ones and breaks on demand, for tests.
 *
 * RKM04_FLASH_BLOCKS blocks of RKM04_FLASH_BLOCK_SIZE bytes. An erased byte reads FF. Programming works on units of 8 bytes,
 * each once after an erase, and makes only 0 of 1. A caller that breaks a rule gets an error, counted in `misuse`: a test
 * asserts that it is 0.
 *
 *     flash_fake_init(&flash);
 *     flash_fake_arm(&flash, 3, FLASH_CUT_BITS, seed);    // the third erase or program from now on
 *     ...                                                 // fails, and so does everything after it
 *     flash_fake_power_on(&flash);                        // what a unit finds after the power cut */
#ifndef RKM04_TESTS_FLASH_FAKE_H
#define RKM04_TESTS_FLASH_FAKE_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/limits.h>

#define FLASH_FAKE_UNIT 8 /* bytes programmed together */

/* What goes wrong at the armed operation. FAIL_*: it returns an error and the flash works on; CUT_*: the power goes, nothing
 * works until flash_fake_power_on. */
enum flash_fault {
    FLASH_WELL,
    FLASH_FAIL_NOTHING,  /* nothing happened */
    FLASH_FAIL_TORN,     /* it happened in part, as with FLASH_CUT_BITS */
    FLASH_FAIL_DONE,     /* it happened, and reports an error all the same */
    FLASH_LIE,           /* it happened in part and reports success */
    FLASH_CUT_BEFORE,    /* nothing happened */
    FLASH_CUT_PREFIX,    /* only the first bytes were erased or programmed; how many follows from the seed */
    FLASH_CUT_SUFFIX,    /* only the last ones */
    FLASH_CUT_BITS,      /* some of the bits that had to change did, all over the range */
    FLASH_CUT_GARBAGE,   /* every byte of the range is anything */
    FLASH_CUT_ZEROS,     /* the first bytes are 0, as where a flash programs a block before it erases it */
    FLASH_CUT_FLIPS,     /* all of it happened, and one to eight bits anywhere in the block are wrong */
    FLASH_CUT_AFTER,     /* all of it happened */
    FLASH_FAULTS
};

/* What is wrong with a block for good. */
enum flash_wear {
    FLASH_SOUND,
    FLASH_NO_ERASE,      /* an erase does nothing and reports an error */
    FLASH_HALF_ERASE,    /* an erase does its work in part and reports an error */
    FLASH_NO_PROGRAM,    /* a program does nothing and reports an error */
    FLASH_HALF_PROGRAM,  /* a program does its work in part and reports an error */
    FLASH_STUCK_CELLS,   /* a cell in every 61 bytes, from byte 13 on, stays 0; no error is reported */
    FLASH_WEARS
};

struct flash_fake {
    uint8_t data[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
    bool used[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE / FLASH_FAKE_UNIT]; /* programmed since the last erase */
    bool off;                            /* the power is cut */
    unsigned erases[RKM04_FLASH_BLOCKS]; /* of each block, tried */
    unsigned operations;                 /* erases and programs tried */
    unsigned reads;                      /* reads tried */
    unsigned misuse;                     /* rules broken by the caller */
    unsigned fault_at[2];                /* values of `operations` at which the faults strike; 0 = never */
    enum flash_fault fault[2];
    enum flash_wear wear[RKM04_FLASH_BLOCKS];
    unsigned border;                     /* how many bytes come before the border of PREFIX, SUFFIX and ZEROS; 0: any */
    unsigned read_fault_at;              /* value of `reads` at which one read fails; 0 = never */
    bool read_cuts;                      /* and the power goes with it */
    unsigned length;                     /* bytes of the last erase or program */
    uint32_t random;                     /* decides how far a torn operation went */
};

/* A new, erased flash under power. */
void flash_fake_init(struct flash_fake *flash);

/* Let the n-th (1..) erase or program from now on go wrong; counters begin again. Same seed, same damage. */
void flash_fake_arm(struct flash_fake *flash, unsigned n, enum flash_fault fault, uint32_t seed);

/* A second fault, at the n-th (1..) operation since flash_fake_arm. */
void flash_fake_arm_also(struct flash_fake *flash, unsigned n, enum flash_fault fault);

/* Let the n-th (1..) read from now on fail, or let the power go then. */
void flash_fake_arm_read(struct flash_fake *flash, unsigned n);
void flash_fake_cut_at_read(struct flash_fake *flash, unsigned n);

/* Power comes back; nothing is armed any more. The contents stay as they are. */
void flash_fake_power_on(struct flash_fake *flash);

/* Names for messages. */
const char *flash_fault_name(enum flash_fault fault);
const char *flash_wear_name(enum flash_wear wear);

/* The three port functions; `flash` is a struct flash_fake. 0 = well, 1 = failed. */
int flash_fake_read(void *flash, unsigned block, unsigned offset, void *data, unsigned length);
int flash_fake_erase(void *flash, unsigned block);
int flash_fake_program(void *flash, unsigned block, unsigned offset, const void *data, unsigned length);

#endif

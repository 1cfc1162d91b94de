/* SPDX-License-Identifier: MIT */
/* fuzz.h: what the fuzz targets share: choices made from the bytes of an input, and a way to fail.
 *
 * A target is one file fuzz_NAME.c with LLVMFuzzerTestOneInput(). tools/fuzz builds it with libFuzzer and looks for inputs that
 * make it fail; fuzz_replay.c runs it on the inputs of corpus/NAME, seeds/NAME and regression/NAME in every test run. */
#ifndef RKM04_TESTS_FUZZ_H
#define RKM04_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What must hold whatever the input. Otherwise: say what was seen, and abort. */
#define FUZZ_CHECK(condition, ...)                                                                   \
    do {                                                                                             \
        if (!(condition)) {                                                                          \
            fprintf(stderr, "%s:%d: %s does not hold: ", __FILE__, __LINE__, #condition);            \
            fprintf(stderr, __VA_ARGS__);                                                            \
            fputc('\n', stderr);                                                                     \
            abort();                                                                                 \
        }                                                                                            \
    } while (0)

/* The bytes of an input that are left. Behind the end there are zeros. */
struct fuzz {
    const uint8_t *at;
    size_t left;
};

static inline uint8_t fuzz_byte(struct fuzz *fuzz)
{
    if (fuzz->left == 0)
        return 0;
    fuzz->left--;
    return *fuzz->at++;
}

static inline uint32_t fuzz_number(struct fuzz *fuzz, unsigned bytes)
{
    uint32_t number = 0;
    while (bytes-- > 0)
        number = number << 8 | fuzz_byte(fuzz);
    return number;
}

/* Take up to `most` bytes. Returns where they are; *length: how many. */
static inline const uint8_t *fuzz_take(struct fuzz *fuzz, size_t most, size_t *length)
{
    const uint8_t *at = fuzz->at;
    *length = most < fuzz->left ? most : fuzz->left;
    fuzz->at += *length;
    fuzz->left -= *length;
    return at;
}

/* Take everything up to `stop`, which is passed over, or to the end. */
static inline const uint8_t *fuzz_until(struct fuzz *fuzz, uint8_t stop, size_t *length)
{
    const uint8_t *at = fuzz->at;
    size_t n = 0;
    while (n < fuzz->left && at[n] != stop)
        n++;
    *length = n;
    n += n < fuzz->left;
    fuzz->at += n;
    fuzz->left -= n;
    return at;
}

#endif

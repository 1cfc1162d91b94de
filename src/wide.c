/* SPDX-License-Identifier: MIT */
#include "wide.h"

uint64_t wide_divide(struct wide number, uint64_t divisor, uint64_t *rest)
{
    uint64_t quotient = 0, left = number.high;
    for (unsigned i = 64; i-- > 0;) {
        left = left << 1 | (number.low >> i & 1);
        quotient <<= 1;
        if (left >= divisor) {
            left -= divisor;
            quotient |= 1;
        }
    }
    *rest = left;
    return quotient;
}

struct wide wide_fraction(uint64_t rest, uint64_t divisor, bool *inexact)
{
    struct wide places;
    places.high = wide_divide((struct wide){rest, 0}, divisor, &rest);
    places.low = wide_divide((struct wide){rest, 0}, divisor, &rest);
    *inexact = rest != 0;
    return places;
}

struct wide wide_root(struct wide radicand, unsigned places, bool *inexact)
{
    struct wide root = {0, 0}, rest = {0, 0};
    for (unsigned i = 0; i < 64 + places; i++) {
        /* Digit by digit: two more bits of the radicand, one more of the root. */
        rest = wide_shifted(rest, 2);
        rest.low |= radicand.high >> 62;
        radicand = wide_shifted(radicand, 2);
        struct wide trial = wide_shifted(root, 2);
        trial.low |= 1;
        root = wide_shifted(root, 1);
        if (!wide_less(rest, trial)) {
            rest = wide_difference(rest, trial);
            root.low |= 1;
        }
    }
    *inexact = (rest.high | rest.low) != 0;
    return root;
}

uint32_t wide_root_of(uint32_t number)
{
    uint32_t root = 0;
    for (uint32_t digit = UINT32_C(1) << 30; digit != 0; digit >>= 2) {
        uint32_t trial = root + digit;
        root >>= 1;
        if (number >= trial) {
            number -= trial;
            root += digit;
        }
    }
    return root;
}

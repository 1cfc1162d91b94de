/* SPDX-License-Identifier: MIT */
/* The operations on 128-bit numbers against GMP. */
#include <check.h>
#include <gmp.h>
#include <stdlib.h>

#include "wide.h"

static uint64_t random_state;

/* splitmix64 */
static uint64_t random_number(void)
{
    uint64_t z = random_state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* Of any length, and often with many equal bits, at the ends of a digit too. */
static uint64_t random_digits(void)
{
    uint64_t number = random_number() >> random_number() % 64, kind = random_number() % 8;
    if (kind == 0)
        return number | UINT64_C(0xffffffff) << random_number() % 33;
    if (kind == 1)
        return number & ~(UINT64_C(0xffffffff) << random_number() % 33);
    return kind == 2 ? 0 - (random_number() % 4) - (number & UINT64_C(0xffffffff00000000)) : number;
}

static void set_wide(mpz_t number, struct wide wide)
{
    mpz_set_ui(number, wide.high);
    mpz_mul_2exp(number, number, 64);
    mpz_add_ui(number, number, wide.low);
}

static void expect(const char *what, const mpz_t wanted, struct wide got)
{
    mpz_t number;
    mpz_init(number);
    set_wide(number, got);
    if (mpz_cmp(number, wanted) != 0)
        ck_abort_msg("%s: %016lx %016lx, expected %s", what, got.high, got.low, mpz_get_str(NULL, 16, wanted));
    mpz_clear(number);
}

#define ROUNDS 100000

START_TEST(upper_half_of_a_product)
{
    mpz_t product;
    mpz_init(product);
    for (unsigned i = 0; i < ROUNDS; i++) {
        uint64_t a = random_digits(), b = random_digits();
        mpz_set_ui(product, a);
        mpz_mul_ui(product, product, b);
        expect("product", product, wide_product(a, b));
        ck_assert_uint_eq(wide_high(a, b), wide_product(a, b).high);
        mpz_tdiv_q_2exp(product, product, 40);
        if (mpz_fits_ulong_p(product))
            expect("product / 2^40", product, (struct wide){0, wide_scaled(a, b)});
    }
    mpz_clear(product);
}
END_TEST

START_TEST(quotient_and_remainder)
{
    mpz_t number, quotient;
    mpz_inits(number, quotient, NULL);
    for (unsigned i = 0; i < ROUNDS; i++) {
        uint64_t divisor = random_digits(), rest, left;
        if (divisor == 0)
            continue;
        struct wide of = {random_digits() % divisor, random_digits()};
        if (i % 4 == 0)
            of.high = divisor - 1;
        set_wide(number, of);
        left = mpz_fdiv_q_ui(quotient, number, divisor);
        expect("quotient", quotient, (struct wide){0, wide_divide(of, divisor, &rest)});
        ck_assert_uint_eq(rest, left);
    }
    mpz_clears(number, quotient, NULL);
}
END_TEST

START_TEST(binary_places_of_a_fraction)
{
    mpz_t number;
    mpz_init(number);
    for (unsigned i = 0; i < ROUNDS; i++) {
        uint64_t divisor = random_digits();
        if (divisor == 0)
            continue;
        uint64_t rest = random_digits() % divisor, left;
        bool inexact;
        mpz_set_ui(number, rest);
        mpz_mul_2exp(number, number, 128);
        left = mpz_fdiv_q_ui(number, number, divisor);
        expect("fraction", number, wide_fraction(rest, divisor, &inexact));
        ck_assert_int_eq(inexact, left != 0);
    }
    mpz_clear(number);
}
END_TEST

static void try_root(struct wide radicand, unsigned places)
{
    mpz_t number, root, rest;
    mpz_inits(number, root, rest, NULL);
    set_wide(number, radicand);
    mpz_mul_2exp(number, number, 2 * places);
    mpz_sqrtrem(root, rest, number);
    bool inexact;
    expect("root", root, wide_root(radicand, places, &inexact));
    ck_assert_int_eq(inexact, mpz_sgn(rest) != 0);
    mpz_clears(number, root, rest, NULL);
}

START_TEST(square_root_with_binary_places)
{
    for (unsigned i = 0; i < ROUNDS; i++)
        try_root((struct wide){random_digits() >> 2, random_digits()}, (unsigned)(random_number() % 65));
}
END_TEST

START_TEST(square_root_of_squares_and_their_neighbours)
{
    for (unsigned i = 0; i < ROUNDS / 3; i++) {
        uint64_t root = random_digits() >> 1;
        struct wide square = wide_product(root, root), one = {0, 1};
        unsigned places = (unsigned)(random_number() % 65);
        try_root(square, places);
        try_root(wide_sum(square, one), places);
        if (root > 0)
            try_root(wide_difference(square, one), places);
    }
    try_root((struct wide){UINT64_MAX >> 2, UINT64_MAX}, 64);
    try_root((struct wide){0, 0}, 47);
}
END_TEST

START_TEST(square_root_of_a_whole_number)
{
    for (unsigned i = 0; i < ROUNDS; i++) {
        uint32_t number = (uint32_t)random_digits(), root = wide_root_of(number);
        ck_assert((uint64_t)root * root <= number && (root + UINT64_C(1)) * (root + UINT64_C(1)) > number);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("wide");
    TCase *one = tcase_create("wide");
    tcase_set_timeout(one, 60);
    tcase_add_test(one, upper_half_of_a_product);
    tcase_add_test(one, quotient_and_remainder);
    tcase_add_test(one, binary_places_of_a_fraction);
    tcase_add_test(one, square_root_with_binary_places);
    tcase_add_test(one, square_root_of_squares_and_their_neighbours);
    tcase_add_test(one, square_root_of_a_whole_number);
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: MIT */
/* test_cib_tcp.c: Modbus TCP clients of CIB modules, by the worked example Y13, and what BL6 says. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "core/rig.h"

static const struct cib_port nobody;
static struct cib_unit unit[2];
static struct cib_modules modules;
static struct cib_tcp client;
static uint8_t heard[4096];
static size_t length;

static void hear(void *context, const uint8_t *bytes, size_t count)
{
    (void)context;
    ck_assert_uint_lt(length + count, sizeof heard);
    memcpy(heard + length, bytes, count);
    length += count;
}

static void power_up(unsigned count)
{
    memset(&client, 0, sizeof client);
    length = 0;
    modules = (struct cib_modules){.count = count, .unit = {&unit[0], count > 1 ? &unit[1] : NULL}, .address = {1, 2}};
    for (unsigned i = 0; i < count; i++)
        cib_begin(&unit[i], &cib_default_config, &nobody, NULL);
}

static void begin(void)
{
    power_up(1);
}

static bool send(const uint8_t *bytes, size_t count)
{
    return cib_tcp_receive(&client, &modules, bytes, count, hear, NULL);
}

/* A request for `address` to read the register 30H, and the first `count` bytes of its answer. */
static void expect_read(uint8_t address, const uint8_t *answer, size_t count)
{
    const uint8_t request[] = {0x12, 0x34, 0, 0, 0, 6, address, 4, 0, 0x30, 0, 1};
    length = 0;
    ck_assert(send(request, sizeof request));
    ck_assert_uint_eq(length, count);
    ck_assert_mem_eq(heard, answer, count);
}

static void expect_type_of(uint8_t address)
{
    const uint8_t answer[] = {0x12, 0x34, 0, 0, 0, 5, address, 4, 2, 8, 8};
    expect_read(address, answer, sizeof answer);
}

static void expect_no_unit(uint8_t address)
{
    const uint8_t answer[] = {0x12, 0x34, 0, 0, 0, 3, address, 0x84, 0x0b};
    expect_read(address, answer, sizeof answer);
}

START_TEST(y13_request_and_unknown_unit)
{
    const uint8_t requests[] = {0, 7, 0, 0, 0, 6, 1, 4, 0, 0x10, 0, 7, 0, 8, 0, 0, 0, 6, 9, 4, 0, 0x10, 0, 7};
    const uint8_t answers[] = {0, 7, 0, 0, 0, 0x11, 1, 4, 0x0e, 0, 0, 0, 0x20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                               0, 8, 0, 0, 0, 3, 9, 0x84, 0x0b};
    ck_assert(send(requests, sizeof requests));
    ck_assert_uint_eq(length, sizeof answers);
    ck_assert_mem_eq(heard, answers, sizeof answers);
}
END_TEST

START_TEST(bl6_requests_come_in_pieces)
{
    const uint8_t request[] = {0, 1, 0, 0, 0, 6, 1, 4, 0, 0x30, 0, 1};
    for (size_t i = 0; i < sizeof request; i++) {
        ck_assert_uint_eq(length, 0);
        ck_assert(send(&request[i], 1));
    }
    ck_assert_uint_eq(length, 11);
}
END_TEST

START_TEST(bl6_units_0_and_255_are_the_only_one)
{
    expect_type_of(1);
    expect_type_of(0);
    expect_type_of(255);
    expect_no_unit(2);
    power_up(2);
    expect_type_of(2);
    expect_no_unit(0);
    expect_no_unit(255);
    modules.unit[1] = NULL;
    expect_no_unit(2);
}
END_TEST

START_TEST(bl6_wrong_protocol_or_length_ends_the_connection)
{
    static const uint8_t wrong[][6] = {{0, 1, 0, 1, 0, 6}, {0, 1, 1, 0, 0, 6}, {0, 1, 0, 0, 0, 1}, {0, 1, 0, 0, 0, 0},
                                       {0, 1, 0, 0, 0, 255},
                                       {0, 1, 0, 0, 1, 6}};
    const uint8_t longest[] = {0, 1, 0, 0, 0, 254}, shortest[] = {0, 1, 0, 0, 0, 2, 1, 3};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        begin();
        ck_assert(!send(wrong[i], 6));
    }
    begin();
    ck_assert(send(longest, sizeof longest));
    for (unsigned i = 0; i < 254; i++)
        ck_assert(send((const uint8_t[]){i == 0 ? 1 : 0x50}, 1));
    ck_assert_uint_eq(length, 9);
    begin();
    ck_assert(send(shortest, sizeof shortest));
    ck_assert_mem_eq(heard, ((const uint8_t[]){0, 1, 0, 0, 0, 3, 1, 0x83, 3}), 9);
}
END_TEST

static Suite *tcp_suite(void)
{
    Suite *suite = suite_create("cib_tcp");
    TCase *tcp = tcase_create("tcp");
    tcase_add_checked_fixture(tcp, begin, NULL);
    tcase_add_test(tcp, y13_request_and_unknown_unit);
    tcase_add_test(tcp, bl6_requests_come_in_pieces);
    tcase_add_test(tcp, bl6_units_0_and_255_are_the_only_one);
    tcase_add_test(tcp, bl6_wrong_protocol_or_length_ends_the_connection);
    suite_add_tcase(suite, tcp);
    return suite;
}

int main(void)
{
    return rig_run(tcp_suite(), "./test_cib_tcp");
}

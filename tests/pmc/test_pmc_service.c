/* SPDX-License-Identifier: MIT */
/* test_pmc_service.c: Modbus TCP clients of PMC controllers, in virtual time. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "device/pmc_device.h"
#include "sim/sim.h"

static struct sim sim;
static char heard[256]; /* of the line, in hexadecimal */

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    (void)context;
    for (size_t i = 0; i < length; i++) {
        size_t at = strlen(heard);
        snprintf(heard + at, sizeof heard - at, "%02X", bytes[i]);
    }
}

static void power_up(const char *nodes)
{
    struct sim_config config = {.device = &pmc_2hs_device, .seed = 1, .out = hear};
    heard[0] = '\0';
    ck_assert(node_list_read_up_to(&config.nodes, nodes, PMC_ADDRESS_MAX));
    ck_assert(sim_begin(&sim, &config));
}

static void begin(void)
{
    power_up("1");
}

static void end(void)
{
    sim_end(&sim);
}

static json_t *ask(const char *method, const char *text)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL), *result = sim_command(&sim, method, params, &refusal);
    ck_assert_msg(params && result, "%s %s: %s", method, text, result ? "" : refusal.text);
    json_decref(params);
    return result;
}

static void do_it(const char *method, const char *text)
{
    json_decref(ask(method, text));
}

static void begin_client(void)
{
    do_it("service.open", "{\"service\": \"modbus-tcp\"}");
}

/* Client 1 sends bytes; what it receives, and whether it is connected afterwards. */
static void expect(const char *request, const char *answer, bool open)
{
    char text[600];
    snprintf(text, sizeof text, "{\"client\": 1, \"hex\": \"%s\"}", request);
    json_t *result = ask("service.bytes", text);
    ck_assert_str_eq(json_string_value(json_object_get(result, "sent")), answer);
    ck_assert_int_eq(json_is_true(json_object_get(result, "open")), open);
    json_decref(result);
}

/* A request to read `multiplier` of X. */
static void expect_multiplier_of(const char *unit, const char *answer)
{
    char request[64], expected[64];
    snprintf(request, sizeof request, "000700000006%s03044E0001", unit);
    snprintf(expected, sizeof expected, answer, unit);
    expect(request, expected, true);
}

#define MULTIPLIER "000700000005%s0302000A"
#define NO_TARGET "000700000003%s830B"

START_TEST(the_unit_of_a_request_is_the_address)
{
    begin_client();
    expect_multiplier_of("01", MULTIPLIER);
    expect_multiplier_of("00", MULTIPLIER);
    expect_multiplier_of("FF", MULTIPLIER);
    expect_multiplier_of("02", NO_TARGET);
    expect_multiplier_of("80", NO_TARGET);
    do_it("power", "{\"on\": false}");
    expect_multiplier_of("01", NO_TARGET);
    expect_multiplier_of("FF", NO_TARGET);
    do_it("power", "{\"on\": true}");
    expect_multiplier_of("01", MULTIPLIER);
}
END_TEST

START_TEST(of_two_units_each_has_its_address_alone)
{
    end();
    power_up("3,16");
    begin_client();
    expect_multiplier_of("03", MULTIPLIER);
    expect_multiplier_of("00", NO_TARGET);
    expect_multiplier_of("FF", NO_TARGET);
    expect_multiplier_of("01", NO_TARGET);
    expect("0001 0000 0006 10 06 044E 0010", "0001000000061006044E0010", true);
    expect_multiplier_of("03", MULTIPLIER);
    expect_multiplier_of("10", "000700000005%s03020010");
}
END_TEST

START_TEST(requests_come_in_pieces_and_together)
{
    begin_client();
    expect("0007 0000 00", "", true);
    expect("06 01 03 044E 00", "", true);
    expect("01 0008 0000 0006 01 03 044F 0001 0009", "000700000005010302000A0008000000050103020190", true);
    expect("0000 0006 01 06 0000 0120", "000900000006010600000120", true);
    sim_advance(&sim, 100000);
    expect("000A 0000 0006 01 04 0006 0001", "000A000000050104020001", true);
    expect("000B 0000 0006 01 06 0000 0120", "000B00000003018606", true);
}
END_TEST

START_TEST(a_wrong_head_ends_the_connection)
{
    static const char *const wrong[] = {"0001 0001 0006", "0001 0100", "0001 0000 0001", "0001 0000 00FF", "0001 0000 0106"};
    for (unsigned i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        begin_client();
        expect(wrong[i], "", false);
    }
    begin_client();
    expect("0001 0000 0006 01 03 044E 0001  0001 0001 0006 01 03 044E 0001  0002 0000 0006 01 03 044E 0001",
           "000100000005010302000A", false);
}
END_TEST

/* 250 bytes of data, which the function does not have. */
START_TEST(the_longest_and_the_shortest_request)
{
    char text[600] = "0001 0000 00FE 01 10";
    begin_client();
    for (unsigned i = 0; i < 252; i++)
        strcat(text, "50");
    expect(text, "000100000003019003", true);
    expect("0002 0000 0002 01 03", "000200000003018303", true);
}
END_TEST

/* The line has lines of text, and half of one has come. */
START_TEST(the_line_is_not_disturbed)
{
    begin_client();
    sim_queue_bytes(&sim, (const uint8_t *)"SP", 2, sim_now(&sim));
    sim_finish_tick(&sim);
    expect("0001 0000 0006 01 06 0485 003F", "00010000000601060485003F", true);
    expect("0002 0000 0009 01 10 0484 0001 02 07D0", "000200000006011004840001", true);
    sim_queue_bytes(&sim, (const uint8_t *)"D\r", 2, sim_now(&sim));
    sim_finish_tick(&sim);
    ck_assert_str_eq(heard, "53504420323030302C31300A0D"); /* SPD 2000,10 */
    expect("0003 0000 0006 01 03 0485 0001", "000300000005010302003F", true);
    do_it("pmc.reset", "{}");
    sim_advance(&sim, sim_now(&sim) + 2000);
    expect("0004 0000 0006 01 03 0484 0002", "000400000007010304000A003F", true);
}
END_TEST

static void expect_refusal(const char *method, const char *text, const char *expected)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL), *result = sim_command(&sim, method, params, &refusal);
    json_decref(params);
    ck_assert_msg(!result && strstr(refusal.text, expected), "%s %s: %s", method, text, result ? "accepted" : refusal.text);
}

/* A word that is spelt wrongly would be left out: all axes, or a position instead of a distance. */
START_TEST(methods_refuse_parameters_that_they_do_not_have)
{
    expect_refusal("pmc.move", "{\"x\": 1, \"relativ\": true}", "unknown parameter `relativ': expected x, y, relative, unit");
    expect_refusal("pmc.home", "{\"axis\": \"y\"}", "unknown parameter `axis': expected axes, unit");
    expect_refusal("pmc.reset", "{\"axes\": \"y\"}", "unknown parameter `axes': expected unit");
    expect_refusal("pmc.stop", "{\"axes\": \"z\"}", "axes: expected");
    do_it("pmc.move", "{\"unit\": 1, \"x\": 5, \"relative\": true}");
    do_it("pmc.position", "{\"unit\": 1}");
}
END_TEST

static Suite *service_suite(void)
{
    Suite *suite = suite_create("pmc_service");
    TCase *tcp = tcase_create("tcp");
    tcase_add_checked_fixture(tcp, begin, end);
    tcase_add_test(tcp, the_unit_of_a_request_is_the_address);
    tcase_add_test(tcp, of_two_units_each_has_its_address_alone);
    tcase_add_test(tcp, requests_come_in_pieces_and_together);
    tcase_add_test(tcp, a_wrong_head_ends_the_connection);
    tcase_add_test(tcp, the_longest_and_the_shortest_request);
    tcase_add_test(tcp, the_line_is_not_disturbed);
    tcase_add_test(tcp, methods_refuse_parameters_that_they_do_not_have);
    suite_add_tcase(suite, tcp);
    return suite;
}

int main(void)
{
    return rig_run(service_suite(), "./test_pmc_service");
}

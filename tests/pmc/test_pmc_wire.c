/* SPDX-License-Identifier: MIT */
/* test_pmc_wire.c: a PMC on a line whose bytes take time: both directions at once, bytes without a stop bit. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "device/pmc_device.h"
#include "sim/sim.h"

#define BYTE 1042u /* us at 9600 baud, rounded up */

static struct sim sim;
static char heard[512];
static uint64_t last; /* us at which the last byte was received */

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    size_t at = strlen(heard);
    (void)context;
    ck_assert_uint_lt(at + length, sizeof heard);
    memcpy(heard + at, bytes, length);
    heard[at + length] = '\0';
    last = sim_now(&sim);
}

static void power_up(const char *face, bool timed)
{
    struct sim_config config = {.device = &pmc_2hs_device, .seed = 1, .out = hear, .timed = timed, .turnaround = 1};
    char error[DEVICE_ERROR_SIZE];
    heard[0] = '\0';
    ck_assert(device_option_named(&pmc_2hs_device, "face")->read(&config.unit, face, error));
    ck_assert(node_list_read_up_to(&config.nodes, "1", PMC_ADDRESS_MAX));
    ck_assert(sim_begin(&sim, &config));
}

static void end(void)
{
    sim_end(&sim);
}

static void send(const char *bytes, size_t length)
{
    sim_queue_bytes(&sim, (const uint8_t *)bytes, length, sim_now(&sim));
}

static json_t *ask(const char *method, const char *text)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL), *result = sim_command(&sim, method, params, &refusal);
    ck_assert_msg(params && result, "%s %s: %s", method, text, result ? "" : refusal.text);
    json_decref(params);
    return result;
}

/* A number of `state`, in the object `group`. */
static json_int_t number_of(const char *group, const char *name)
{
    json_t *state = ask("state", "{}");
    json_int_t number = json_integer_value(json_object_get(json_object_get(state, group), name));
    json_decref(state);
    return number;
}

/* VER has come at 4167 us, and its answer of 18 bytes goes out until 22 918; SPD 77 has come at 11 459, POS at 15 625. */
START_TEST(AS1_lines_come_while_an_answer_goes_out)
{
    power_up("ascii", true);
    send("VER\rSPD 77\rPOS\r", 15);
    sim_advance(&sim, 11400);
    ck_assert_uint_eq(pmc_in(sim_core(&sim, 1))->axis[0].speed, 10);
    sim_advance(&sim, 11500);
    ck_assert_uint_eq(pmc_in(sim_core(&sim, 1))->axis[0].speed, 77);
    sim_advance(&sim, 24000);
    ck_assert(strncmp(heard, "VER PMC-2HS 1.00\n\r", 18) == 0);
    sim_advance(&sim, 100000);
    ck_assert_str_eq(heard, "VER PMC-2HS 1.00\n\rPOS 00000000,00000000\r");
    ck_assert_uint_le(last, 4167 + 40 * BYTE + 10);
    ck_assert_int_eq(number_of("line", "collisions"), 0);
    ck_assert_int_eq(number_of("line", "bytes"), 15 + 40);
    ck_assert_int_eq(number_of("line", "overruns"), 0);
}
END_TEST

/* Frames of Modbus go over one pair of wires: what the host sends into an answer collides with it. */
START_TEST(AB1_frames_of_modbus_collide)
{
    power_up("modbus", true);
    send("\x01\x03\x04\x4E\x00\x08\x25\x2B", 8);
    sim_advance(&sim, 14000);
    send("\x55\x55", 2);
    sim_advance(&sim, 100000);
    ck_assert_int_gt(number_of("line", "collisions"), 0);
}
END_TEST

START_TEST(AS4_a_byte_without_a_stop_bit_spoils_its_line)
{
    power_up("ascii", true);
    send("PO", 2);
    sim_advance(&sim, 5000);
    json_decref(ask("fault.inject", "{\"kind\": \"break\", \"duration\": \"1500us\", \"count\": 1}"));
    sim_advance(&sim, 10000);
    ck_assert_int_gt(number_of("line", "framing_errors"), 0);
    send("S\r", 2);
    sim_advance(&sim, 50000);
    ck_assert_str_eq(heard, "");
    ck_assert_int_eq(number_of("ignored", "line"), 1);
    ck_assert_int_eq(number_of("counters", "dropped"), 1);
    send("POS\r", 4);
    sim_advance(&sim, 100000);
    ck_assert_str_eq(heard, "POS 00000000,00000000\r");
    ck_assert_int_eq(number_of("ignored", "line"), 1);
}
END_TEST

/* The unit's answer is disturbed: the unit does not receive what it sends. */
START_TEST(AS4_a_disturbed_answer_is_no_line)
{
    power_up("ascii", true);
    json_decref(ask("fault.inject", "{\"kind\": \"break\", \"duration\": \"1500us\", \"count\": 1, \"after\": \"9ms\"}"));
    send("POS\r", 4);
    sim_advance(&sim, 50000);
    ck_assert_int_eq(strncmp(heard, "POS ", 4), 0);
    ck_assert_uint_lt(strlen(heard), 22);
    send("\rPOS\r", 5);
    sim_advance(&sim, 100000);
    ck_assert_ptr_nonnull(strstr(heard, "POS 00000000,00000000\r"));
}
END_TEST

/* The silence of a frame is not over when such a byte comes, and the frame behind it is a part of it. */
START_TEST(AB1_a_byte_without_a_stop_bit_spoils_its_frame)
{
    power_up("modbus", true);
    json_decref(ask("fault.inject", "{\"kind\": \"break\", \"duration\": \"1200us\", \"count\": 1}"));
    sim_advance(&sim, 1500);
    send("\x01\x03\x04\x4E\x00\x08\x25\x2B", 8);
    sim_advance(&sim, 50000);
    ck_assert_str_eq(heard, "");
    ck_assert_int_eq(number_of("counters", "dropped"), 1);
}
END_TEST

/* Where bytes take no time a line that is held at 0 makes each byte one without a stop bit. */
START_TEST(AS4_the_same_where_bytes_take_no_time)
{
    power_up("ascii", false);
    json_decref(ask("fault.inject", "{\"kind\": \"break\", \"duration\": \"5ms\", \"count\": 1}"));
    sim_advance(&sim, 1000);
    send("POS", 3);
    sim_advance(&sim, 10000);
    send("\r", 1);
    sim_advance(&sim, 20000);
    ck_assert_str_eq(heard, "");
    ck_assert_int_eq(number_of("ignored", "line"), 1);
}
END_TEST

/* AX60 on demand: the injected fault `delay`, once, at any time. */
START_TEST(AS6_the_next_answer_is_late)
{
    power_up("ascii", true);
    send("POS\r", 4);
    sim_advance(&sim, 100000);
    json_decref(ask("fault.inject", "{\"kind\": \"delay\", \"delay\": \"2500ms\", \"count\": 1}"));
    heard[0] = '\0';
    send("POS\r", 4);
    sim_advance(&sim, 2600000);
    ck_assert_str_eq(heard, "");
    sim_advance(&sim, 2700000);
    ck_assert_str_eq(heard, "POS 00000000,00000000\r");
    ck_assert_uint_ge(last, 100000 + 2500000 + 26 * (BYTE - 1));
    heard[0] = '\0';
    send("POS\r", 4);
    sim_advance(&sim, 2800000);
    ck_assert_str_eq(heard, "POS 00000000,00000000\r");
}
END_TEST

/* A unit without power notices nothing; it begins anew. */
START_TEST(AS4_not_without_power)
{
    power_up("ascii", true);
    json_decref(ask("power", "{\"on\": false}"));
    json_decref(ask("fault.inject", "{\"kind\": \"break\", \"duration\": \"5ms\", \"count\": 1}"));
    sim_advance(&sim, 20000);
    json_decref(ask("power", "{\"on\": true}"));
    send("POS\r", 4);
    sim_advance(&sim, 60000);
    ck_assert_str_eq(heard, "POS 00000000,00000000\r");
    ck_assert_int_eq(number_of("ignored", "line"), 0);
}
END_TEST

static Suite *wire_suite(void)
{
    Suite *suite = suite_create("pmc_wire");
    TCase *wire = tcase_create("wire");
    tcase_add_checked_fixture(wire, NULL, end);
    tcase_add_test(wire, AS1_lines_come_while_an_answer_goes_out);
    tcase_add_test(wire, AB1_frames_of_modbus_collide);
    tcase_add_test(wire, AS4_a_byte_without_a_stop_bit_spoils_its_line);
    tcase_add_test(wire, AS4_a_disturbed_answer_is_no_line);
    tcase_add_test(wire, AB1_a_byte_without_a_stop_bit_spoils_its_frame);
    tcase_add_test(wire, AS4_the_same_where_bytes_take_no_time);
    tcase_add_test(wire, AS4_not_without_power);
    tcase_add_test(wire, AS6_the_next_answer_is_late);
    suite_add_tcase(suite, wire);
    return suite;
}

int main(void)
{
    return rig_run(wire_suite(), "./test_pmc_wire");
}

/* SPDX-License-Identifier: MIT */
/* test_cnc872_plc.c: what an author sees of a PLC program that runs (cnc.plc): values beside its lines, where it waits or has
 * halted, how long its calls are. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "fake_rig.h"

static struct fake_rig rig;

static const char text[] =
    "plc=DATA\n"                         /* 1 */
    "READY BIT 1\n"                      /* 2 */
    "PAUSE DW 7\n"                       /* 3 */
    "DATA_END\n"                         /* 4 */
    "MODULE_BLOCK_INIT\n"                /* 5 */
    " FL 1,CLAMP\n"                      /* 6 */
    " EX\n"                              /* 7 */
    " LDR STOPPI\n"                      /* 8 */
    "HERE: EX0 ; \xE1\n"                 /* 9, Latin-1 */
    "MODULE_BLOCK_INIT_END\r\n"          /* 10 */
    "MODULE_MAIN\n"                      /* 11 */
    " LOD REAL.rAxGParabAccel\n"         /* 12 */
    " MOV BX,CNST.300\n"                 /* 13 */
    " LDR BLK[BX].M3\n"                  /* 14 */
    " LOD CNST.5\n"                      /* 15 */
    "MECH_BEGIN CLAMP\n"                 /* 16 */
    " LDR READY\n"                       /* 17 */
    " CA\n"                              /* 18 */
    " TEX0 PAUSE,100,HALT,15h\n"         /* 19 */
    "HALT: JUM HALT\n"                   /* 20 */
    "MECH_END CLAMP\n"                   /* 21 */
    "MODULE_MAIN_END";                   /* 22 */

static void begin(void)
{
    fake_rig_begin_as(&rig, &cnc872_device, text, "1", true);
}

static void end(void)
{
    fake_rig_end(&rig);
}

static void do_turns(uint64_t k)
{
    sim_advance(&rig.sim, k * 1000 + 1);
}

static void expect_plc(const char *params, const char *wanted)
{
    json_t *result = fake_rig_command(&rig, "cnc.plc", params);
    char *found = json_dumps(result, JSON_COMPACT);
    ck_assert_msg(strstr(found, wanted) != NULL, "%s: %s, expected %s", params, found, wanted);
    free(found);
    json_decref(result);
}

START_TEST(lines_have_the_values_of_their_cells)
{
    do_turns(2);
    expect_plc("{\"first\": 2, \"lines\": 2}", "\"listing\":[{\"line\":2,\"text\":\"READY BIT 1\",\"value\":1},"
                                                "{\"line\":3,\"text\":\"PAUSE DW 7\",\"value\":7}]");
    expect_plc("{\"first\": 9, \"lines\": 2}", "[{\"line\":9,\"text\":\"HERE: EX0 ; ?\"},"
                                                "{\"line\":10,\"text\":\"MODULE_BLOCK_INIT_END\"}]");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"rAxGParabAccel\": 2.5, \"READY\": 0, \"PAUSE\": 3, \"REQ_PARABACCEL\": 1}}");
    expect_plc("{\"first\": 12, \"lines\": 3}", "[{\"line\":12,\"text\":\" LOD REAL.rAxGParabAccel\",\"value\":2.5},"
                                                 "{\"line\":13,\"text\":\" MOV BX,CNST.300\"},"
                                                 "{\"line\":14,\"text\":\" LDR BLK[BX].M3\",\"value\":0}]");
    expect_plc("{\"first\": 17, \"lines\": 3}", "[{\"line\":17,\"text\":\" LDR READY\",\"value\":0},"
                                                 "{\"line\":18,\"text\":\" CA\"},"
                                                 "{\"line\":19,\"text\":\" TEX0 PAUSE,100,HALT,15h\",\"value\":3}]");
    expect_plc("{\"first\": 22}", "\"listing\":[{\"line\":22,\"text\":\"MODULE_MAIN_END\"}]");
    expect_plc("{\"first\": 23}", "\"listing\":[]");
    expect_plc("{\"lines\": 0}", "\"t\":2,\"lines\":22,\"halted\":null,\"waits\":[],");
    expect_plc("{}", "\"dr\":5,\"dr_real\":0.0,\"bx\":300,");
}
END_TEST

START_TEST(it_shows_where_sections_and_mechanisms_wait)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X1 F1000\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(2);
    expect_plc("{}", "\"waits\":[{\"name\":\"MODULE_BLOCK_INIT\",\"line\":7},{\"name\":\"CLAMP\",\"line\":19}]");
    expect_plc("{}", "\"calls\":{\"MODULE_MAIN\":{\"last\":9,\"most\":9},\"MODULE_BLOCK_INIT\":{\"last\":2,\"most\":2}}");
    do_turns(5);
    expect_plc("{}", "\"waits\":[{\"name\":\"MODULE_BLOCK_INIT\",\"line\":9},{\"name\":\"CLAMP\",\"line\":19}]");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"CLAMP\": 0}}");
    do_turns(6);
    expect_plc("{}", "\"waits\":[{\"name\":\"MODULE_BLOCK_INIT\",\"line\":9}]");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"STOPPI\": 1}}");
    do_turns(7);
    expect_plc("{}", "\"waits\":[],\"calls\":{\"MODULE_MAIN\":{\"last\":6,\"most\":9},\"MODULE_BLOCK_INIT\":{\"last\":3");
}
END_TEST

START_TEST(it_shows_where_the_program_has_halted)
{
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"CLAMP\": 1}}");
    do_turns(92);
    expect_plc("{}", "\"halted\":null,");
    do_turns(93);
    expect_plc("{}", "\"halted\":20,\"waits\":[],");
    expect_plc("{}", "\"MODULE_MAIN\":{\"last\":100000,\"most\":100000}");
    fake_rig_do(&rig, "cnc.load", "{\"plc\": \"MODULE_MAIN\\nMODULE_MAIN_END\"}");
    do_turns(94);
    expect_plc("{}", "\"lines\":2,\"halted\":null,\"waits\":[],\"calls\":{\"MODULE_MAIN\":{\"last\":1,\"most\":1}}");
}
END_TEST

START_TEST(what_cannot_be_shown_is_refused)
{
    fake_rig_expect_refusal(&rig, "cnc.plc", "{\"first\": 0}", "first: expected a whole number from 1");
    fake_rig_expect_refusal(&rig, "cnc.plc", "{\"lines\": 501}", "lines: expected a whole number from 0 to 500");
    fake_rig_expect_refusal(&rig, "cnc.plc", "{\"line\": 1}", "unknown parameter `line'");
    fake_rig_end(&rig);
    fake_rig_begin_as(&rig, &cnc872_device, NULL, "1", true);
    fake_rig_expect_refusal(&rig, "cnc.plc", "{}", "no PLC program is loaded");
}
END_TEST

static Suite *cnc872_plc_suite(void)
{
    Suite *suite = suite_create("cnc872_plc");
    TCase *tests = tcase_create("cnc872");
    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, lines_have_the_values_of_their_cells);
    tcase_add_test(tests, it_shows_where_sections_and_mechanisms_wait);
    tcase_add_test(tests, it_shows_where_the_program_has_halted);
    tcase_add_test(tests, what_cannot_be_shown_is_refused);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    return rig_run(cnc872_plc_suite(), "./test_cnc872_plc");
}

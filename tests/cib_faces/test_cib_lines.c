/* SPDX-License-Identifier: MIT */
/* test_cib_lines.c: PLCComS clients of CIB modules, by the worked examples Z1-Z4, and what BN1-BN6 say. */
#include <check.h>
#include <rkm04/limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "core/rig.h"

#define CLIENTS 3u

static const struct cib_port nobody;
static struct cib_unit unit[2];
static struct cib_modules modules;
static struct cib_lines client[CLIENTS];
static char heard[CLIENTS][65536];

static void hear(void *context, const char *text, size_t length)
{
    char *all = context;
    size_t used = strlen(all);
    ck_assert_uint_lt(used + length, sizeof heard[0]);
    memcpy(all + used, text, length);
    all[used + length] = '\0';
}

static void power_up(unsigned count)
{
    memset(client, 0, sizeof client);
    memset(heard, 0, sizeof heard);
    modules = (struct cib_modules){.count = count, .unit = {&unit[0], count > 1 ? &unit[1] : NULL}, .address = {1, 17}};
    for (unsigned i = 0; i < count; i++)
        cib_begin(&unit[i], &cib_default_config, &nobody, NULL);
}

static void begin(void)
{
    power_up(1);
}

static void send_bytes(unsigned number, const char *bytes, size_t length)
{
    const struct cib_lines_out out = {.put = hear, .context = heard[number]};
    cib_lines_receive(&client[number], &modules, (const uint8_t *)bytes, length, &out);
}

static void say(unsigned number, const char *line)
{
    send_bytes(number, line, strlen(line));
    send_bytes(number, "\r\n", 2);
}

/* Whatever the client has received since the last call. */
static void expect_heard(unsigned number, const char *expected)
{
    ck_assert_str_eq(heard[number], expected);
    heard[number][0] = '\0';
}

static void expect(const char *line, const char *answer)
{
    say(0, line);
    expect_heard(0, answer);
}

/* Do the ticks before `tick`, and look at the end of each that is a multiple of 100 000, as the server does. */
static void to(uint64_t tick)
{
    while (cib_now(&unit[0]) < tick) {
        uint64_t look = cib_now(&unit[0]) / CIB_LINES_PERIOD * CIB_LINES_PERIOD + 1;
        if (look <= cib_now(&unit[0]))
            look += CIB_LINES_PERIOD;
        for (unsigned i = 0; i < modules.count; i++)
            cib_advance(&unit[i], (look < tick ? look : tick) - cib_now(&unit[i]));
        for (unsigned i = 0; i < CLIENTS && cib_now(&unit[0]) == look; i++)
            cib_lines_report_changes(&client[i], &modules, &(struct cib_lines_out){.put = hear, .context = heard[i]});
    }
}

static void move_by_minus_3(void)
{
    expect("SET:CIB1.MCA.P1,-3", "DIFF:CIB1.MCA.P1,-3\r\n");
    expect("SET:CIB1.MCA.P2,100", "DIFF:CIB1.MCA.P2,100\r\n");
    expect("SET:CIB1.MCA.CMD,102", "DIFF:CIB1.MCA.CMD,102\r\n");
    expect("SET:CIB1.MCA.SEQ,1", "DIFF:CIB1.MCA.SEQ,1\r\n");
}

/* ---- Worked examples ---------------------------------------------------------------------------------------------------- */

START_TEST(z1_get)
{
    expect("GET:CIB1.MCA.MCSTAT", "GET:CIB1.MCA.MCSTAT,32\r\n");
    expect("get:cib1.mca.p*", "GET:CIB1.MCA.P2,0\r\nGET:CIB1.MCA.P1,0\r\nGET:CIB1.MCA.POS,0\r\nGET:\r\n");
}
END_TEST

START_TEST(z2_motion)
{
    to(60000);
    move_by_minus_3();
    to(91000);
    expect("GET:CIB1.MCA.POS", "GET:CIB1.MCA.POS,-3\r\n");
}
END_TEST

START_TEST(z3_changes_are_told_at_the_end_of_each_tenth_of_a_second)
{
    to(50000);
    expect("EN:CIB1.MCA.TRG", "WARNING:252 Changed active variables in public file: '[2/58]'\r\n");
    to(60000);
    move_by_minus_3();
    to(100000);
    expect_heard(0, "");
    to(100001);
    expect_heard(0, "DIFF:CIB1.MCA.TRG,1\r\n");
    to(195000);
    expect("SET:CIB1.MCA.SEQ,2", "DIFF:CIB1.MCA.SEQ,2\r\n");
    to(200000);
    expect_heard(0, "");
    to(200001);
    expect_heard(0, "DIFF:CIB1.MCA.TRG,0\r\n");
    to(300001);
    expect_heard(0, "DIFF:CIB1.MCA.TRG,1\r\n");
    to(1000000);
    expect_heard(0, "");
}
END_TEST

START_TEST(z4_errors)
{
    static const char *const pairs[][2] = {
        {"GET:test", "ERROR:33 Unknown variable name in request: 'GET:test'\r\n"},
        {"FOO:1", "ERROR:32 Unknown command name in request: 'FOO:1'\r\n"},
        {"hello", "ERROR:30 Bad client request: 'hello'\r\n"},
        {"SET:CIB1.DO,256", "ERROR:35 Wrong parameter value in request: 'SET:CIB1.DO,256'\r\n"},
        {"SET:CIB1.DI,1", "ERROR:21 Unable to send data to PLC.\r\n"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        begin();
        expect(pairs[i][0], pairs[i][1]);
    }
}
END_TEST

/* ---- Lines -------------------------------------------------------------------------------------------------------------- */

START_TEST(bn1_lines_end_with_lf_or_crlf_and_come_in_pieces)
{
    send_bytes(0, "GET:CIB1.", 9);
    send_bytes(0, "DO\nGE", 5);
    expect_heard(0, "GET:CIB1.DO,0\r\n");
    send_bytes(0, "T:CIB1.DI\r\n", 11);
    expect_heard(0, "GET:CIB1.DI,0\r\n");
    expect("", "");
    expect("  GET :  CIB1.DO\t", "GET:CIB1.DO,0\r\n");
}
END_TEST

START_TEST(bn1_a_line_without_colon_names_another_variable)
{
    expect("GET:CIB1.DO", "GET:CIB1.DO,0\r\n");
    expect("cib1.di", "GET:CIB1.DI,0\r\n");
    expect("nothing", "ERROR:33 Unknown variable name in request: 'nothing'\r\n");
    expect("FOO:1", "ERROR:32 Unknown command name in request: 'FOO:1'\r\n");
    expect("cib1.do", "GET:CIB1.DO,0\r\n");
    expect("SET:CIB1.PWM1,5", "DIFF:CIB1.PWM1,5\r\n");
    expect("CIB1.PWM2,6", "DIFF:CIB1.PWM2,6\r\n");
    expect("EN:*", "WARNING:252 Changed active variables in public file: '[58/58]'\r\n");
    expect("DI:CIB1.DO", "WARNING:252 Changed active variables in public file: '[57/58]'\r\n");
    expect("CIB1.DI", "WARNING:252 Changed active variables in public file: '[56/58]'\r\n");
}
END_TEST

START_TEST(bn1_a_line_has_1024_bytes_at_most)
{
    char line[1025];
    memset(line, 'x', sizeof line);
    memcpy(line, "GET:", 4);
    send_bytes(0, line, 1024);
    send_bytes(0, "\r\n", 2);
    ck_assert_str_eq(strchr(heard[0], '\'') + 1022, "xxx'\r\n"); /* it is shown whole */
    heard[0][0] = '\0';
    send_bytes(0, line, 1025);
    send_bytes(0, "\n", 1);
    expect_heard(0, "ERROR:31 Incomplete client request.\r\n");
}
END_TEST

START_TEST(bn1_a_longer_line_is_refused_whole)
{
    char line[3000];
    memset(line, 'x', sizeof line);
    send_bytes(0, line, sizeof line);
    expect_heard(0, "");
    send_bytes(0, "\n", 1);
    expect_heard(0, "ERROR:31 Incomplete client request.\r\n");
    expect("GET:CIB1.DO", "GET:CIB1.DO,0\r\n");
}
END_TEST

/* ---- Variables ---------------------------------------------------------------------------------------------------------- */

START_TEST(bn2_the_list_has_every_variable_with_its_type)
{
    static const char *const some[] = {
        "LIST:__PLC_RUN,BOOL\r\n", "LIST:CIB1.DI,UINT*\r\n", "LIST:CIB1.DRIVEN,UINT*\r\n", "LIST:CIB1.DO8,BOOL*\r\n",
        "LIST:CIB1.PWM8,UINT*\r\n", "LIST:CIB1.MCA.P1,DINT*\r\n", "LIST:CIB1.MCB.VEL,INT*\r\n", "LIST:CIB1.MCB.INVEL,BOOL*\r\n"};
    unsigned lines = 0;
    say(0, "LIST:");
    for (size_t i = 0; i < sizeof some / sizeof *some; i++)
        ck_assert_msg(strstr(heard[0], some[i]) != NULL, "%s", some[i]);
    for (const char *at = heard[0]; (at = strchr(at, '\n')) != NULL; at++)
        lines++;
    ck_assert_uint_eq(lines, 59);
    ck_assert_str_eq(strrchr(heard[0], 'L'), "LIST:\r\n");
}
END_TEST

/* Every name, in the order in which lists have them, and the register that it is. */
START_TEST(bn2_names_are_in_their_order)
{
    static const char *const plain[] = {"DI", "DO", "DRIVEN"}, *const of_drive[] = {
        "SEQ", "CMD", "P2", "P1", "ACK", "MCSTAT", "MCERR", "ROW", "MOVE", "DIR", "INVEL", "TRG", "ERR", "POS", "VEL"};
    static const char *const eight[] = {"DI", "DO", "PWM"};
    char expected[4096] = "GET:__PLC_RUN,", *at = expected + strlen(expected);
    say(0, "GET:");
    char *got = heard[0];
    for (char *value = got; (value = strchr(value, ',')) != NULL; value++) { /* leave the names alone */
        const char *next = strchr(value, '\n') + 1;
        memmove(value + 1, next, strlen(next) + 1);
    }
    for (size_t i = 0; i < 3; i++)
        at += sprintf(at, "GET:CIB1.%s,", plain[i]);
    for (size_t i = 0; i < 3; i++)
        for (int n = 1; n <= 8; n++)
            at += sprintf(at, "GET:CIB1.%s%d,", eight[i], n);
    for (int drive = 'A'; drive <= 'B'; drive++)
        for (size_t i = 0; i < sizeof of_drive / sizeof *of_drive; i++)
            at += sprintf(at, "GET:CIB1.MC%c.%s,", drive, of_drive[i]);
    strcpy(at, "GET:\r\n");
    expect_heard(0, expected);
}
END_TEST

START_TEST(bn2_drives_have_their_own_registers)
{
    expect("SET:CIB1.MCB.P2,77", "DIFF:CIB1.MCB.P2,77\r\n");
    expect("SET:CIB1.MCA.P1,-2", "DIFF:CIB1.MCA.P1,-2\r\n");
    ck_assert_uint_eq(cib_read(&unit[0], CIB_OUTPUT_ZONE, 0x24), 77);
    ck_assert_uint_eq(cib_read(&unit[0], CIB_OUTPUT_ZONE, 0x14), 0);
    ck_assert_uint_eq(cib_read(&unit[0], CIB_OUTPUT_ZONE, 0x12), 0xffff);
    ck_assert_uint_eq(cib_read(&unit[0], CIB_OUTPUT_ZONE, 0x13), 0xfffe);
    modules.address[0] = 100;
    expect("GET:*B.P2", "GET:CIB100.MCB.P2,77\r\nGET:\r\n");
}
END_TEST

START_TEST(bn2_names_of_several_modules_have_their_addresses)
{
    power_up(2);
    expect("SET:CIB17.PWM3,77", "DIFF:CIB17.PWM3,77\r\n");
    expect("GET:*.PWM3", "GET:CIB1.PWM3,0\r\nGET:CIB17.PWM3,77\r\nGET:\r\n");
    expect("EN:__PLC_RUN", "WARNING:252 Changed active variables in public file: '[1/115]'\r\n");
    modules.unit[1] = NULL; /* no power */
    expect("GET:CIB17.PWM3", "GET:CIB17.PWM3,0\r\n");
    expect("SET:CIB17.PWM3,1", "ERROR:21 Unable to send data to PLC.\r\n");
}
END_TEST

START_TEST(bn3_patterns)
{
    expect("GET:*nothing*", "GET:\r\n");
    expect("GET:*RUN", "GET:__PLC_RUN,1\r\nGET:\r\n");
    expect("GET:*RUN**", "GET:__PLC_RUN,1\r\nGET:\r\n");
    expect("GET:__PLC{*", "GET:\r\n");
    expect("GET:*1.MC*.E*R", "GET:CIB1.MCA.ERR,0\r\nGET:CIB1.MCB.ERR,0\r\nGET:\r\n");
    expect("LIST:*.ROW", "LIST:CIB1.MCA.ROW,UINT*\r\nLIST:CIB1.MCB.ROW,UINT*\r\nLIST:\r\n");
    expect("LIST:x", "ERROR:33 Unknown variable name in request: 'LIST:x'\r\n");
}
END_TEST

/* Also past the lines, which ask whether a variable can be set first. */
START_TEST(bn4_variables_take_nothing_that_is_not_theirs)
{
    static const int64_t numbers[] = {INT64_MIN, -1, 2, INT64_MAX};
    for (unsigned variable = 0; variable < cib_variables(&modules); variable++) {
        const bool is_open = cib_variable_is_open(&modules, variable), is_bit = cib_variable_is_bit(variable);
        ck_assert(strcmp(cib_variable_type(variable), "BOOL") == 0 ? is_bit : !is_bit);
        const int32_t before = cib_variable_value(&modules, variable);
        for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
            if (is_open && !is_bit && (numbers[i] == 2 || numbers[i] == -1))
                continue;
            ck_assert_int_eq(cib_variable_set(&modules, variable, numbers[i]), is_open ? CIB_SET_VALUE : CIB_SET_READ_ONLY);
            ck_assert_int_eq(cib_variable_value(&modules, variable), before);
        }
    }
}
END_TEST

START_TEST(bn5_a_delta_is_a_number_up_to_32_bits)
{
    static const char *const wrong[] = {"-1", "4294967296", "x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char line[64], answer[128];
        snprintf(line, sizeof line, "EN:CIB1.MCA.POS %s", wrong[i]);
        snprintf(answer, sizeof answer, "ERROR:35 Wrong parameter value in request: '%s'\r\n", line);
        expect(line, answer);
    }
    expect("EN:CIB1.MCA.POS 4294967295", "WARNING:252 Changed active variables in public file: '[2/58]'\r\n");
}
END_TEST

START_TEST(bn4_values_are_checked)
{
    static const char *const wrong[] = {"CIB1.PWM1,10001", "CIB1.PWM1,-1", "CIB1.PWM1,", "CIB1.PWM1", "CIB1.PWM1,1x",
                                        "CIB1.DO1,2", "CIB1.MCA.CMD,65536", "CIB1.MCA.P1,2147483648", "CIB1.MCA.P1,--1",
                                        "CIB1.PWM1,true", "CIB1.MCA.P1,99999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char line[64], answer[128];
        snprintf(line, sizeof line, "SET:%s", wrong[i]);
        snprintf(answer, sizeof answer, "ERROR:35 Wrong parameter value in request: '%s'\r\n", line);
        expect(line, answer);
    }
    expect("SET:CIB1.MCA.P1,-2147483648", "DIFF:CIB1.MCA.P1,-2147483648\r\n");
    expect("SET:CIB1.MCA.P1,+2147483647", "DIFF:CIB1.MCA.P1,2147483647\r\n");
    expect("SET:CIB1.DO3,TRUE", "DIFF:CIB1.DO3,1\r\n");
    expect("SET:CIB1.DO1,1", "DIFF:CIB1.DO1,1\r\n");
    expect("GET:CIB1.DO", "GET:CIB1.DO,5\r\n");
    expect("SET:CIB1.DO3,false", "DIFF:CIB1.DO3,0\r\n");
    expect("SET:CIB1.DO3,0", "DIFF:CIB1.DO3,0\r\n");
    expect("SET:__PLC_RUN,1", "ERROR:21 Unable to send data to PLC.\r\n");
}
END_TEST

START_TEST(bn5_delta_and_what_was_told_last)
{
    expect("EN:CIB1.PWM* 5", "WARNING:252 Changed active variables in public file: '[9/58]'\r\n");
    say(1, "EN:CIB1.PWM1");
    heard[1][0] = '\0';
    say(2, "SET:CIB1.PWM1,5");
    to(100001);
    expect_heard(0, "");
    expect_heard(1, "DIFF:CIB1.PWM1,5\r\n");
    say(2, "SET:CIB1.PWM1,6");
    to(200001);
    expect_heard(0, "DIFF:CIB1.PWM1,6\r\n");
    say(2, "SET:CIB1.PWM1,0");
    to(300001);
    expect_heard(0, "DIFF:CIB1.PWM1,0\r\n");
    expect("DI:CIB1.PWM1", "WARNING:252 Changed active variables in public file: '[8/58]'\r\n");
    say(2, "SET:CIB1.PWM1,9000");
    to(400001);
    expect_heard(0, "");
    expect("EN:CIB1.PWM1 x", "ERROR:35 Wrong parameter value in request: 'EN:CIB1.PWM1 x'\r\n");
    expect("DI:", "WARNING:252 Changed active variables in public file: '[1/58]'\r\n");
    ck_assert(!cib_lines_watches(&client[0], &modules));
    ck_assert(cib_lines_watches(&client[1], &modules));
}
END_TEST

START_TEST(bn5_a_change_that_is_over_is_not_told)
{
    to(1000);
    expect("EN:CIB1.DO1", "WARNING:252 Changed active variables in public file: '[2/58]'\r\n");
    say(1, "SET:CIB1.DO1,1");
    to(50000);
    say(1, "SET:CIB1.DO1,0");
    to(100001);
    expect_heard(0, "");
}
END_TEST

START_TEST(bn6_information_and_what_is_not_there)
{
    expect("GETINFO:", "GETINFO:VERSION,RKM04 " RKM04_VERSION "\r\nGETINFO:VERSION_PLC,C-OS-0808M 1.2\r\nGETINFO:\r\n");
    expect("GETINFO:version", "GETINFO:VERSION,RKM04 " RKM04_VERSION "\r\n");
    expect("GETINFO:version_plc", "GETINFO:VERSION_PLC,C-OS-0808M 1.2\r\n");
    static const struct {
        const char *line;
        int error;
    } others[] = {{"GETINFO:x", 60}, {"HELP:", 32}, {"HIDE:x", 32}, {"UNHIDE:x", 32}, {"SETCONF:crlf,no", 32},
                  {"GETFILEINFO:x", 40},
                  {"GETFILE:x", 41}, {"WRITEFILE:x", 42}, {"WRITEFILEINFO:x", 43}, {"GETMEM:0", 80}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char begin_of[16];
        say(0, others[i].line);
        int length = snprintf(begin_of, sizeof begin_of, "ERROR:%d ", others[i].error);
        ck_assert_msg(strncmp(heard[0], begin_of, (size_t)length) == 0, "%s: %s", others[i].line, heard[0]);
        heard[0][0] = '\0';
    }
}
END_TEST

START_TEST(bc9_each_line_is_a_request)
{
    struct cib_config config = cib_default_config;
    config.comm_timeout = 100;
    power_up(2); /* a line is a request to all modules */
    cib_begin(&unit[0], &config, &nobody, NULL);
    cib_begin(&unit[1], &config, &nobody, NULL);
    expect("SET:CIB17.MCB.P1,500", "DIFF:CIB17.MCB.P1,500\r\n");
    expect("SET:CIB17.MCB.CMD,105", "DIFF:CIB17.MCB.CMD,105\r\n");
    expect("SET:CIB17.MCB.SEQ,1", "DIFF:CIB17.MCB.SEQ,1\r\n");
    expect("SET:CIB1.MCA.P1,500", "DIFF:CIB1.MCA.P1,500\r\n");
    expect("SET:CIB1.MCA.CMD,105", "DIFF:CIB1.MCA.CMD,105\r\n");
    expect("SET:CIB1.MCA.SEQ,1", "DIFF:CIB1.MCA.SEQ,1\r\n");
    for (unsigned i = 1; i <= 30; i++) {
        to(i * 90000);
        expect("hello", "ERROR:33 Unknown variable name in request: 'hello'\r\n");
    }
    expect("GET:CIB*.VEL",
           "GET:CIB1.MCA.VEL,500\r\nGET:CIB1.MCB.VEL,0\r\nGET:CIB17.MCA.VEL,0\r\nGET:CIB17.MCB.VEL,500\r\nGET:\r\n");
    to(30 * 90000 + 110000);
    say(0, "GET:CIB1.MCA.INVEL"); /* the stop clears it */
    ck_assert_str_eq(heard[0], "GET:CIB1.MCA.INVEL,0\r\n");
}
END_TEST

static Suite *lines_suite(void)
{
    Suite *suite = suite_create("cib_lines");
    TCase *lines = tcase_create("lines");
    tcase_add_checked_fixture(lines, begin, NULL);
    tcase_add_test(lines, z1_get);
    tcase_add_test(lines, z2_motion);
    tcase_add_test(lines, z3_changes_are_told_at_the_end_of_each_tenth_of_a_second);
    tcase_add_test(lines, z4_errors);
    tcase_add_test(lines, bn1_lines_end_with_lf_or_crlf_and_come_in_pieces);
    tcase_add_test(lines, bn1_a_line_without_colon_names_another_variable);
    tcase_add_test(lines, bn1_a_line_has_1024_bytes_at_most);
    tcase_add_test(lines, bn1_a_longer_line_is_refused_whole);
    tcase_add_test(lines, bn2_the_list_has_every_variable_with_its_type);
    tcase_add_test(lines, bn2_names_are_in_their_order);
    tcase_add_test(lines, bn2_drives_have_their_own_registers);
    tcase_add_test(lines, bn2_names_of_several_modules_have_their_addresses);
    tcase_add_test(lines, bn3_patterns);
    tcase_add_test(lines, bn4_values_are_checked);
    tcase_add_test(lines, bn4_variables_take_nothing_that_is_not_theirs);
    tcase_add_test(lines, bn5_a_delta_is_a_number_up_to_32_bits);
    tcase_add_test(lines, bn5_delta_and_what_was_told_last);
    tcase_add_test(lines, bn5_a_change_that_is_over_is_not_told);
    tcase_add_test(lines, bn6_information_and_what_is_not_there);
    tcase_add_test(lines, bc9_each_line_is_a_request);
    suite_add_tcase(suite, lines);
    return suite;
}

int main(void)
{
    return rig_run(lines_suite(), "./test_cib_lines");
}

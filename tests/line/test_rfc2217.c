/* SPDX-License-Identifier: MIT */
/* test_rfc2217.c: a serial port over telnet, RFC 2217. One test alone: CK_RUN_CASE=rfc2217 ./test_rfc2217 */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "line/rfc2217.h"

#define OPENING "fffb00 fffd00 fffb03 fffd2c" /* WILL and DO BINARY, WILL SGA, DO COM-PORT */
#define LINES "fffa2c 6bb0 fff0"              /* carrier, DSR and CTS are there */
#define TEXT_MAX 4096

static struct rfc2217 port;

/* What has come out since begin(), as hex; events as they came, one letter each. */
static char replies[2 * TEXT_MAX], data[2 * TEXT_MAX], events[TEXT_MAX];

static void append_hex(char *text, const uint8_t *bytes, size_t length)
{
    static const char digits[] = "0123456789abcdef";
    size_t at = strlen(text);
    for (size_t i = 0; i < length; i++) {
        text[at++] = digits[bytes[i] >> 4];
        text[at++] = digits[bytes[i] & 15];
    }
    text[at] = '\0';
}

static void forget(void)
{
    replies[0] = data[0] = events[0] = '\0';
}

static void begin(void)
{
    forget();
    rfc2217_begin(&port);
    append_hex(replies, port.reply, port.reply_length);
}

static unsigned digit(char c)
{
    return (unsigned)(c <= '9' ? c - '0' : c - 'a' + 10);
}

static void take(uint8_t byte)
{
    static const char letter[] = ".dSLBbPF";
    enum rfc2217_event event = rfc2217_receive(&port, byte);
    append_hex(replies, port.reply, port.reply_length);
    if (event == RFC2217_DATA)
        append_hex(data, &port.data, 1);
    else if (event != RFC2217_NOTHING)
        strncat(events, &letter[event], 1);
}

/* The client sends bytes, given in hex; blanks do not count. */
static void say(const char *hex)
{
    for (; *hex; hex++)
        if (*hex != ' ') {
            take((uint8_t)(digit(hex[0]) << 4 | digit(hex[1])));
            hex++;
        }
}

static void is_hex(const char *got, const char *wanted)
{
    char plain[2 * TEXT_MAX], *to = plain;
    for (; *wanted; wanted++)
        if (*wanted != ' ')
            *to++ = *wanted;
    *to = '\0';
    ck_assert_str_eq(got, plain);
}

/* The port has been agreed upon, and what was said up to then is forgotten. */
static void open_port(void)
{
    begin();
    say("fffb2c");
    forget();
}

/* A command of the client, without its frame, is answered by one of the server; "" means not at all. */
static void answered(const char *command, const char *answer)
{
    char wanted[TEXT_MAX] = "";
    forget();
    say("fffa2c");
    say(command);
    say("fff0");
    if (*answer) {
        strcat(wanted, "fffa2c");
        strcat(wanted, answer);
        strcat(wanted, "fff0");
    }
    is_hex(replies, wanted);
    ck_assert_str_eq(data, "");
}

/* ---- Whole dialogues as recorded ------------------------------------------------------------------------------------ */

#define PYSERIAL_OPENS "fffd01 fffb03 fffd03 fffd2c fffb2c"
#define PYSERIAL_SETS "fffa2c0100004b00fff0 fffa2c0208fff0 fffa2c0301fff0 fffa2c0401fff0"
#define PYSERIAL_GOES_ON                                                                                                       \
    "fffd00 fffb00 " PYSERIAL_SETS " fffa2c0501fff0 fffa2c0508fff0 fffa2c050bfff0 fffa2c0c01fff0 fffa2c0c02fff0"
#define TO_PYSERIAL                                                                                                            \
    OPENING "fffc01 fffd03 fffb2c" LINES "fffa2c6500004b00fff0 fffa2c6608fff0 fffa2c6701fff0 fffa2c6801fff0"                   \
            "fffa2c6901fff0 fffa2c6908fff0 fffa2c690bfff0 fffa2c7001fff0 fffa2c7002fff0"

START_TEST(pyserial_opens_a_port)
{
    begin();
    say(PYSERIAL_OPENS);
    is_hex(replies, OPENING "fffc01 fffd03 fffb2c" LINES);
    say(PYSERIAL_GOES_ON);
    is_hex(replies, TO_PYSERIAL);
    ck_assert_str_eq(events, "PP"); /* it sets what is in force already */
    ck_assert_str_eq(data, "");
}
END_TEST

START_TEST(the_client_of_ser2net_opens_a_port_and_sends)
{
    begin();
    say("fffb2c fffd00 fffb00 fffe03 68656c6c6f ffff 776f726c64");
    is_hex(replies, OPENING LINES);
    is_hex(data, "68656c6c6f ff 776f726c64");
}
END_TEST

START_TEST(the_client_of_ser2net_sets_and_asks)
{
    open_port();
    answered("00", "64726b6d3034"); /* the signature */
    answered("010000e100", "650000e100");
    answered("0100000000", "650000e100");
    answered("0200", "6608");
    answered("0303", "6703");
    answered("0402", "6802");
    answered("0500", "6901");
    answered("050d", "690e");
    answered("0504", "6906");
    answered("0507", "6908");
    answered("050a", "690b");
    answered("0a02", "6e02");
    answered("0bffff", "6fffff");
    answered("06", "6a60");
    answered("07", "6bb0");
}
END_TEST

/* The clients below speak as their documents say: they run on Windows alone. */

/* hub4com with com2tcp-rfc2217.bat (--comport=client): it takes BINARY and SUPPRESS-GO-AHEAD in both directions, offers COM-PORT
 * itself, and hands on what the program at the COM port sets, line by line. */
START_TEST(hub4com_opens_a_port_sets_it_and_sends_a_break)
{
    begin();
    say("fffb2c fffd00 fffb00 fffd03");
    is_hex(replies, OPENING LINES);
    forget();
    say("fffa2c 01 00004b00 fff0 fffa2c 02 08 fff0 fffa2c 03 01 fff0 fffa2c 04 01 fff0 fffa2c 05 08 fff0 fffa2c 05 0b fff0");
    is_hex(replies, "fffa2c 65 00004b00 fff0 fffa2c 66 08 fff0 fffa2c 67 01 fff0 fffa2c 68 01 fff0 fffa2c 69 08 fff0"
                    "fffa2c 69 0b fff0");
    ck_assert_str_eq(events, "");
    forget();
    say("fffa2c 05 0c fff0 fffa2c 05 05 fff0 fffa2c 05 06 fff0 fffa2c 01 00002580 fff0 fffa2c 03 03 fff0 7e 01 ffff 7e");
    is_hex(replies, "fffa2c 69 0c fff0 fffa2c 69 05 fff0 fffa2c 69 06 fff0 fffa2c 65 00002580 fff0 fffa2c 67 03 fff0");
    ck_assert_str_eq(events, "LBBSS");
    is_hex(data, "7e 01 ff 7e");
}
END_TEST

/* com2tcp.bat --telnet: the same without COM-PORT. (Without --telnet it is for the raw port.) */
START_TEST(com2tcp_talks_without_COM_PORT)
{
    begin();
    say("fffd00 fffb00 fffd03 fffc2c 7e 01 00 7e");
    is_hex(replies, OPENING);
    is_hex(data, "7e 01 00 7e");
    forget();
    say("fff1 fffd18 fffb01"); /* --keep-active, a terminal type, an echo: none of it is data */
    is_hex(replies, "fffc18 fffe01");
    ck_assert_str_eq(data, "");
}
END_TEST

/* Redirectors of makers of device servers name themselves, ask first, set masks and flow control, and empty the buffers. */
START_TEST(a_redirector_asks_sets_and_empties_the_buffers)
{
    begin();
    say("fffd2c fffb2c fffd03 fffb03 fffd00 fffb00");
    is_hex(replies, OPENING "fffb2c" LINES "fffd03");
    forget();
    say("fffa2c 00 5265646972 fff0 fffa2c 00 fff0 fffa2c 01 00000000 fff0 fffa2c 02 00 fff0 fffa2c 03 00 fff0 fffa2c 04 00 fff0");
    is_hex(replies, "fffa2c 64 726b6d3034 fff0 fffa2c 65 00004b00 fff0 fffa2c 66 08 fff0 fffa2c 67 01 fff0 fffa2c 68 01 fff0");
    answered("0a 00", "6e00");
    answered("0b ffff", "6fffff");
    answered("05 01", "6901");
    answered("05 0e", "690e");
    answered("0c 03", "7003");
    ck_assert_str_eq(events, "P");
}
END_TEST

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

START_TEST(a_client_finds_19200_8N1_with_its_lines_on)
{
    begin();
    ck_assert_uint_eq(port.baud, 19200);
    ck_assert_uint_eq(port.data_bits, 8);
    ck_assert_int_eq(port.parity, 'N');
    ck_assert_uint_eq(port.stop_bits, 1);
    ck_assert(port.dtr && port.rts && !port.breaking && !port.suspended);
}
END_TEST

START_TEST(every_setting_is_taken_and_acknowledged)
{
    static const char parities[] = "NOEMS";
    char command[8], answer[8];
    open_port();
    for (unsigned bits = 5; bits <= 8; bits++) {
        snprintf(command, sizeof command, "020%u", bits);
        snprintf(answer, sizeof answer, "660%u", bits);
        answered(command, answer);
        ck_assert_uint_eq(port.data_bits, bits);
    }
    for (unsigned i = 1; i <= 5; i++) {
        snprintf(command, sizeof command, "030%u", i);
        snprintf(answer, sizeof answer, "670%u", i);
        answered(command, answer);
        ck_assert_int_eq(port.parity, parities[i - 1]);
    }
    for (unsigned i = 1; i <= 3; i++) {
        snprintf(command, sizeof command, "040%u", i);
        snprintf(answer, sizeof answer, "680%u", i);
        answered(command, answer);
        ck_assert_uint_eq(port.stop_bits, i);
    }
}
END_TEST

START_TEST(any_speed_is_taken_and_IAC_in_it_is_doubled)
{
    open_port();
    answered("0100000001", "6500000001");
    answered("010000ffff00", "650000ffff00"); /* 65280 */
    ck_assert_uint_eq(port.baud, 65280);
    answered("01ffffffffffffffff", "65ffffffffffffffff");
    ck_assert_uint_eq(port.baud, UINT32_MAX);
}
END_TEST

START_TEST(what_has_no_name_is_answered_with_the_value_in_force)
{
    open_port();
    answered("0107", "6500004b00"); /* too short */
    answered("01", "6500004b00");
    answered("0209", "6608");
    answered("0204", "6608");
    answered("02", "6608");
    answered("0306", "6701");
    answered("0404", "6801");
    answered("0a", "6e00");
    answered("0b", "6fffff");
    ck_assert_str_eq(events, "");
}
END_TEST

START_TEST(only_a_change_is_an_event)
{
    open_port();
    say("fffa2c0100002580fff0");
    ck_assert_str_eq(events, "S");
    say("fffa2c0100002580fff0 fffa2c0100000000fff0 fffa2c0508fff0 fffa2c0506fff0");
    ck_assert_str_eq(events, "S");
    say("fffa2c0207fff0 fffa2c0303fff0 fffa2c0402fff0 fffa2c0509fff0 fffa2c050cfff0");
    ck_assert_str_eq(events, "SSSSLL");
    ck_assert(!port.dtr && !port.rts);
    answered("0507", "6909");
    answered("050a", "690c");
}
END_TEST

START_TEST(flow_control_is_acknowledged_in_each_direction)
{
    static const char *const out[] = {"01", "02", "03", "11", "13"}, *const in[] = {"0e", "0f", "10", "12"};
    char command[8], answer[8];
    open_port();
    for (size_t i = 0; i < 5; i++) {
        snprintf(command, sizeof command, "05%s", out[i]);
        snprintf(answer, sizeof answer, "69%s", out[i]);
        answered(command, answer);
        answered("0500", answer);
        answered("050d", "690e");
    }
    for (size_t i = 0; i < 4; i++) {
        snprintf(command, sizeof command, "05%s", in[i]);
        snprintf(answer, sizeof answer, "69%s", in[i]);
        answered(command, answer);
        answered("050d", answer);
        answered("0500", "6913");
    }
}
END_TEST

START_TEST(a_break_begins_and_ends)
{
    open_port();
    answered("0505", "6905");
    ck_assert(port.breaking);
    ck_assert_str_eq(events, "B");
    answered("0504", "6905");
    ck_assert_str_eq(events, "");
    answered("0506", "6906");
    ck_assert(!port.breaking);
    ck_assert_str_eq(events, "B");
}
END_TEST

START_TEST(a_break_of_telnet_is_a_pulse)
{
    open_port();
    say("41 fff3 42");
    ck_assert_str_eq(events, "b");
    is_hex(data, "41 42");
    ck_assert(!port.breaking);
}
END_TEST

START_TEST(a_purge_says_what_is_to_be_forgotten)
{
    open_port();
    answered("0c01", "7001");
    ck_assert_str_eq(events, "P");
    ck_assert_uint_eq(port.purge, RFC2217_PURGE_TO_CLIENT);
    answered("0c02", "7002");
    ck_assert_uint_eq(port.purge, RFC2217_PURGE_TO_LINE);
    answered("0c03", "7003");
    ck_assert_uint_eq(port.purge, RFC2217_PURGE_TO_CLIENT | RFC2217_PURGE_TO_LINE);
    answered("0c00", "");
    answered("0c04", "");
    ck_assert_str_eq(events, "");
}
END_TEST

START_TEST(the_client_suspends_and_resumes)
{
    open_port();
    answered("08", "");
    ck_assert_str_eq(events, "F");
    ck_assert(port.suspended);
    answered("09", "");
    ck_assert_str_eq(events, "F");
    ck_assert(!port.suspended);
}
END_TEST

START_TEST(unknown_commands_get_no_answer)
{
    open_port();
    answered("0d", "");
    answered("65", "");
    answered("0514", "");
    answered("", "");
    answered("00726b6d", ""); /* the client's own signature */
    forget();
    say("fffa 18 01 fff0 fffa fff0"); /* another option; none */
    ck_assert_str_eq(replies, "");
    ck_assert_str_eq(data, "");
}
END_TEST

/* ---- Telnet --------------------------------------------------------------------------------------------------------- */

START_TEST(what_is_agreed_is_not_agreed_again)
{
    begin();
    forget();
    say("fffd00 fffb00 fffd03 fffb2c");
    is_hex(replies, LINES);
    say("fffd00 fffb00 fffd03 fffb2c");
    is_hex(replies, LINES);
    say("fffb03 fffb03");
    is_hex(replies, LINES "fffd03");
}
END_TEST

START_TEST(what_is_not_known_is_refused_and_a_refusal_is_accepted)
{
    begin();
    forget();
    say("fffb18 fffd18 fffb1f fffd06 fffdff");
    is_hex(replies, "fffe18 fffc18 fffe1f fffc06 fffcff");
    forget();
    say("fffc18 fffe18 fffe00 fffc00 fffe03");
    is_hex(replies, "");
    say("fffb00 fffc00 fffc00");
    is_hex(replies, "fffd00 fffe00");
}
END_TEST

START_TEST(a_client_that_does_not_want_COM_PORT_gets_none_of_it)
{
    begin();
    say("fffc2c");
    answered("0100004b00", "");
    forget();
    say("fffb2c");
    is_hex(replies, "fffd2c" LINES);
    answered("0100004b00", "6500004b00");
}
END_TEST

START_TEST(data_are_eight_bits_wide_before_anything_is_agreed)
{
    begin();
    forget();
    say("00 0d 00 0d 0a 7e 7d 80 ffff ffff fe ffff");
    is_hex(data, "00 0d 00 0d 0a 7e 7d 80 ff ff fe ff");
    is_hex(replies, "");
}
END_TEST

START_TEST(are_you_there_is_answered_without_data)
{
    begin();
    forget();
    say("fff6");
    is_hex(replies, "fff1");
}
END_TEST

START_TEST(other_commands_of_telnet_are_passed_over)
{
    open_port();
    say("41 fff1 fff2 fff4 fff5 fff7 fff8 fff9 fff0 ff00 ff41 42");
    is_hex(data, "41 42");
    is_hex(replies, "");
    ck_assert_str_eq(events, "");
}
END_TEST

START_TEST(a_command_without_its_end_is_forgotten)
{
    open_port();
    say("fffa2c0207 fffb03 41"); /* another command begins */
    is_hex(replies, "fffd03");
    is_hex(data, "41");
    forget();
    say("fffa2c0207 fffa2c0302fff0");
    is_hex(replies, "fffa2c6702fff0");
    ck_assert_uint_eq(port.data_bits, 8);
}
END_TEST

START_TEST(a_command_without_end_harms_nobody)
{
    open_port();
    say("fffa2c0207");
    for (unsigned i = 0; i < 100000; i++)
        take('A');
    say("fff0");
    is_hex(replies, "fffa2c6607fff0");
    ck_assert_str_eq(data, "");
}
END_TEST

START_TEST(data_for_the_client_have_IAC_doubled)
{
    static const uint8_t raw[] = {0xFF, 0, 0xFF, 0xFF, 0xFE};
    uint8_t out[2 * sizeof raw];
    char text[32] = "";
    append_hex(text, out, rfc2217_escape(raw, sizeof raw, out));
    is_hex(text, "ffff 00 ffff ffff fe");
}
END_TEST

/* ---- Anything ------------------------------------------------------------------------------------------------------- */

static uint32_t seed;

static uint8_t chance(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint8_t)(seed >> 24);
}

/* Bytes as a hostile client might choose them: those that mean something are frequent. */
static uint8_t nasty(void)
{
    static const uint8_t likely[] = {0xFF, 0xFF, 0xFA, 0xF0, 0x2C, 0xFB, 0xFC, 0xFD, 0xFE, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12};
    uint8_t byte = chance();
    return byte & 0x80 ? likely[chance() % sizeof likely] : chance();
}

static bool legal(enum rfc2217_event event)
{
    return port.reply_length <= RFC2217_REPLY_MAX / 2 && event <= RFC2217_FLOW && port.baud > 0 && port.data_bits >= 5 &&
           port.data_bits <= 8 && port.stop_bits >= 1 && port.stop_bits <= 3 && port.parity && strchr("NOEMS", port.parity);
}

START_TEST(any_bytes_leave_a_legal_port_and_replies_of_bounded_length)
{
    seed = 1;
    begin();
    for (unsigned i = 0; i < 1000000; i++)
        if (!legal(rfc2217_receive(&port, nasty())))
            ck_abort_msg("after %u bytes", i + 1);
}
END_TEST

START_TEST(after_any_bytes_the_port_is_of_use_again)
{
    for (unsigned times = 0; times < 1000; times++) {
        seed = times;
        begin();
        for (unsigned i = 0; i < 500; i++)
            rfc2217_receive(&port, nasty());
        say("fff0 fff0 fffc2c fffb2c"); /* whatever was open is closed */
        forget();
        say("fffa2c010000e100fff0 41");
        is_hex(replies, "fffa2c650000e100fff0");
        is_hex(data, "41");
    }
}
END_TEST

static Suite *suite(void)
{
    Suite *result = suite_create("rfc2217");
    TCase *one = tcase_create("rfc2217"), *many = tcase_create("anything");
    tcase_add_test(one, pyserial_opens_a_port);
    tcase_add_test(one, the_client_of_ser2net_opens_a_port_and_sends);
    tcase_add_test(one, the_client_of_ser2net_sets_and_asks);
    tcase_add_test(one, hub4com_opens_a_port_sets_it_and_sends_a_break);
    tcase_add_test(one, com2tcp_talks_without_COM_PORT);
    tcase_add_test(one, a_redirector_asks_sets_and_empties_the_buffers);
    tcase_add_test(one, a_client_finds_19200_8N1_with_its_lines_on);
    tcase_add_test(one, every_setting_is_taken_and_acknowledged);
    tcase_add_test(one, any_speed_is_taken_and_IAC_in_it_is_doubled);
    tcase_add_test(one, what_has_no_name_is_answered_with_the_value_in_force);
    tcase_add_test(one, only_a_change_is_an_event);
    tcase_add_test(one, flow_control_is_acknowledged_in_each_direction);
    tcase_add_test(one, a_break_begins_and_ends);
    tcase_add_test(one, a_break_of_telnet_is_a_pulse);
    tcase_add_test(one, a_purge_says_what_is_to_be_forgotten);
    tcase_add_test(one, the_client_suspends_and_resumes);
    tcase_add_test(one, unknown_commands_get_no_answer);
    tcase_add_test(one, what_is_agreed_is_not_agreed_again);
    tcase_add_test(one, what_is_not_known_is_refused_and_a_refusal_is_accepted);
    tcase_add_test(one, a_client_that_does_not_want_COM_PORT_gets_none_of_it);
    tcase_add_test(one, data_are_eight_bits_wide_before_anything_is_agreed);
    tcase_add_test(one, are_you_there_is_answered_without_data);
    tcase_add_test(one, other_commands_of_telnet_are_passed_over);
    tcase_add_test(one, a_command_without_its_end_is_forgotten);
    tcase_add_test(one, a_command_without_end_harms_nobody);
    tcase_add_test(one, data_for_the_client_have_IAC_doubled);
    tcase_add_test(many, any_bytes_leave_a_legal_port_and_replies_of_bounded_length);
    tcase_add_test(many, after_any_bytes_the_port_is_of_use_again);
    suite_add_tcase(result, one);
    suite_add_tcase(result, many);
    return result;
}

int main(void)
{
    SRunner *runner = srunner_create(suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=rfc2217|anything ./test_rfc2217");
    return failed > 0;
}

/* SPDX-License-Identifier: MIT */
/* manual.c: the manual's example programs and messages, with their inputs in a state in which something happens; and motions at
 * the limits. Which text counts where the manual disagrees with itself: docs/SPEC.md. */
#include "digest.h"

#define ACTS_MAX 8
#define LOOKS 16 /* how often the unit is asked where it is, in the course of a session */

/* What comes from outside at a tick. kind: '0'..'4' Set Command to that motor, 'D' inputs, 'Q' a request as it is, 'P' power off
 * and on; 0 ends the list. */
struct act {
    uint64_t tick;
    char kind;
    uint8_t inputs;
    uint16_t length; /* of the text */
    const char *text;
};

struct example {
    const char *name;
    uint64_t end;
    struct act act[ACTS_MAX];
};

#define SET(tick, motor, text) {tick, motor, 0, sizeof(text) - 1, text}
#define INPUTS(tick, mask) {tick, 'D', mask, 0, ""}
#define REQUEST(tick, message) {tick, 'Q', 0, sizeof(message) - 1, message}
#define POWER(tick) {tick, 'P', 0, 0, ""}

#define M7_36 "S100 A2000 V500 F2000 Y\nV2000 Y\nV500 F5000 Y\nV3000 A1000 Y \nV1500 F2000 Y\nV500 Y R"
#define M7_37 "@1 I01L6 \nF2500 \xB4" "3 Z3 J1 \n@6 B2500 \xB4" "3 Z4 J1 \n@3 R W2000 D R ."
#define M9_1 "\\C100\nS100 V1000 A2000 F5000 R\nB2000 R\nH"
#define M9_3 "\\\nS200 V2000 A5000\n@1 I05H10 F2000 R J20\n@10 B2000 R \n@20 W600\nJ1"
#define M9_5 "\\C100\nS100 V1000 A2000 F5000 R\nO02 B6000 R\nZ05 F3000 R\nH"
#define M9_6 "\\C100\nS100 V1000 A2000 F5000\nM03 R U\nW200 V600 B4000\nN06 R U\nW300 F500 R"
#define M9_7 "\\C100\nS100 V1000 A2000\nX04\n@1 F5000 R\nW600 B5000 R\nW1000 J1"
#define M9_8 "\\C100\nS100 V1000 A2000\n@1 I81L6\n" \
             "T02 F2500 '3 C02 C81 J1\n@6 T05 B2500 '3 C05 T81 J1\n@3 R W500 D R ."
#define M9_9 "\\\nS100 T55\nV500 A2000 F2000 Y\nV2000 Y\nV500 F5000 Y\nV3000 A1000 Y\nV1500 F2000 Y\nV500 Y\nR W500 C05"
#define FOURTEEN "S100 A13000 V500 F900 Y V2000 F300 Y V1000 F200 Y V2000 F300 Y V500 F100 Y V1000 F422 Y R"

static const struct example messages[] = {
    {"5.3.1", MS, {REQUEST(0, "\x01")}},
    {"5.3.2", SECOND,
     {REQUEST(0, "\x02" "3C100"), REQUEST(0, "\x02" "1C100"), REQUEST(0, "\x02" "1F0"), REQUEST(0, "\x02" "5U")}},
    {"5.3.3", SECOND,
     {SET(0, '4', "@1 T04 W7 C04 W3 J1"), REQUEST(0, "\x03" "4"), POWER(50 * MS), REQUEST(99 * MS, "\x03" "0"), POWER(100 * MS),
      REQUEST(100 * MS, "\x05" "4")}},
    {"5.3.4", SECOND,
     {SET(0, '1', "=-2000000000"), SET(0, '2', "=123"), REQUEST(MS, "\x04" "0"), REQUEST(2 * MS, "\x04" "0"),
      REQUEST(2 * MS, "\x04" "1")}},
    {"5.3.5", SECOND, {SET(0, '2', "C100"), REQUEST(0, "\x05" "2"), REQUEST(SECOND / 2, "\x05" "2"), REQUEST(0, "\x05" "0")}},
    {"5.3.6", 3 * SECOND, {SET(0, '2', FOURTEEN), REQUEST(SECOND, "\x06" "2"), REQUEST(2 * SECOND, "\x06" "0")}},
    {"5.3.7", 51 * SECOND,
     {SET(0, '4', "S100 V1000 A2000 F50000 R"), REQUEST(46030501, "\x07" "4"), REQUEST(47 * SECOND, "\x07" "0")}},
    {"5.3.8", MS, {REQUEST(0, "\x08"), REQUEST(0, "\x00"), REQUEST(0, "\xFF"), REQUEST(0, "\x04"), REQUEST(0, "\x06x")}},
};

static const struct example chapters_4_and_7[] = {
    {"4.6", 10 * SECOND, {SET(0, '1', "S100 A2000 F1000 V3000\nL3 R W200 E \nB300")}},
    {"7.1", SECOND, {SET(0, '1', "V3000 F1000 T01 R"), SET(300 * MS, '1', "\\")}},
    {"7.2", SECOND, {SET(0, '1', "@2")}},
    {"7.3", 3 * SECOND, {SET(0, '1', "A500 F1000"), SET(0, '1', "A2000"), SET(0, '1', "R")}},
    {"7.4", 3 * SECOND, {SET(0, '1', "B1000"), SET(0, '1', "R")}},
    {"7.5", SECOND, {SET(0, '1', "T06 T05 W5"), SET(0, '1', "C06")}},
    {"7.6", SECOND, {SET(0, '1', "T86 T87 W5"), SET(0, '1', "C86")}},
    {"7.7", 3 * SECOND, {SET(0, '1', "F1000 R"), SET(0, '1', "C100")}},
    {"7.8", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\nR D R")}},
    {"7.9", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\nL2 R W200 E \nB300")}},
    {"7.10", 3 * SECOND, {SET(0, '1', "F1000"), SET(0, '1', "R")}},
    {"7.11", 20 * SECOND, {SET(0, '1', "G10000"), SET(0, '2', "=12000 G10000")}},
    {"7.12", 10 * SECOND, {SET(0, '1', "S100 A2000 F1000\nM05 G+"), INPUTS(3 * SECOND, 0x10)}},
    {"7.13", 10 * SECOND, {SET(0, '1', "S100 A2000 F1000\nM05 G-"), INPUTS(3 * SECOND, 0x10)}},
    {"7.14", 5 * SECOND, {SET(0, '1', "H =700"), SET(0, '1', "H"), SET(0, '1', "=-700 H")}},
    {"7.15-low", 3 * SECOND, {SET(0, '1', "@19 I01H20 F200 R J21  \n@20 B200 R  \n@21")}},
    {"7.15-high", 3 * SECOND, {INPUTS(0, 1), SET(0, '1', "@19 I01H20 F200 R J21  \n@20 B200 R  \n@21")}},
    {"7.16", 20 * SECOND, {SET(0, '1', "@20 F200 R W500 J20")}},
    {"7.17", 20 * SECOND, {SET(0, '1', "S100 V1000 A2000 F5000 R"), SET(1005 * MS, '1', "K"), SET(4 * SECOND, '1', "C75")}},
    {"7.18", 20 * SECOND, {SET(0, '1', "S100 V1000 A2000 F5000 R K C75 F1"), SET(1005 * MS, '1', "K U")}},
    {"7.19", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\nM05 R B200"), INPUTS(505 * MS, 0x10)}},
    {"7.20", 5 * SECOND, {INPUTS(0, 0x10), SET(0, '1', "S100 A2000 F1000\nN05 R B200"), INPUTS(505 * MS, 0)}},
    {"7.21", 10 * SECOND,
     {INPUTS(0, 0x10), SET(0, '1', "S100 A2000 F1000\nN05 R U"), INPUTS(5 * SECOND, 0), SET(5 * SECOND, '1', "R")}},
    {"7.22", 6 * SECOND, {SET(0, '1', "S100 A1000 F1000\nL2 R W200 E\nB300")}},
    {"7.23", SECOND, {SET(0, '1', "O03"), SET(0, '1', "T01"), INPUTS(500 * MS + 1, 4)}},
    {"7.24", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\nR H")}},
    {"7.25", 5 * SECOND, {SET(0, '1', "S500 F1000"), SET(0, '1', "S100"), SET(0, '1', "R")}},
    {"7.26", SECOND, {SET(0, '1', "T06")}},
    {"7.27", SECOND, {SET(0, '1', "T86")}},
    {"7.28", 10 * SECOND, {SET(0, '1', "V3000"), SET(0, '1', "F20000 R")}},
    {"7.29", 25 * SECOND, {SET(0, '1', "V3000 F50000 R F20000 R"), SET(3 * SECOND, '1', "V6000")}},
    {"7.30", 6 * SECOND, {SET(0, '2', "S100 A1000 F1000\nL2 R W200 E\nB300")}},
    {"7.31", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\nX05 R B300"), INPUTS(505 * MS, 0x10)}},
    {"7.32", SECOND, {INPUTS(0, 4), SET(0, '1', "Z03"), SET(0, '1', "T01"), INPUTS(500 * MS, 0)}},
    {"7.33", 3 * SECOND, {SET(0, '1', "S100 A2000 F1000\n)05"), INPUTS(SECOND, 0x10)}},
    {"7.34", 3 * SECOND, {SET(0, '1', "S100 A2000 F1000\n(05"), INPUTS(SECOND, 0x10)}},
    {"7.35", SECOND, {SET(0, '1', "=5000")}},
    {"7.36", 26 * SECOND, {SET(0, '1', M7_36)}},
    {"7.37", 20 * SECOND, {SET(0, '1', M7_37)}},
    {"7.38", 30 * SECOND, {INPUTS(0, 5), SET(0, '1', M7_37), INPUTS(20 * SECOND + 1, 0)}},
    {"7.39", 5 * SECOND, {SET(0, '1', "S100 A2000 F1000\n[ X05 R B300")}},
    {"7.40", 20 * SECOND, {SET(0, '1', "S100 A2000 F1000\n[ X05 R B300"), SET(10 * SECOND, '1', "]")}},
};

static const struct example chapter_9[] = {
    {"9.1", 20 * SECOND, {SET(0, '1', M9_1), SET(3 * SECOND + 500, '1', M9_1)}},
    {"9.2", 20 * SECOND, {SET(0, '1', "\\\nS100 V800 A2000\n@1 F1000 R\nW500 D R\nW1000 J1")}},
    {"9.3", 12 * SECOND, {SET(0, '1', M9_3), INPUTS(3 * SECOND, 0x10), INPUTS(7 * SECOND, 0)}},
    {"9.4", 30 * SECOND, {SET(0, '1', "\\C100\nS100 V600 A2000 F1000 R\nL3 F500 R W200 D R W1000 E\nB1000 R")}},
    {"9.5", 40 * SECOND, {INPUTS(0, 0x10), SET(0, '1', M9_5), INPUTS(10 * SECOND + 1, 0x12), INPUTS(20 * SECOND, 0x02)}},
    {"9.6", 30 * SECOND, {INPUTS(0, 0x20), SET(0, '1', M9_6), INPUTS(2007 * MS, 0x24), INPUTS(4 * SECOND, 0x04)}},
    {"9.6-none", 30 * SECOND, {INPUTS(0, 0x20), SET(0, '1', M9_6)}},
    {"9.7", 30 * SECOND, {SET(0, '1', M9_7), INPUTS(9 * SECOND, 8)}},
    {"9.8", 30 * SECOND, {SET(0, '1', M9_8)}},
    {"9.9", 26 * SECOND, {SET(0, '1', M9_9)}},
};

/* Motions so long that no test asks for their pulses. */
static const struct example long_motions[] = {
    {"longest", 2000 * SECOND,
     {SET(0, '1', "S2000 V16000 A60000 F16000000 R"), SET(0, '2', "S1 V16000 A1 F16000000 R"),
      SET(0, '3', "S1 V1 A1 B16000000 R"), SET(0, '4', "=-2000000000 S1000 A7 V15999 G2000000000")}},
    {"longest-compound", 20000 * SECOND,
     {SET(0, '1', "S7 V16000 A13 F16000000 Y V15999 Y V1 F3 Y V16000 A60000 F16000000 Y V3 A1 F1 Y "
                  "V12345 F16000000 Y Y A7 Y V3 Y R"),
      SET(0, '2', "S2000 V1999 A1 B1 Y V2000 B16000000 Y V16000 A59999 Y V2001 A3 Y R"), SET(500 * SECOND, '0', "V777"),
      SET(600 * SECOND, '0', "K"), SET(700 * SECOND, '0', "C75"), SET(800 * SECOND + 1, '0', "V16000")}},
    {"for-a-year", 31557600 * SECOND,
     {SET(0, '1', "S1 V100 A1 G+"), SET(0, '2', "S1 V1 G-"), SET(0, '3', "L255 W16000000 E"),
      SET(31000000 * SECOND + 3, '0', "V2"), SET(31000100 * SECOND, '0', "K"), SET(31100000 * SECOND, '2', "C75")}},
};

static const struct example limits[] = {
    {"fastest", 2 * SECOND,
     {SET(0, '0', "S2000 V16000 A60000 G+"), SET(SECOND, '1', "K"), SET(SECOND, '2', "V9999"),
      SET(SECOND + 7, '3', "\\ S1 A60000 V16000 G-")}},
    {"slowest", 9 * SECOND,
     {SET(0, '1', "S1 V1 A1 F8 R"), SET(0, '2', "S1 V16000 A1 F40 R"), SET(0, '3', "S1 V2 A60000 G-"),
      SET(0, '4', "S2 V1 A1 )01"), INPUTS(8 * SECOND, 1)}},
    {"wraps", SECOND,
     {SET(0, '1', "=2000000000 S2000 V16000 A60000 F2000 R"), SET(0, '2', "=-2000000000 B3 R C100 D R"),
      SET(0, '3', "L255 =2000000000 G1 K E"), SET(400 * MS, '3', "K"), SET(600 * MS, '3', "C75")}},
};

static void perform(const struct act *act)
{
    session_to(act->tick);
    if (act->kind == 'D')
        session_inputs(act->inputs);
    else if (act->kind == 'P')
        session_power_cycle();
    else if (act->kind == 'Q')
        session_request(act->text, act->length);
    else
        session_set(act->kind, act->text, act->length);
}

/* Where is everything, and what is every motion's table? */
static void ask_all(void)
{
    session_ask(4, '0');
    for (char motor = '1'; motor <= '4'; motor++) {
        session_ask(6, motor);
        session_ask(7, motor);
    }
    session_fetch(SIZE_MAX);
}

/* A power cycle sets time to 0: whatever comes later is at ticks of its own. */
static void run_example(const struct example *example, const struct rkm04_framing *framing, bool quiet)
{
    const struct session session = {.node = 1, .framing = framing, .quiet = quiet};
    char name[40] = "";
    uint64_t look = 0, apart = example->end / LOOKS;
    unsigned next = 0;
    session_begin(&session);
    while (look <= example->end) {
        if (next < ACTS_MAX && example->act[next].kind != 0 && example->act[next].tick <= look) {
            perform(&example->act[next++]);
            continue;
        }
        session_to(look);
        ask_all();
        look += apart;
    }
    for (char motor = '1'; motor <= '4'; motor++)
        session_ask(5, motor);
    append(name, sizeof name, example->name);
    append(name, sizeof name, "/");
    append(name, sizeof name, framing->name);
    session_end(name);
}

#define COUNT(list) (sizeof(list) / sizeof(list)[0])

void run_manual(void)
{
    for (size_t i = 0; i < COUNT(messages); i++)
        run_example(&messages[i], &rkm04_hdlc, false);
    for (size_t i = 0; i < COUNT(messages); i++)
        run_example(&messages[i], &rkm04_plain, false);
    for (size_t i = 0; i < COUNT(chapters_4_and_7); i++)
        run_example(&chapters_4_and_7[i], &rkm04_hdlc, false);
    for (size_t i = 0; i < COUNT(chapter_9); i++)
        run_example(&chapter_9[i], &rkm04_plain, false);
    for (size_t i = 0; i < COUNT(long_motions); i++)
        run_example(&long_motions[i], &rkm04_hdlc, true);
    for (size_t i = 0; i < COUNT(limits); i++)
        run_example(&limits[i], &rkm04_hdlc, false);
}

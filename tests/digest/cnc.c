/* SPDX-License-Identifier: MIT */
/* cnc.c: the digest of the CNC872's core, a program of its own with the main_*.c of the RKM04's: random machines, NC programs and
 * operators, and a PLC program that computes with REAL numbers in every T.
 *
 * The dice are thrown at most once in a list of arguments or values: compilers work those out in any order. */
#include <string.h>

#include "cnc872/cnc872.h"
#include "digest.h"

#define STORIES_OF_A_CNC 150u
#define TURNS 700u
#define TEXT_MAX 2000u
#define LINE_MAX 100

static const char plc_text[] = "DATA\nX DQ 0\nN DQ 1\nLATE BIT 0\nDATA_END\n"
                               "MODULE_BLOCK_INIT\n LDR PO_OSYPI\n JL0 GO\n EX\n LDR LATE\n EX0\nGO:\nMODULE_BLOCK_INIT_END\n"
                               "MODULE_MAIN\n"
                               " LOD REAL.X\n AD BLK[0].AxNC[0]\n MULB BLK[0].FeedProgr\n SU BLK[1].BlockLen\n"
                               " DIVB REAL.rAxNCParabAccel[1]\n DIVB BLK[0].FeedMax\n STO REAL.X\n"
                               " LOD REAL.X\n GE BLK[0].AxNC[1]\n WR LATE\n"
                               " LOD QWRD.N\n MULB DWRD.B_INK\n AD QWRD.X\n DIVB CNST.7\n XORB QWRD.POSITION_POS5_EX[2]\n"
                               " STO QWRD.N\n"
                               "MODULE_MAIN_END\n";

static struct cnc cnc;
static struct cnc_config config;
static struct cnc_plc_program plc;
static struct cnc_nc_block blocks[64];
static int64_t values[512];
static struct cnc_nc_program program = {.blocks = blocks, .values = values, .block_room = 64, .value_room = 512};
static uint64_t dice, digest, events, wrong;

/* splitmix64 */
static uint32_t draw(uint32_t below)
{
    uint64_t z = dice += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return (uint32_t)((z ^ z >> 31) % below);
}

static void on_error(void *context, const struct cnc_text_error *error)
{
    (void)context;
    (void)error;
    wrong++;
}

static void on_event(void *context, enum cnc_event event, int64_t value)
{
    (void)context;
    mix(&digest, (uint64_t)event << 56 ^ (uint64_t)value);
    events++;
}

/* ---- Machine and program ------------------------------------------------------------------------------------------------ */

static void add(char *text, const char *before, uint32_t number, const char *after)
{
    append(text, TEXT_MAX, before);
    append_number(text, TEXT_MAX, number);
    append(text, TEXT_MAX, after);
}

static void make_machine(void)
{
    static const char *const names[] = {"X", "Y", "Z"};
    char xml[TEXT_MAX] = "";
    add(xml, "<ChannelConfig AccelerationType=\"", draw(2), "\">");
    for (unsigned axis = 0; axis < 3; axis++) {
        append(xml, TEXT_MAX, "<Axis Name=\"");
        append(xml, TEXT_MAX, names[axis]);
        add(xml, "\" Acceleration=\"", 100 + draw(3000), "\"");
        add(xml, " LinearAccel=\"", 100 + draw(3000), "\"");
        add(xml, " ParabAccel=\"", 3 + draw(60), ".125\"");
        add(xml, " FeedRT=\"", 3000 + draw(20000), "\"");
        add(xml, " Lag=\"", 1 + draw(20), "\"/>");
    }
    append(xml, TEXT_MAX, "<Gear No=\"1\" MaxSpeed=\"4000\"/></ChannelConfig>");
    cnc_config_read(xml, text_length(xml), &config, on_error, NULL);
}

static void make_program(void)
{
    char nc[TEXT_MAX] = "M3 S500\n";
    const unsigned lines = 3 + draw(8);
    for (unsigned line = 0; line < lines; line++) {
        const uint32_t kind = draw(8);
        append(nc, TEXT_MAX, kind == 0 ? "G0" : kind == 1 ? "G23 G1" : kind == 2 ? "G24 G1" : "G1");
        const uint32_t part = draw(2);
        add(nc, " X", draw(12), part == 0 ? ".25" : "");
        if (draw(3) != 0)
            add(nc, " Y", draw(9), ".003906");
        if (draw(3) == 0)
            add(nc, " Z-", draw(5), "");
        add(nc, " F", 200 + draw(9000), "");
        if (draw(8) == 0)
            add(nc, " G4 P0.0", 1 + draw(9), "");
        if (draw(6) == 0)
            add(nc, " M", 90 + draw(8), "");
        append(nc, TEXT_MAX, "\n");
    }
    cnc_nc_read(nc, text_length(nc), &config, &program, on_error, NULL);
}

/* ---- Operator ----------------------------------------------------------------------------------------------------------- */

static void act(void)
{
    switch (draw(10)) {
    case 0: cnc_stop(&cnc); break;
    case 1: cnc.panel.feed = (uint16_t)draw(201); break;
    case 2: cnc_put_bit(&cnc.cells, CNC_BIT_MPxPI, draw(3) != 0); break;
    case 3: cnc_put_bit(&cnc.cells, CNC_BIT_STOP_EMERGENCY_REQ, draw(4) == 0); break;
    case 4: cnc_put_bit(&cnc.cells, CNC_BIT_VAZBA_x + 1u, draw(2) != 0); break;
    case 5: cnc_put_number(&cnc.cells, CNC_CELL_FEED_OVR_MULTIPLIER, 0, 300 + draw(900)); break;
    case 6:
        if (draw(8) == 0)
            cnc_reset(&cnc);
        break;
    default: mix(&digest, (uint64_t)cnc_start(&cnc)); break;
    }
}

/* ---- What is seen ------------------------------------------------------------------------------------------------------- */

static void mix_real(double real)
{
    uint64_t bits;
    memcpy(&bits, &real, sizeof bits);
    mix(&digest, bits);
}

static void mix_cell(const char *name)
{
    struct cnc_operand operand;
    struct cnc_text_fault fault;
    if (cnc_parse_operand(name, text_length(name), &plc.names, &operand, &fault))
        mix(&digest, (uint64_t)cnc_read_number(&cnc.cells, operand.place, operand.type));
    else
        wrong++;
}

static void look(void)
{
    static const char *const names[] = {"QWRD.X", "QWRD.N", "TIME_DIST", "DIFCIT_X[1]", "VYSOVERS", "REQ_SPEED_PM", "B_POL",
                                        "B_INK", "STATUS_RESTART", "PB06", "QWRD.rAxGParabAccel"};
    for (unsigned axis = 0; axis < 3; axis++) {
        mix(&digest, (uint64_t)cnc.axis[axis].position);
        mix(&digest, (uint64_t)cnc.axis[axis].actual);
    }
    mix(&digest, (uint64_t)cnc.move.v);
    mix(&digest, (uint64_t)cnc.machine.phase << 32 | cnc.machine.block);
    for (unsigned i = 0; i < sizeof names / sizeof names[0] && cnc.turn % 16u == 0; i++)
        mix_cell(names[i]);
    if (cnc.turn % 16u == 0) {
        mix_real(cnc_queue_real(&cnc, 0, CNC_QUEUE_FeedMax, 0));
        mix_real(cnc_queue_real(&cnc, 0, CNC_QUEUE_BlockLen, 0));
        mix_real(cnc_queue_real(&cnc, 1, CNC_QUEUE_FeedCriterial, 0));
    }
}

static void tell_story(unsigned number)
{
    static const struct cnc_port port = {.event = on_event};
    dice = number;
    digest = events = 0;
    make_machine();
    make_program();
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .program = &program, .plc = &plc, .port = &port});
    cnc_start(&cnc);
    for (unsigned turn = 0; turn < TURNS; turn++) {
        if (draw(40) == 0)
            act();
        cnc_tick(&cnc);
        look();
    }
}

void digest_run(void (*say)(const char *line))
{
    uint64_t all = 0, count = 0;
    if (!cnc_translate_plc(plc_text, sizeof plc_text - 1, &plc, on_error, NULL))
        wrong++;
    for (unsigned number = 1; number <= STORIES_OF_A_CNC; number++) {
        char name[LINE_MAX] = "cnc-";
        tell_story(number);
        mix(&all, digest);
        count += events;
        append_number(name, sizeof name, number);
        digest_line(say, name, digest, events);
    }
    digest_line(say, wrong == 0 ? "all" : "a text is wrong", all, count);
}

/* SPDX-License-Identifier: MIT */
/* Whatever cells and the panel ask for, at any time: no axis goes faster than FeedRT, none changes its speed by more than
 * AccelerationEmergency but where a motion may stop at once (NM9), and none moves that the configuration does not have. */
#include <stdlib.h>

#include "cnc872/frame.h"
#include "cnc_rig.h"

#define TURNS 3000u
#define EMERGENCY 131072 /* u/T^2 */
#define ROUNDING 3       /* u: an axis of a path is rounded down in each T */

static const char xml[] =
    "<ChannelConfig><Axis Name=\"X\" SlsMinus=\"-5\" SlsPlus=\"30\"/>"
    "<Axis Name=\"Y\" RefDir=\"+\" RefMethod=\"1\" Lag=\"7\" MaxLag=\"3000\"/><Axis Name=\"4\" Rotary=\"1\" RefMethod=\"2\"/>"
    "<Gear No=\"1\" MaxSpeed=\"500\"/><Gear No=\"3\" MinSpeed=\"100\" MaxSpeed=\"3000\"/></ChannelConfig>";
static const char nc[] = "M3 S400\nG23 G1 X10 F2000\nX12 Y1\nX20 Y2\nG24 G0 A4=500 X3\nM43 S2000\nG4 P0.05 T12\nG33 X5 F1\n"
                         "G96 S100 L500 G95 G1 Y5 F0.2\nG97 G94 M41 S300 X0 F500 M48\nM49 M0\nM17 X1\n";

static uint64_t seed;

static uint32_t draw(uint32_t below)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(seed >> 33) % below;
}

/* Any value in any cell that may be written. */
static void write_any_cell(void)
{
    const struct cnc_row *row;
    do
        row = &cnc_rows[draw(cnc_row_count)];
    while (!row->writable);
    const unsigned index = draw(row->count > 0 ? row->count : 1);
    const int64_t value = (int64_t)((uint64_t)draw(UINT32_MAX) << 32 | draw(UINT32_MAX)) >> draw(60);
    if (row->type == CNC_BIT) {
        const unsigned place = row->place + (row->numbering == CNC_PLAIN ? 0 : index);
        const bool is_rare = place == CNC_BIT_EXT_PLC || place == CNC_BIT_START_DISABLE || place == CNC_BIT_START_SUSPEND;
        const bool enables = place <= CNC_LAST_BIT_MPxPI; /* the first bits of all */
        cnc_put_bit(&cnc.cells, place, is_rare ? draw(20) == 0 : enables ? draw(4) != 0 : draw(2) == 0);
    } else if (row->type == CNC_REAL) {
        cnc_put_real(&cnc.cells, (enum cnc_cell)(row - cnc_rows), index, (double)value);
    } else {
        cnc_put_number(&cnc.cells, (enum cnc_cell)(row - cnc_rows), index, value);
    }
}

static void press_any_key(void)
{
    switch (draw(9)) {
    case 0: cnc.panel.manual = draw(2) == 0; break;
    case 1: cnc.panel.jog_plus = (uint16_t)draw(16); break;
    case 2: cnc.panel.jog_minus = (uint16_t)draw(16); break;
    case 3: cnc.panel.feed = (uint16_t)draw(300); break;
    case 4: cnc.panel.rapid = draw(2) == 0; break;
    case 5: cnc.panel.block_by_block = draw(4) == 0; break;
    case 6: cnc_select(&cnc, draw(14), draw(2) == 0); break;
    case 7: cnc_set_critical(&cnc, (uint8_t)(draw(20) == 0)); break;
    default: cnc_reset(&cnc); break;
    }
}

static void ask_for_anything(void)
{
    switch (draw(12)) {
    case 0:
    case 1: cnc_start(&cnc); break;
    case 2: cnc_stop(&cnc); break;
    case 3: cnc_home(&cnc, draw(5)); break;
    case 4: cnc_position_spindle(&cnc, 3); break;
    case 5: cnc_put_number(&cnc.cells, CNC_CELL_HOMING_REQ, 0, draw(16)); break;
    case 6: cnc_put_number(&cnc.cells, CNC_CELL_HOMING_START_REQ, 0, draw(16)); break;
    case 7: press_any_key(); break;
    default: write_any_cell(); break;
    }
}

/* Has a reference or HOMING_REQ given the axis another position in this T? */
static bool is_moved_in_space(unsigned i, int64_t asked, uint8_t kind)
{
    const int64_t asked_now = cnc_number(&cnc.cells, CNC_CELL_HOMING_REQ, 0);
    return ((asked & ~asked_now) >> i & 1) != 0 || (kind == CNC_SINGLE_REFERENCE && cnc.axis[i].kind == CNC_SINGLE_NONE);
}

static bool is_critical(void)
{
    return cnc_number(&cnc.cells, CNC_CELL_BZH13, 0) != 0;
}

static void check_turn(int64_t speed[CNC_AXES])
{
    int64_t before[CNC_AXES];
    uint8_t kind[CNC_AXES];
    const int64_t asked = cnc_number(&cnc.cells, CNC_CELL_HOMING_REQ, 0);
    const bool was_critical = is_critical();
    for (unsigned i = 0; i < CNC_AXES; i++) {
        before[i] = cnc.axis[i].position;
        kind[i] = cnc.axis[i].kind;
    }
    cnc_tick(&cnc);
    const bool may_halt = config.is_parabolic || was_critical || is_critical();
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const int64_t now = is_moved_in_space(i, asked, kind[i]) ? 0 : cnc.axis[i].position - before[i];
        const int64_t change = now > speed[i] ? now - speed[i] : speed[i] - now;
        const int64_t most = config.axis[i].is_configured ? cnc_speed_of(config.axis[i].feed_rapid) : 0;
        ck_assert_int_le(now < 0 ? -now : now, most);
        ck_assert_msg(change <= EMERGENCY + ROUNDING || may_halt || is_moved_in_space(i, asked, kind[i]),
                      "axis %u in T %u: %d after %d", i, (unsigned)cnc.turn, (int)now, (int)speed[i]);
        speed[i] = now;
    }
}

START_TEST(limits_hold_whatever_is_asked_for)
{
    int64_t speed[CNC_AXES] = {0};
    rig_power(xml, nc);
    seed = (uint64_t)_i * 77777 + 5;
    config.is_parabolic = _i % 2 != 0;
    /* The rig's list of events is too short for this. */
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .program = &program});
    while (cnc.turn < TURNS) {
        for (uint32_t count = draw(4); count > 0; count--)
            ask_for_anything();
        check_turn(speed);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_any_request");
    TCase *all = tcase_create("any request");
    tcase_set_timeout(all, 60);
    tcase_add_loop_test(all, limits_hold_whatever_is_asked_for, 0, 12);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* SPDX-License-Identifier: MIT */
/* panel.c: what stands beside the motion: time, switches of the machine, displays, backup memory (NO1 to NO3, NJ4). */
#include "frame.h"

/* ---- Time (NO1) --------------------------------------------------------------------------------------------------------- */

#define FILETIME_2000 INT64_C(125911584000000000) /* 100 ns from 1601-01-01 to 2000-01-01 */
#define MS_PER_DAY 86400000

/* The date of a day, 0: 2000-01-01. Years begin with March here, so that the day that leap years have more is the last one. */
static void put_date(struct cnc *cnc, uint64_t day)
{
    static const enum cnc_cell dates[] = {CNC_CELL_SYST_DATE_INFO, CNC_CELL_UTC_DATE_INFO};
    const uint64_t since = day + 730425; /* 0000-03-01 */
    const uint64_t era = since / 146097, in_era = since % 146097;
    const uint64_t years = (in_era - in_era / 1460 + in_era / 36524 - in_era / 146096) / 365;
    const uint64_t in_year = in_era - (365 * years + years / 4 - years / 100), months = (5 * in_year + 2) / 153;
    const uint64_t month = months < 10 ? months + 3 : months - 9;
    for (unsigned i = 0; i < 2; i++) {
        const unsigned place = cnc_cell_place(dates[i]);
        cnc_write_number(&cnc->cells, place, CNC_WORD, (int64_t)(era * 400 + years + (month <= 2)));
        cnc_write_number(&cnc->cells, place + 2, CNC_BYTE, (int64_t)(in_year - (153 * months + 2) / 5 + 1));
        cnc_write_number(&cnc->cells, place + 3, CNC_BYTE, (int64_t)month);
    }
}

void cnc_put_time(struct cnc *cnc)
{
    static const enum cnc_cell times[] = {CNC_CELL_SYST_TIME_INFO, CNC_CELL_UTC_TIME_INFO};
    const unsigned ms = (unsigned)(cnc->turn % MS_PER_DAY);
    for (unsigned i = 0; i < 2; i++) {
        const unsigned place = cnc_cell_place(times[i]);
        cnc_write_number(&cnc->cells, place, CNC_BYTE, ms / 60000 % 60);
        cnc_write_number(&cnc->cells, place + 1, CNC_BYTE, ms / 3600000);
        cnc_write_number(&cnc->cells, place + 2, CNC_BYTE, ms / 10 % 100);
        cnc_write_number(&cnc->cells, place + 3, CNC_BYTE, ms / 1000 % 60);
    }
    cnc_write_number(&cnc->cells, cnc_cell_place(CNC_CELL_FILETIME_INFO), CNC_QWRD,
                     FILETIME_2000 + (int64_t)cnc->turn * 10000);
    put_date(cnc, cnc->turn / MS_PER_DAY);
}

/* ---- Switches of the machine (NJ4) -------------------------------------------------------------------------------------- */

void cnc_drive_switches(struct cnc *cnc)
{
    for (unsigned i = 0; i < cnc->switch_count; i++) {
        const struct cnc_switch *driven = &cnc->switches[i];
        const int64_t position = cnc_position(cnc, driven->axis, 6);
        cnc_set(cnc, driven->place, (!driven->has_at_least || position >= driven->at_least) &&
                                        (!driven->has_at_most || position <= driven->at_most));
    }
    static const enum cnc_cell keys[] = {CNC_CELL_PTLTOC_P1, CNC_CELL_PTLTOC_P1_2, CNC_CELL_PTLTOC_P2, CNC_CELL_PTLTOC_P2_2};
    for (unsigned i = 0; i < 4; i++)
        cnc_put_number(&cnc->cells, keys[i], 0, cnc->panel.key[i]);
}

/* ---- Displays (NO2) ----------------------------------------------------------------------------------------------------- */

void cnc_take_displays(struct cnc *cnc)
{
    for (unsigned which = 0; which < CNC_DISPLAYS; which++) {
        if (cnc_is_set(cnc, CNC_BIT_BUSY_DISPTOC1 + which))
            continue;
        struct cnc_display *display = &cnc->display[which];
        const uint8_t *at = cnc->cells.memory + cnc_cell_place(which == 0 ? CNC_CELL_DISPTOC1 : CNC_CELL_DISPTOC2);
        const unsigned line = at[0] / 8u, column = at[1] / 8u;
        for (unsigned i = 0; i < 4; i++)
            if (at[2 + i] != 0 && at[2 + i] != 0xFF && line < CNC_DISPLAY_LINES && column + i < CNC_DISPLAY_COLUMNS)
                display->text[line][column + i] = at[2 + i];
        display->size = at[6];
        display->inverse = at[7];
    }
}

/* ---- Backup memory (NO3) ------------------------------------------------------------------------------------------------ */

void cnc_take_backup(struct cnc *cnc)
{
    if (!cnc_is_set(cnc, CNC_BIT_REQ_BACKUP_MEM)) {
        cnc->backup_pause = 0;
        return;
    }
    if (cnc->backup_pause > 0 && --cnc->backup_pause > 0)
        return;
    const bool has_place = cnc->port != NULL && cnc->port->save_backup != NULL;
    const bool is_saved = !has_place || cnc->port->save_backup(cnc->context, cnc_backup(cnc), CNC_BACKUP_SIZE);
    if (is_saved)
        cnc_set(cnc, CNC_BIT_REQ_BACKUP_MEM, false);
    else
        cnc->backup_pause = CNC_BACKUP_PAUSE;
    cnc_report_event(cnc, is_saved ? CNC_EVENT_SAVED : CNC_EVENT_NOT_SAVED, 0);
}

const uint8_t *cnc_backup(const struct cnc *cnc)
{
    return cnc->cells.memory + cnc_cell_place(CNC_CELL_PLC_MEM_BACKUP);
}

/* SPDX-License-Identifier: MIT */
#include "event_filter.h"

#include <stdio.h>
#include <string.h>

#include "text/text.h"

#define ALL_MOTORS 0x1Eu
#define ALL_UNITS 0x1FFFEu

static bool read_kinds(const json_t *kinds, uint32_t *chosen, struct refusal *refusal)
{
    size_t i;
    const json_t *kind;
    if (!kinds)
        return true;
    if (!json_is_array(kinds) || json_array_size(kinds) == 0) {
        refuse(refusal, REFUSED_PARAMS, "kinds: expected a list of names, as in [\"motion\", \"outputs\"]");
        return false;
    }
    *chosen = 0;
    json_array_foreach(kinds, i, kind) {
        enum watch_kind found = json_is_string(kind) ? watch_kind_named(json_string_value(kind)) : WATCH_KINDS;
        if (found == WATCH_KINDS) {
            char list[200] = "";
            for (unsigned k = 0; k < WATCH_KINDS; k++)
                snprintf(list + strlen(list), sizeof list - strlen(list), k > 0 ? ", %s" : "%s",
                         watch_kind_name((enum watch_kind)k));
            const char *name = json_is_string(kind) ? json_string_value(kind) : "?";
            refuse(refusal, REFUSED_PARAMS, "kinds: unknown event kind `%.40s'; kinds are: %s%s", name, list,
                   nearest_hint(name, list));
            return false;
        }
        *chosen |= WATCH_BIT(found);
    }
    return true;
}

static bool add_motor(struct sim *sim, const json_t *motor, uint32_t *chosen, struct refusal *refusal)
{
    const unsigned axes = sim_device(sim)->axes;
    if (json_is_integer(motor) && json_integer_value(motor) >= 1 && json_integer_value(motor) <= axes) {
        *chosen |= 1u << (unsigned)json_integer_value(motor);
        return true;
    }
    refuse(refusal, REFUSED_PARAMS, "motor: expected a number from 1 to %u, or a list of them", axes);
    return false;
}

static bool add_unit(struct sim *sim, const json_t *unit, uint32_t *chosen, struct refusal *refusal)
{
    json_t *params = json_pack("{s:O}", "unit", unit);
    unsigned number = param_unit(sim, params, refusal);
    json_decref(params);
    *chosen |= 1u << number;
    return number > 0;
}

/* One or a list of them; left out: all. */
static bool read_some(struct sim *sim, const json_t *given,
                      bool (*add)(struct sim *sim, const json_t *one, uint32_t *chosen, struct refusal *refusal),
                      uint32_t *chosen, struct refusal *refusal)
{
    size_t i;
    const json_t *one;
    if (!given)
        return true;
    *chosen = 0;
    if (!json_is_array(given) || json_array_size(given) == 0)
        return add(sim, given, chosen, refusal);
    json_array_foreach(given, i, one) {
        if (!add(sim, one, chosen, refusal))
            return false;
    }
    return true;
}

bool event_filter_read(struct event_filter *filter, struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"kinds", "motor", "unit", "cells", "collect", NULL};
    const json_t *cells = json_object_get(params, "cells"), *kinds = json_object_get(params, "kinds");
    *filter = (struct event_filter){WATCH_ALL, ALL_MOTORS, ALL_UNITS};
    if (!read_kinds(kinds, &filter->kinds, refusal))
        return false;
    if (cells)
        filter->kinds = (kinds ? filter->kinds : 0) | WATCH_BIT(WATCH_CELL);
    else if (kinds && (filter->kinds & WATCH_BIT(WATCH_CELL)) != 0)
        return refuse(refusal, REFUSED_PARAMS, "cells: expected a list of cells beside the kind `cell'") != NULL;
    return params_known(params, names, refusal) &&
           read_some(sim, json_object_get(params, "motor"), add_motor, &filter->motors, refusal) &&
           read_some(sim, json_object_get(params, "unit"), add_unit, &filter->units, refusal);
}

/* ---- Cells -------------------------------------------------------------------------------------------------------------- */

/* Returns {cell: value}, NULL: refused. */
static json_t *watch_cells(struct sim *sim, const struct watcher *watcher, const json_t *params, struct refusal *refusal)
{
    const json_t *cells = json_object_get(params, "cells"), *cell;
    const unsigned unit = param_unit(sim, params, refusal);
    size_t at;
    if (unit == 0)
        return NULL;
    if (!json_is_array(cells) || json_array_size(cells) == 0 || json_array_size(cells) > EVENT_CELLS_MAX)
        return refuse(refusal, REFUSED_PARAMS, "cells: expected a list of up to %u cells, as in [\"PO_STOP\"]", EVENT_CELLS_MAX);
    json_t *values = json_object();
    json_array_foreach((json_t *)cells, at, cell) {
        struct device_refusal why = {.text = "expected names of cells"};
        const char *name = json_string_value(cell);
        const struct watch_cell *found = name ? sim_watch_cell(sim, watcher, unit, name, &why) : NULL;
        if (!found) {
            json_decref(values);
            return refuse(refusal, why.is_state ? REFUSED_STATE : REFUSED_PARAMS, "cells: %s", why.text);
        }
        json_object_set_new(values, name, json_integer((json_int_t)found->value));
    }
    return values;
}

json_t *event_watch(struct sim *sim, struct watcher *watcher, const struct event_filter *filter, unsigned number,
                    const json_t *params, struct refusal *refusal)
{
    json_t *values = NULL;
    watcher->kinds = filter->kinds;
    sim_watch(sim, watcher);
    if (json_object_get(params, "cells")) {
        values = watch_cells(sim, watcher, params, refusal);
        if (!values) {
            sim_unwatch(sim, watcher);
            return NULL;
        }
    }
    return json_pack("{s:I, s:i, s:o*}", "t_us", (json_int_t)sim_now(sim), "subscription", (int)number, "cells", values);
}

bool event_filter_passes(const struct event_filter *filter, const struct sim *sim, const struct watcher *watcher,
                         const struct watch_event *event)
{
    if (event->kind == WATCH_CELL && sim->watch.cells[event->number].owner != watcher)
        return false;
    return (!event->motor || (filter->motors >> event->motor & 1u)) && (!event->unit || (filter->units >> event->unit & 1u));
}

/* SPDX-License-Identifier: MIT */
#include "plant_model.h"

static json_t *hold_json(enum plant_hold hold)
{
    static const enum plant_event news[] = {[PLANT_AT_STOP] = PLANT_END_STOP,
                                            [PLANT_JAMMED] = PLANT_JAM,
                                            [PLANT_STALLED] = PLANT_STALL,
                                            [PLANT_NO_LEAD] = PLANT_LEAD,
                                            [PLANT_NO_TORQUE] = PLANT_FIELD};
    return hold == PLANT_MOVES ? json_null() : json_string(plant_event_name(news[hold]));
}

static json_t *angle_json(const struct plant_motor *motor)
{
    if (motor->turn == 0)
        return json_null();
    return json_integer((motor->position % motor->turn + motor->turn) % motor->turn);
}

/* An end of an axis or of a range; null: there is none on that side. */
static json_t *end_json(int64_t position)
{
    return position == INT64_MIN || position == INT64_MAX ? json_null() : json_integer((json_int_t)position);
}

static json_t *stops_json(const struct plant_motor *motor)
{
    return json_pack("{s:o, s:o}", "low", end_json(motor->low), "high", end_json(motor->high));
}

static json_t *motors_json(const struct plant *plant)
{
    json_t *list = json_array();
    for (unsigned at = 0; at < plant->axes; at++) {
        const struct plant_motor *motor = &plant->motor[at];
        if (!motor->present)
            continue;
        json_t *item = json_pack("{s:i, s:I, s:o, s:o, s:o, s:I, s:o, s:b, s:b}", "motor", (int)(at + 1u), "true_position",
                                 (json_int_t)motor->position, "angle", angle_json(motor), "turn",
                                 motor->turn > 0 ? json_integer((json_int_t)motor->turn) : json_null(), "stops",
                                 stops_json(motor), "lost", (json_int_t)motor->lost, "hold", hold_json(motor->hold), "jammed",
                                 (int)plant_is_jammed(plant, at + 1u), "missing_lead", (int)motor->no_lead);
        if (json_array_append_new(list, item) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *switches_json(const struct plant *plant)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < plant->switches; i++) {
        const struct plant_switch *contact = &plant->contact[i];
        json_t *item = json_pack("{s:i, s:i, s:o, s:o, s:b, s:b}", "input", (int)contact->input, "motor", (int)contact->motor,
                                 "from", end_json(contact->low), "to", end_json(contact->high), "actuated", (int)contact->on,
                                 "bouncing", (int)(contact->next != DEVICE_NEVER));
        if (json_array_append_new(list, item) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

json_t *plant_json(const struct plant *plant)
{
    if (!plant)
        return json_null();
    return json_pack("{s:o, s:o, s:i, s:i}", "motors", motors_json(plant), "switches", switches_json(plant), "mask",
                     (int)plant->mask, "levels", (int)plant->levels);
}

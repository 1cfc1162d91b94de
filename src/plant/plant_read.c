/* SPDX-License-Identifier: MIT */
/* plant_read.c: plants as they are in a file: docs/PLANT.md. */
#include <stdlib.h>
#include <string.h>

#include "plant_model.h"
#include "text/text.h"

#define SPEED_MAX 1000000
#define ACCELERATION_MAX 1000000000
#define BOUNCE_MAX 1000000u /* ticks */

static bool is_map(const struct config_node *node, const char *what)
{
    return config_type(node) == CONFIG_MAP || config_error(node, "expected %s", what);
}

/* A key that may be left out: then `value` stays what it is. */
static bool read_position(const struct config_node *node, const char *key, const char *what, int64_t *value)
{
    const struct config_node *given = config_get(node, key);
    return !given || config_integer(given, what, -PLANT_POSITION_MAX, PLANT_POSITION_MAX, value);
}

static bool read_time(const struct config_node *node, const char *key, const char *what, uint64_t *ticks)
{
    const struct config_node *given = config_get(node, key);
    return !given || config_time(given, what, ticks);
}

static bool read_flag(const struct config_node *node, const char *key, const char *what, bool *value)
{
    const struct config_node *given = config_get(node, key);
    return !given || config_flag(given, what, value);
}

/* ---- Motors --------------------------------------------------------------------------------------------------------- */

static bool read_stops(const struct config_node *motor, struct plant_motor *to)
{
    static const char *const names[] = {"low", "high", NULL};
    const struct config_node *node = config_get(motor, "stops");
    if (!node)
        return true;
    if (!is_map(node, "the end stops, as in {low: -50, high: 20000}") || !config_keys(node, names) ||
        !read_position(node, "low", "the lower end stop", &to->low) ||
        !read_position(node, "high", "the upper end stop", &to->high))
        return false;
    return to->low <= to->high || config_error(node, "expected a lower end stop that is not above the upper one");
}

static bool read_jam(const struct config_node *node, struct plant_motor *to)
{
    static const char *const names[] = {"from", "to", NULL};
    struct plant_window window = {0, DEVICE_NEVER};
    if (!is_map(node, "a jam, as in {from: 2s, to: 2500ms}") || !config_keys(node, names) ||
        !read_time(node, "from", "the beginning of the jam", &window.from) ||
        !read_time(node, "to", "the end of the jam", &window.until))
        return false;
    if (window.from >= window.until)
        return config_error(node, "expected a jam that ends after it begins");
    if (to->jams == PLANT_JAMS)
        return config_error(node, "expected at most %u jams of a motor", PLANT_JAMS);
    to->jam[to->jams++] = window;
    return true;
}

/* One, or a list of them. */
static bool read_jams(const struct config_node *motor, struct plant_motor *to)
{
    const struct config_node *node = config_get(motor, "jam");
    if (!node || config_type(node) != CONFIG_LIST)
        return !node || read_jam(node, to);
    for (size_t i = 0; i < config_count(node); i++)
        if (!read_jam(config_at(node, i), to))
            return false;
    return true;
}

static bool read_point(const struct config_node *node, struct plant_stall *to)
{
    static const char *const names[] = {"speed", "acceleration", NULL};
    const struct config_node *speed = config_get(node, "speed"), *acceleration = config_get(node, "acceleration");
    int64_t v, a;
    if (!is_map(node, "a point, as in {speed: 1000, acceleration: 20000}") || !config_keys(node, names))
        return false;
    if (!speed || !acceleration)
        return config_error(node, "expected speed and acceleration, as in {speed: 1000, acceleration: 20000}");
    if (!config_integer(speed, "a speed in steps/s", 1, SPEED_MAX, &v) ||
        !config_integer(acceleration, "an acceleration in steps/s^2", 0, ACCELERATION_MAX, &a))
        return false;
    if (to->points == PLANT_POINTS)
        return config_error(node, "expected at most %u points", PLANT_POINTS);
    if (to->points > 0 && v <= (int64_t)to->point[to->points - 1u].speed)
        return config_error(speed, "expected points with speeds that increase");
    to->point[to->points++] = (struct plant_point){(uint32_t)v, (uint32_t)a};
    return true;
}

static bool read_stall(const struct config_node *motor, struct plant_stall *to)
{
    static const char *const names[] = {"start", "limit", NULL};
    const struct config_node *node = config_get(motor, "stall");
    int64_t start;
    if (!node)
        return true;
    if (!is_map(node, "the limits of the motor, as in {start: 500, limit: [{speed: 4000, acceleration: 20000}]}") ||
        !config_keys(node, names))
        return false;
    const struct config_node *limit = config_get(node, "limit"), *first = config_get(node, "start");
    if (!first || !limit)
        return config_error(node, "expected start and limit, as in {start: 500, limit: [{speed: 4000, acceleration: 20000}]}");
    if (!config_integer(first, "the highest speed to start with, in steps/s", 1, SPEED_MAX, &start))
        return false;
    to->start = (uint32_t)start;
    if (config_type(limit) != CONFIG_LIST || config_count(limit) == 0)
        return config_error(limit, "expected a list of points, as in [{speed: 4000, acceleration: 20000}]");
    for (size_t i = 0; i < config_count(limit); i++)
        if (!read_point(config_at(limit, i), to))
            return false;
    return true;
}

/* Where it is: the counter and the offset. */
static bool read_offset(const struct config_node *node, int64_t counter, struct plant_motor *to)
{
    int64_t offset = 0;
    if (!read_position(node, "offset", "the offset", &offset))
        return false;
    to->position = counter + offset;
    if (to->position >= to->low && to->position <= to->high)
        return true;
    return config_error(node, "expected a motor between its end stops, found it at %lld (counter %lld, offset %lld)",
                        (long long)to->position, (long long)counter, (long long)offset);
}

/* `1:` and nothing after it, or null. */
static bool is_nothing(const struct config_node *node)
{
    const char *text = config_text(node);
    return text && (*text == '\0' || strcmp(text, "~") == 0 || strcmp(text, "null") == 0);
}

/* The leads of the device to which those of the motor are connected. */
static bool read_coils(const struct config_node *motor, struct plant_motor *to)
{
    const struct config_node *node = config_get(motor, "coils");
    if (!node)
        return true;
    if (config_type(node) != CONFIG_LIST || config_count(node) != 4)
        return config_error(node, "expected the leads of the device at lead 1 to 4 of the motor, as in [1, 2, 3, 4]");
    for (unsigned i = 0; i < 4; i++) {
        int64_t lead;
        if (!config_integer(config_at(node, i), "a lead of the device, or 0 for none", 0, 4, &lead))
            return false;
        for (unsigned before = 0; before < i && lead > 0; before++)
            if (to->lead[before] == lead)
                return config_error(config_at(node, i), "expected each lead once");
        to->lead[i] = (uint8_t)lead;
    }
    return true;
}

static bool read_motor(const struct config_node *node, int64_t counter, bool has_coils, struct plant_motor *to)
{
    const char *const names[] = {"offset", "stops", "turn", "stall", "jam", "missing_lead", has_coils ? "coils" : NULL, NULL};
    const struct config_node *turn = config_get(node, "turn");
    to->present = true;
    if (is_nothing(node))
        return read_offset(node, counter, to);
    if (!is_map(node, "a motor, as in {offset: 0}") || !config_keys(node, names))
        return false;
    if (turn && !config_integer(turn, "the steps per turn", 2, PLANT_POSITION_MAX, &to->turn))
        return false;
    if (turn && config_get(node, "stops"))
        return config_error(turn, "expected turn or stops: a turntable has no end");
    return read_stops(node, to) && read_jams(node, to) && read_stall(node, &to->stall) &&
           read_flag(node, "missing_lead", "whether a lead is missing", &to->no_lead) && read_coils(node, to) &&
           read_offset(node, counter, to);
}

static bool read_motors(const struct config_node *node, const struct plant_device *device, struct plant *plant)
{
    char names[DEVICE_AXES_MAX][12];
    const char *numbers[DEVICE_AXES_MAX + 1u] = {NULL};
    for (unsigned at = 0; at < device->kind->axes; at++) {
        snprintf(names[at], sizeof names[at], "%u", at + 1u);
        numbers[at] = names[at];
    }
    if (!node)
        return true;
    if (!is_map(node, "motors by number, as in {1: {offset: 0}}") || !config_keys(node, numbers))
        return false;
    for (size_t i = 0; i < config_count(node); i++) {
        unsigned at = (unsigned)strtoul(config_key(node, i), NULL, 10) - 1u;
        if (!read_motor(config_at(node, i), device->position[at], device->has_coils[at], &plant->motor[at]))
            return false;
    }
    return true;
}

/* ---- Switches ------------------------------------------------------------------------------------------------------- */

static bool read_between(const struct config_node *node, const struct plant_motor *motor, struct plant_switch *to)
{
    if (config_type(node) != CONFIG_LIST || config_count(node) != 2)
        return config_error(node, "expected two positions, as in [100, 120]");
    if (!config_integer(config_at(node, 0), "a position", -PLANT_POSITION_MAX, PLANT_POSITION_MAX, &to->low) ||
        !config_integer(config_at(node, 1), "a position", -PLANT_POSITION_MAX, PLANT_POSITION_MAX, &to->high))
        return false;
    return to->low <= to->high || motor->turn > 0 || config_error(node, "expected the lower position first");
}

/* Where it is actuated: one of three. */
static bool read_zone(const struct config_node *node, const struct plant_motor *motor, struct plant_switch *to)
{
    const struct config_node *least = config_get(node, "at_least"), *most = config_get(node, "at_most");
    const struct config_node *between = config_get(node, "between");
    if ((least != NULL) + (most != NULL) + (between != NULL) != 1)
        return config_error(node, "expected one of at_least, at_most and between: [low, high]");
    to->low = motor->turn > 0 ? 0 : INT64_MIN;
    to->high = motor->turn > 0 ? motor->turn - 1 : INT64_MAX;
    if (between ? !read_between(between, motor, to)
                : !read_position(node, "at_least", "a position", &to->low) ||
                      !read_position(node, "at_most", "a position", &to->high))
        return false;
    bool angles = to->low >= 0 && to->low < motor->turn && to->high >= 0 && to->high < motor->turn;
    return motor->turn == 0 || angles ||
           config_error(node, "expected positions of a turntable, 0..%lld", (long long)motor->turn - 1);
}

static bool read_hysteresis(const struct config_node *node, const struct plant_motor *motor, struct plant_switch *to)
{
    if (!read_position(node, "hysteresis", "the hysteresis", &to->hysteresis))
        return false;
    if (to->hysteresis < 0)
        return config_error(node, "expected a hysteresis of 0 or more steps");
    int64_t width = motor->turn > 0 ? (to->high - to->low + motor->turn) % motor->turn + 1 : 0;
    return motor->turn == 0 || width + 2 * to->hysteresis < motor->turn ||
           config_error(node, "expected a smaller hysteresis: with this one the switch is always actuated");
}

/* Its number, or its name. */
static bool read_input(const struct config_node *node, const struct device_kind *kind, uint8_t *input)
{
    char expected[DEVICE_ERROR_SIZE];
    int64_t number;
    if (kind->input_names && config_type(node) == CONFIG_TEXT) {
        *input = (uint8_t)device_input_named(kind, config_text(node));
        return *input > 0 || config_error(node, "expected an input %s", device_input_names(kind, expected));
    }
    if (!config_integer(node, "an input", 1, kind->inputs, &number))
        return false;
    *input = (uint8_t)number;
    return true;
}

static bool read_switch(const struct config_node *node, const struct plant_device *device, const struct plant *plant,
                        struct plant_switch *to)
{
    static const char *const names[] = {"input",      "motor",  "at_least",        "at_most", "between",
                                        "hysteresis", "bounce", "normally_closed", NULL};
    if (!is_map(node, "a switch, as in {input: 01, motor: 1, at_most: 0}") || !config_keys(node, names))
        return false;
    const struct config_node *input = config_get(node, "input"), *motor = config_get(node, "motor");
    int64_t number;
    if (!input || !motor)
        return config_error(node, "expected input and motor, as in {input: 01, motor: 1, at_most: 0}");
    if (!read_input(input, device->kind, &to->input) || !config_integer(motor, "a motor", 1, device->kind->axes, &number))
        return false;
    const struct plant_motor *moves = &plant->motor[number - 1];
    to->motor = (uint8_t)number;
    if (!read_zone(node, moves, to) || !read_hysteresis(node, moves, to) ||
        !read_time(node, "bounce", "the bounce time", &to->bounce) ||
        !read_flag(node, "normally_closed", "whether it opens when it is actuated", &to->normally_closed))
        return false;
    return to->bounce <= BOUNCE_MAX || config_error(node, "expected a switch that bounces for at most 1s");
}

/* Switches may name a motor that nothing else is said about. */
static bool add_motor(const struct config_node *node, int64_t counter, struct plant_motor *motor)
{
    bool is_good = motor->present || read_offset(node, counter, motor);
    motor->present = true;
    return is_good;
}

static bool read_switches(const struct config_node *node, const struct plant_device *device, struct plant *plant,
                          uint64_t seed)
{
    if (!node)
        return true;
    if (config_type(node) != CONFIG_LIST)
        return config_error(node, "expected a list of switches");
    for (size_t i = 0; i < config_count(node); i++) {
        const struct config_node *item = config_at(node, i);
        if (plant->switches == PLANT_SWITCHES)
            return config_error(item, "expected at most %u switches", PLANT_SWITCHES);
        struct plant_switch *to = &plant->contact[plant->switches];
        if (!read_switch(item, device, plant, to))
            return false;
        to->random = ((seed ^ plant->switches) + 1u) * UINT64_C(0x9E3779B97F4A7C15) | 1u; /* not 0 */
        plant->switches++;
        plant->mask |= UINT32_C(1) << (to->input - 1u);
        if (!add_motor(item, device->position[to->motor - 1u], &plant->motor[to->motor - 1u]))
            return false;
        plant_switch_begin(plant, to);
    }
    return true;
}

struct plant *plant_read(const struct config_node *node, const struct plant_device *device, uint64_t now, uint64_t seed)
{
    static const char *const names[] = {"motors", "switches", NULL};
    struct plant *plant = NULL;
    if (!is_map(node, "motors and switches") || !config_keys(node, names))
        return NULL;
    plant = plant_new(device->kind->axes);
    if (!plant) {
        config_error(node, "out of memory");
        return NULL;
    }
    plant->now = now;
    if (!read_motors(config_get(node, "motors"), device, plant) ||
        !read_switches(config_get(node, "switches"), device, plant, seed)) {
        plant_free(plant);
        return NULL;
    }
    for (unsigned at = 0; at < device->kind->axes; at++)
        if (device->has_coils[at])
            coils_begin(&plant->motor[at], &device->coils[at], device->outputs);
    plant->levels = plant_contacts(plant);
    return plant;
}

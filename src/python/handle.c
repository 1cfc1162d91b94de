/* SPDX-License-Identifier: MIT */
#include "handle.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- Begin ------------------------------------------------------------------------------------------------------------ */

static bool read_units(const json_t *options, struct sim_config *config, struct refusal *refusal)
{
    const json_t *value = json_object_get(options, "units");
    const unsigned addresses = config->device->addresses;
    char number[24];
    const char *text = value ? json_string_value(value) : "1";
    if (json_is_integer(value)) {
        snprintf(number, sizeof number, "%lld", (long long)json_integer_value(value));
        text = number;
    }
    if (text && node_list_read_up_to(&config->nodes, text, addresses))
        return true;
    refuse(refusal, REFUSED_PARAMS, "units: expected up to 16 addresses from 1 to %u, as in \"3\" or \"1,2,5-8\"", addresses);
    return false;
}

static bool read_device(const json_t *options, struct sim_config *config, struct refusal *refusal)
{
    const char *name = json_object_get(options, "device") ? param_string(options, "device", refusal) : device_kind_at(0)->name;
    config->device = name ? device_kind_named(name) : NULL;
    if (name && !config->device)
        refuse(refusal, REFUSED_PARAMS, "device: unknown device `%.40s': expected one that `rkm04 devices' lists", name);
    return config->device != NULL;
}

/* The settings that the kind has of its own: framing, readings, version_text. */
static bool read_own(const json_t *options, struct sim_config *config, struct refusal *refusal)
{
    char error[DEVICE_ERROR_SIZE];
    for (const char *const *name = config->device->settings; name && *name; name++) {
        const json_t *value = json_object_get(options, *name);
        if (value && !config->device->read_setting(&config->unit, *name, value, error)) {
            refuse(refusal, REFUSED_PARAMS, "%s", error);
            return false;
        }
    }
    return true;
}

static bool has_known_keys(const json_t *options, const struct device_kind *kind, struct refusal *refusal)
{
    static const char *const common[] = {"units", "device", "plant", "seed", "turnaround", "timed", "journal"};
    const char *names[32];
    size_t count = sizeof common / sizeof common[0];
    memcpy(names, common, sizeof common);
    for (const char *const *name = kind->settings; name && *name && count < 31; name++)
        names[count++] = *name;
    names[count] = NULL;
    return params_known(options, names, refusal);
}

/* What is about a bus, of a device that has none. `timed` and `units` may have their defaults. */
static bool check_bus(const json_t *options, const struct sim_config *config, struct refusal *refusal)
{
    const char *given = config->nodes.count > 1                               ? "units"
                        : json_object_get(options, "turnaround")              ? "turnaround"
                        : json_is_false(json_object_get(options, "timed"))    ? "timed"
                                                                              : NULL;
    if (given && !config->device->receive)
        refuse(refusal, REFUSED_PARAMS, "%s: the device %s has no bus", given, config->device->name);
    return !given || config->device->receive;
}

static bool read_config(const json_t *options, struct sim_config *config, struct refusal *refusal)
{
    int64_t seed;
    uint64_t turnaround;
    if (!read_device(options, config, refusal) || !has_known_keys(options, config->device, refusal) ||
        !read_units(options, config, refusal) || !check_bus(options, config, refusal) || !read_own(options, config, refusal) ||
        !param_integer_or(options, "seed", 0, INT64_MAX, 1, &seed, refusal) ||
        !param_time(options, "turnaround", device_turnaround(config->device), &turnaround, refusal))
        return false;
    if (turnaround > SEGMENT_TURNAROUND_MAX) {
        refuse(refusal, REFUSED_PARAMS, "turnaround: expected at most %u us", SEGMENT_TURNAROUND_MAX);
        return false;
    }
    config->timed = !json_is_false(json_object_get(options, "timed"));
    config->seed = (uint64_t)seed;
    config->turnaround = (uint32_t)turnaround;
    return true;
}

static bool set_plant(struct handle *handle, const json_t *options, struct refusal *refusal)
{
    json_t *plant = json_object_get(options, "plant");
    if (!plant || json_is_null(plant))
        return true;
    json_t *params = json_pack("{s:O}", "plant", plant), *result = sim_command(&handle->sim, "plant.set", params, refusal);
    json_decref(params);
    json_decref(result);
    return result != NULL;
}

/* A command that takes long, as a restore from a file. */
static bool is_interrupted(void *context)
{
    const struct handle *handle = context;
    return handle->paused && handle->paused(handle->paused_context);
}

static bool begin(struct handle *handle, struct refusal *refusal)
{
    struct sim_config config = {.out = handle_host_receive, .context = handle};
    if (!read_config(handle->options, &config, refusal))
        return false;
    *refusal = (struct refusal){REFUSED_MEMORY, "out of memory"};
    handle->host.unit = line_settings_unit;
    handle->host.unit.baud = device_baud(config.device, &config.unit);
    handle_host_configure(handle, handle->host.unit);
    handle->sim.interrupted = is_interrupted;
    handle->sim.interrupted_context = handle;
    return sim_begin(&handle->sim, &config) && snapshots_attach(&handle->sim) && set_plant(handle, handle->options, refusal) &&
           (json_is_false(json_object_get(handle->options, "journal")) || snapshots_keep_journal(&handle->sim));
}

struct handle *handle_new(const json_t *options, struct refusal *refusal)
{
    struct handle *handle = calloc(1, sizeof *handle);
    *refusal = (struct refusal){REFUSED_MEMORY, "out of memory"};
    if (handle)
        handle->options = json_deep_copy(options);
    if (handle && handle->options && begin(handle, refusal))
        return handle;
    handle_free(handle);
    return NULL;
}

/* ---- End -------------------------------------------------------------------------------------------------------------- */

static json_t *stop_record(struct handle *handle, struct refusal *refusal)
{
    if (!handle->record)
        return refuse(refusal, REFUSED_STATE, "no recording is being written");
    json_t *result = json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(&handle->sim), "file", handle->record_path);
    int error = record_end(handle->record);
    if (output_file_close(handle->record_stream) != 0 && error == 0)
        error = errno;
    if (error != 0)
        refuse(refusal, REFUSED_STATE, "cannot write %.200s: %s", handle->record_path, strerror(error));
    free(handle->record_path);
    handle->record = NULL;
    handle->record_stream = NULL;
    handle->record_path = NULL;
    if (error == 0)
        return result;
    json_decref(result);
    return NULL;
}

void handle_free(struct handle *handle)
{
    struct refusal refusal;
    if (!handle)
        return;
    for (unsigned i = 0; i < TRACE_SET_MAX; i++)
        if (handle->traces.entry[i].number != 0)
            json_decref(trace_set_stop(&handle->traces.entry[i], &refusal));
    if (handle->record)
        json_decref(stop_record(handle, &refusal));
    handle_free_subscriptions(handle);
    sim_end(&handle->sim);
    json_decref(handle->options);
    free(handle->host.heard);
    free(handle);
}

/* ---- Methods ---------------------------------------------------------------------------------------------------------- */

typedef json_t *handle_method(struct handle *handle, const json_t *params, struct refusal *refusal);

static json_t *do_until(struct handle *handle, struct until *until, struct refusal *refusal)
{
    bool holds = false, is_done;
    if (until->condition)
        is_done = handle_advance_until(handle, until->condition, until->end, &holds);
    else
        is_done = handle_advance(handle, until->end);
    json_t *result = is_done ? until_answer(&handle->sim, until->condition, holds) : NULL;
    if (!is_done)
        refuse(refusal, REFUSED_STATE, "interrupted");
    condition_free(until->condition);
    return result;
}

static json_t *method_advance(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    struct until until;
    return until_read_advance(&until, &handle->sim, params, refusal) ? do_until(handle, &until, refusal) : NULL;
}

/* No other client advances this clock, so time passes. */
static json_t *method_wait(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    struct until until;
    return until_read_wait(&until, &handle->sim, params, refusal) ? do_until(handle, &until, refusal) : NULL;
}

/* As over the control socket, which does it on a stepped clock. */
static json_t *do_exchange(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    struct exchange exchange;
    if (!exchange_begin(&exchange, &handle->sim, params, refusal))
        return NULL;
    json_t *result = handle_advance(handle, exchange.end) ? exchange_answer(&exchange, &handle->sim, refusal)
                                                          : refuse(refusal, REFUSED_STATE, "interrupted");
    exchange_drop(&exchange);
    return result;
}

static json_t *method_clock(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"clock", NULL};
    if (!params_known(params, names, refusal))
        return NULL;
    if (json_object_get(params, "clock")) {
        const char *text = param_string(params, "clock", refusal);
        if (text && strcmp(text, "stepped") != 0)
            refuse(refusal, REFUSED_STATE, "clock: a bus in this process has no other clock: expected stepped");
        if (!text || strcmp(text, "stepped") != 0)
            return NULL;
    }
    return json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(&handle->sim), "clock", "stepped");
}

/* There is no port to the outside. */
static json_t *method_ready(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    if (!params_known(params, none, refusal))
        return NULL;
    return json_pack("{s:I, s:n, s:n, s:n, s:n, s:n}", "t_us", (json_int_t)sim_now(&handle->sim), "pty", "link", "port", "tcp",
                     "rfc2217");
}

static json_t *method_trace_start(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    return trace_set_start(&handle->traces, &handle->sim, params, refusal);
}

static json_t *method_trace_stop(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    struct trace_entry *entry = trace_set_find(&handle->traces, params, refusal);
    return entry ? trace_set_stop(entry, refusal) : NULL;
}

static bool has_begun(const struct handle *handle)
{
    return sim_now(&handle->sim) > 0 || handle->sim.segment.count > 0;
}

/* A recording with all that goes out; as `rkm04 serve --record`. */
static json_t *method_record_start(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"file", "force", NULL};
    const char *path = params_known(params, names, refusal) ? param_string(params, "file", refusal) : NULL;
    char *why = NULL;
    bool force;
    if (!path || !param_flag(params, "force", &force, refusal))
        return NULL;
    if (handle->record)
        return refuse(refusal, REFUSED_STATE, "a recording is being written already: %.200s", handle->record_path);
    if (has_begun(handle))
        return refuse(refusal, REFUSED_STATE, "a recording begins at tick 0, before anything is sent: it is tick %llu",
                      (unsigned long long)sim_now(&handle->sim));
    handle->record_stream = output_file_open(path, &output_recording, OUTPUT_REQUESTED | (force ? OUTPUT_FORCE : 0u), &why);
    if (!handle->record_stream) {
        refuse(refusal, REFUSED_STATE, "cannot write %.200s: %s", path, why ? why : "out of memory");
        free(why);
        return NULL;
    }
    handle->record_path = strdup(path);
    handle->record = handle->record_path ? record_begin(&handle->sim, handle->record_stream) : NULL;
    if (handle->record)
        return json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(&handle->sim), "file", path);
    output_file_close(handle->record_stream);
    free(handle->record_path);
    handle->record_path = NULL;
    handle->record_stream = NULL;
    return refuse(refusal, REFUSED_MEMORY, "out of memory");
}

static json_t *method_record_stop(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    return params_known(params, none, refusal) ? stop_record(handle, refusal) : NULL;
}

static const struct {
    const char *name;
    handle_method *function;
} methods[] = {
    {"ready", method_ready},
    {"clock", method_clock},
    {"advance", method_advance},
    {"wait", method_wait},
    {"subscribe", handle_subscribe},
    {"unsubscribe", handle_unsubscribe},
    {"trace.start", method_trace_start},
    {"trace.stop", method_trace_stop},
    {"record.start", method_record_start},
    {"record.stop", method_record_stop},
};

json_t *handle_call(struct handle *handle, const char *method, const json_t *params, struct refusal *refusal)
{
    struct sim *sim = &handle->sim;
    *refusal = (struct refusal){REFUSED_MEMORY, "out of memory"};
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        if (strcmp(methods[i].name, method) == 0)
            return methods[i].function(handle, params, refusal);
    if (exchange_is_named(sim, method))
        return do_exchange(handle, params, refusal);
    uint64_t tick = sim_now(sim);
    json_t *result = sim_command(sim, method, params, refusal);
    if (result && !json_object_get(result, "t_us"))
        json_object_set_new(result, "t_us", json_integer((json_int_t)tick));
    if (result && strcmp(method, "state") == 0)
        json_object_set_new(result, "clock", json_string("stepped"));
    if (result && strcmp(method, "units") == 0)
        json_object_set_new(result, "lines", json_integer(1));
    return result;
}

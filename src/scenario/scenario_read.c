/* SPDX-License-Identifier: MIT */
/* Scenarios from texts. */
#include <stdlib.h>
#include <string.h>

#include "record/record.h"
#include "scenario_model.h"
#include "text/text.h"

#define TIMEOUT 60000000u /* ticks */
#define STEPS_MAX 10000u  /* and stimuli, and conditions of `always` */
#define KEYS_MAX 64u  /* of a scenario, with those of a device */
#define KEY_SIZE 40u

/* Keys of every scenario. Those of the device's options come to them. */
static const char *const known[] = {
    "name", "description", "device", "units", "baud", "turnaround", "seed", "plant", "di", "timeout", "allow_faults", "always",
    "stimuli", "steps", NULL,
};

/* ---- Values --------------------------------------------------------------------------------------------------------- */

static const char *text_of(const struct config_node *map, const char *key, bool *ok)
{
    const struct config_node *node = config_get(map, key);
    if (node == NULL)
        return NULL;
    if (config_type(node) == CONFIG_TEXT)
        return config_text(node);
    *ok = config_error(node, "expected %s, a text", key);
    return NULL;
}

static bool read_time_up_to(const struct config_node *map, const char *key, uint64_t most, uint64_t *ticks)
{
    const struct config_node *node = config_get(map, key);
    if (node == NULL)
        return true;
    if (!config_time(node, key, ticks))
        return false;
    return *ticks <= most ||
           config_error(node, "expected %s of at most %llu us", key, (unsigned long long)most);
}

/* The value of a key that is an option of the device. */
static bool read_option(struct scenario_reader *reader, const struct device_option *option, const char *key,
                        const struct config_node *node)
{
    struct scenario *scenario = reader->scenario;
    struct device_config *config = &scenario->config.unit;
    char error[DEVICE_ERROR_SIZE];
    if (option->read_node)
        return option->read_node(config, key, node);
    if (config_type(node) != CONFIG_TEXT)
        return config_error(node, "expected %s, a text", key);
    if (!option->read_file)
        return option->read(config, config_text(node), error) || config_error(node, "%s: %s", key, error);
    if (scenario->files == SCENARIO_FILES_MAX)
        return config_error(node, "expected at most %u files as options", SCENARIO_FILES_MAX);
    size_t length;
    char *path = NULL, *text = scenario_file(reader, node, &path, &length);
    scenario->file[scenario->files++] = text;
    bool is_right = text != NULL && (!memchr(text, '\0', length) ||
                                     config_error(node, "cannot read %s: expected text without the character 0", path));
    is_right = is_right && (length <= device_option_file_max(option) ||
                            config_error(node, "cannot read %s: it is longer than %zu MiB", path,
                                         device_option_file_max(option) >> 20));
    is_right = is_right && option->read_file(config, path, text, length, reader->errors);
    free(path);
    return is_right;
}

/* Is a key one of the bus? `baud` of a device with several rates is read as that. */
static bool is_known(const char *key)
{
    size_t at = 0;
    while (known[at] && strcmp(known[at], key) != 0)
        at++;
    return known[at] != NULL;
}

/* All keys of the scenario, which have to be known; the options of the device are read. */
static bool read_options(struct scenario_reader *reader, const struct config_node *root)
{
    const struct device_kind *kind = reader->scenario->config.device;
    char own[KEYS_MAX][KEY_SIZE];
    const char *keys[KEYS_MAX + 1u];
    size_t count = 0, options = 0;
    bool is_right = true;
    for (; known[count] != NULL; count++)
        keys[count] = known[count];
    for (const struct device_option *option = kind->options; option && option->name && count < KEYS_MAX; option++) {
        snprintf(own[options], KEY_SIZE, "%s", option->name);
        for (char *at = own[options]; *at != '\0'; at++)
            *at = *at == '-' ? '_' : *at;
        keys[count++] = own[options++];
    }
    if (kind->flash_name && count < KEYS_MAX)
        keys[count++] = kind->flash_name;
    keys[count] = NULL;
    if (!config_keys(root, keys))
        return false;
    for (size_t i = 0; i < options; i++) {
        const struct config_node *node = is_known(own[i]) ? NULL : config_get(root, own[i]);
        const struct device_option *option = device_option_keyed(kind, own[i]);
        is_right = (node == NULL || read_option(reader, option, own[i], node)) && is_right;
    }
    return is_right;
}

/* The kind of all units. */
static bool read_device(struct scenario_reader *reader, const struct config_node *root)
{
    struct scenario *scenario = reader->scenario;
    bool is_right = true;
    char names[DEVICE_ERROR_SIZE];
    const char *name = text_of(root, "device", &is_right);
    const struct device_kind *assumed = reader->files->device ? reader->files->device : device_kind_at(0);
    scenario->config.device = name ? device_kind_named(name) : assumed;
    if (reader->files->config && scenario->config.device == assumed)
        scenario->config.unit = *reader->files->config;
    if (scenario->config.device)
        return is_right;
    return config_error(config_get(root, "device"), "expected a device, one that `rkm04 devices' lists, found \"%.40s\"%s", name,
                        nearest_hint(name, device_kind_names(names)));
}

/* The rate of the unit; of one that has several it is chosen. */
static bool read_rate(struct sim_config *config, const struct config_node *node, const char *text)
{
    const struct device_option *option = device_option_named(config->device, "baud");
    char rate[16], error[DEVICE_ERROR_SIZE];
    if (option)
        return option->read(&config->unit, text, error) || config_error(node, "%s", error);
    snprintf(rate, sizeof rate, "%u", device_baud(config->device, &config->unit));
    return strcmp(text, rate) == 0 || config_error(node, "expected baud, %s or 0, found \"%.20s\"", rate, text);
}

/* Keys of a bus, of a device that has one. */
static bool check_bus(const struct device_kind *device, const struct config_node *root)
{
    static const char *const keys[] = {"units", "baud", "turnaround"};
    for (size_t i = 0; !device->receive && i < sizeof keys / sizeof keys[0]; i++)
        if (config_get(root, keys[i]) != NULL)
            return config_error(config_get(root, keys[i]), "the device %s has no bus: expected no %s", device->name, keys[i]);
    return true;
}

static bool read_line(struct scenario *scenario, const struct config_node *root)
{
    bool ok = check_bus(scenario->config.device, root);
    struct sim_config *config = &scenario->config;
    uint64_t turnaround = device_turnaround(config->device);
    char expected[DEVICE_ERROR_SIZE];
    const char *units = text_of(root, "units", &ok);
    const char *baud = text_of(root, "baud", &ok);
    if (!node_list_read_up_to(&config->nodes, units != NULL ? units : "1", config->device->addresses))
        ok = config_error(config_get(root, "units"), "%s", device_addresses(config->device, expected));
    config->timed = baud == NULL || strcmp(baud, "0") != 0;
    ok = (baud == NULL || strcmp(baud, "0") == 0 || read_rate(config, config_get(root, "baud"), baud)) && ok;
    ok = read_time_up_to(root, "turnaround", SEGMENT_TURNAROUND_MAX, &turnaround) && ok;
    config->turnaround = (uint32_t)turnaround;
    return ok;
}

static bool read_rest(struct scenario *scenario, const struct config_node *root)
{
    bool ok = true;
    int64_t seed = 1;
    const struct config_node *node = config_get(root, "seed");
    scenario->name = text_of(root, "name", &ok);
    text_of(root, "description", &ok);
    if (node != NULL)
        ok = config_integer(node, "seed", 0, INT64_MAX, &seed) && ok;
    scenario->config.seed = (uint64_t)seed;
    scenario->timeout = TIMEOUT;
    ok = read_time_up_to(root, "timeout", TIME_VALUE_MAX, &scenario->timeout) && ok;
    node = config_get(root, "allow_faults");
    return (node == NULL || config_flag(node, "allow_faults", &scenario->allow_faults)) && ok;
}

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

/* `name` as seen from the folder of the scenario. */
static char *path_beside(const char *scenario, const char *name)
{
    const char *slash = strrchr(scenario, '/');
    size_t folder = slash != NULL && name[0] != '/' ? (size_t)(slash - scenario) + 1 : 0;
    char *path = malloc(folder + strlen(name) + 1);
    if (path == NULL)
        return NULL;
    memcpy(path, scenario, folder);
    strcpy(path + folder, name);
    return path;
}

char *scenario_file(struct scenario_reader *reader, const struct config_node *node, char **path, size_t *length)
{
    const char *why = "files cannot be used here";
    if (config_type(node) != CONFIG_TEXT || config_text(node)[0] == '\0') {
        config_error(node, "expected the name of a file");
        return NULL;
    }
    *path = path_beside(reader->name, config_text(node));
    if (*path == NULL || reader->files->read == NULL) {
        config_error(node, "cannot read %s: %s", config_text(node), *path == NULL ? "out of memory" : why);
        return NULL;
    }
    char *text = reader->files->read(reader->files->context, *path, length, &why);
    if (text == NULL)
        config_error(node, "cannot read %s: %s", *path, why);
    return text;
}

static bool read_plant(struct scenario_reader *reader, const struct config_node *root)
{
    struct scenario *scenario = reader->scenario;
    const struct config_node *node = config_get(root, "plant");
    if (node == NULL)
        return true;
    if (config_type(node) != CONFIG_MAP) {
        scenario->plant = scenario_file(reader, node, &scenario->plant_name, &scenario->plant_length);
        return scenario->plant != NULL;
    }
    json_t *json = config_json(node); /* which is YAML, too */
    scenario->plant = json != NULL ? json_dumps(json, 0) : NULL;
    json_decref(json);
    if (scenario->plant == NULL)
        return config_error(node, "out of memory");
    scenario->plant_length = strlen(scenario->plant);
    return true;
}

/* What is in the flash at first, by the name that it has: an image, which the run does not write. */
static bool read_flash(struct scenario_reader *reader, const struct config_node *root)
{
    struct scenario *scenario = reader->scenario;
    const struct device_kind *kind = scenario->config.device;
    const struct config_node *node = kind->flash_name ? config_get(root, kind->flash_name) : NULL;
    const size_t wanted = (size_t)kind->flash_blocks * kind->flash_block_size;
    size_t length;
    char *path = NULL;
    if (node == NULL)
        return true;
    scenario->flash = scenario_file(reader, node, &path, &length);
    const bool is_right = scenario->flash != NULL &&
                          (length == wanted || config_error(node, "%s has %zu bytes and is no %s file: expected %zu bytes", path,
                                                            length, kind->flash_name, wanted));
    free(path);
    scenario->config.flash_image = (const uint8_t *)scenario->flash;
    return is_right;
}

/* ---- Lists ---------------------------------------------------------------------------------------------------------- */

/* How many there are; -1: it is no list of one or more, reported. */
static int list_length(const struct config_node *map, const char *key)
{
    const struct config_node *node = config_get(map, key);
    if (node == NULL)
        return 0;
    if (config_type(node) == CONFIG_LIST && config_count(node) > 0 && config_count(node) <= STEPS_MAX)
        return (int)config_count(node);
    config_error(node, "expected %s, a list of 1 to %u", key, STEPS_MAX);
    return -1;
}

static bool read_always(struct scenario_reader *reader, const struct config_node *root)
{
    bool ok = true;
    int count = list_length(root, "always");
    struct scenario *scenario = reader->scenario;
    scenario->always_node = config_get(root, "always");
    scenario->always = json_array();
    for (int i = 0; i < count; i++) {
        json_t *json = scenario_condition(reader, config_at(scenario->always_node, (size_t)i), 0, false);
        if (json == NULL || json_array_append_new(scenario->always, json) != 0)
            ok = false;
    }
    return ok && count >= 0;
}

/* Steps before stimuli: a stimulus may clear a fault that a step injects. */
static bool read_lists(struct scenario_reader *reader, const struct config_node *root)
{
    struct scenario *scenario = reader->scenario;
    bool ok = read_always(reader, root);
    int steps = list_length(root, "steps"), stimuli = list_length(root, "stimuli");
    if (config_get(root, "steps") == NULL)
        return config_error(root, "expected steps, a list of what is to be done");
    if (steps < 0 || stimuli < 0)
        return false;
    scenario->step = calloc((size_t)steps, sizeof scenario->step[0]);
    scenario->stimulus = calloc((size_t)stimuli + 1, sizeof scenario->stimulus[0]);
    if (scenario->step == NULL || scenario->stimulus == NULL)
        return config_error(root, "out of memory");
    for (size_t i = 0; i < (size_t)steps; i++) {
        ok = scenario_step_read(reader, config_at(config_get(root, "steps"), i), &scenario->step[i]) && ok;
        scenario->steps = i + 1;
    }
    for (size_t i = 0; i < (size_t)stimuli; i++) {
        ok = scenario_stimulus_read(reader, config_at(config_get(root, "stimuli"), i), &scenario->stimulus[i]) && ok;
        scenario->stimuli = i + 1;
    }
    return ok;
}

/* ---- The line ------------------------------------------------------------------------------------------------------- */

bool scenario_power_up(const struct scenario *scenario, struct sim *sim, FILE *errors)
{
    if (!sim_begin(sim, &scenario->config) || !snapshots_attach(sim))
        return false;
    return scenario->plant == NULL ||
           sim_configure_plants(sim, scenario->plant_name != NULL ? scenario->plant_name : "plant", scenario->plant,
                                scenario->plant_length, errors);
}

bool scenario_begin_inputs(const struct scenario *scenario, struct sim *sim, struct refusal *refusal)
{
    for (unsigned number = 1; scenario->di != NULL && number <= sim_units(sim); number++) {
        json_t *params = json_pack("{s:s, s:O}", "unit", sim->unit[number - 1].name, "di", scenario->di);
        json_t *result = params != NULL ? sim_command(sim, "di.set", params, refusal) : NULL;
        json_decref(params);
        json_decref(result);
        if (result == NULL)
            return false;
    }
    return true;
}

/* A plant in the middle of the scenario has no lines of its own: its first error is reported at its node. */
static bool try_power_up(struct scenario_reader *reader, const struct config_node *root, FILE *errors)
{
    char *said = NULL;
    size_t length;
    bool inside = reader->scenario->plant != NULL && reader->scenario->plant_name == NULL;
    FILE *out = inside ? open_memstream(&said, &length) : errors;
    bool ok = out != NULL && scenario_power_up(reader->scenario, reader->sim, out);
    if (!inside)
        return ok;
    if (out != NULL)
        fclose(out);
    if (!ok && said != NULL) {
        const char *error = strstr(said, "error: ");
        said[strcspn(said, "\n")] = '\0';
        config_error(config_get(root, "plant"), "%s", error != NULL ? error + strlen("error: ") : "out of memory");
    }
    free(said);
    return ok;
}

static bool read_inputs(struct scenario_reader *reader, const struct config_node *root)
{
    struct refusal refusal = {0};
    const struct config_node *node = config_get(root, "di");
    if (node == NULL)
        return true;
    reader->scenario->di = config_json(node);
    return scenario_begin_inputs(reader->scenario, reader->sim, &refusal) || config_error(node, "%s", refusal.text);
}

/* ---- The whole ------------------------------------------------------------------------------------------------------ */

static bool read_all(struct scenario_reader *reader, const struct config_node *root, FILE *errors)
{
    if (config_type(root) != CONFIG_MAP)
        return config_error(root, "expected a map with steps");
    if (!read_device(reader, root))
        return false;
    bool ok = read_options(reader, root);
    ok = read_line(reader->scenario, root) && ok;
    ok = read_rest(reader->scenario, root) && ok;
    ok = read_plant(reader, root) && read_flash(reader, root) && ok;
    if (!ok) /* without a line nothing can be tried out */
        return false;
    reader->sim = calloc(1, sizeof *reader->sim);
    if (reader->sim == NULL)
        return config_error(root, "out of memory");
    ok = try_power_up(reader, root, errors) && read_inputs(reader, root) && read_lists(reader, root);
    sim_end(reader->sim);
    free(reader->sim);
    return ok;
}

struct scenario *scenario_read(const char *name, const char *text, size_t length, const struct scenario_files *files,
                               FILE *errors)
{
    struct scenario *scenario = calloc(1, sizeof *scenario);
    struct scenario_reader reader = {.name = name, .scenario = scenario, .files = files, .errors = errors};
    if (scenario == NULL) {
        fprintf(errors, "%s: error: out of memory\n", name);
        return NULL;
    }
    scenario->tree = config_read(name, text, length, errors);
    if (scenario->tree != NULL && read_all(&reader, config_root(scenario->tree), errors))
        return scenario;
    scenario_free(scenario);
    return NULL;
}

void scenario_free(struct scenario *scenario)
{
    if (scenario == NULL)
        return;
    for (size_t i = 0; i < scenario->steps; i++)
        scenario_step_free(&scenario->step[i]);
    for (size_t i = 0; i < scenario->stimuli; i++) {
        scenario_step_free(&scenario->stimulus[i].step);
        json_decref(scenario->stimulus[i].when);
    }
    free(scenario->step);
    free(scenario->stimulus);
    json_decref(scenario->always);
    json_decref(scenario->di);
    free(scenario->plant);
    free(scenario->plant_name);
    free(scenario->flash);
    for (unsigned i = 0; i < scenario->files; i++)
        free(scenario->file[i]);
    config_free(scenario->tree);
    free(scenario);
}

void scenario_set_readings(struct scenario *scenario, const struct device_config *readings)
{
    if (scenario->config.device->readings)
        scenario->config.device->readings->take_others(&scenario->config.unit, readings);
}

const struct device_kind *scenario_device(const struct scenario *scenario)
{
    return scenario->config.device;
}

const struct device_config *scenario_config(const struct scenario *scenario)
{
    return &scenario->config.unit;
}

const char *scenario_name(const struct scenario *scenario)
{
    return scenario->name;
}

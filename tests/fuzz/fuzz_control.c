/* SPDX-License-Identifier: MIT */
/* fuzz_control.c: any lines as requests of the control socket to a line of units: each is refused with a code and a reason, or
 * executed with a result, and the answer is JSON on one line. A line "+N" lets N ms pass, "<HEX" are bytes of the host. Files
 * are left alone. First byte: how many units, and of which kind; CNC872s have a PLC program and an NC program. */
#include <string.h>

#include "condition/condition.h"
#include "control/control_rpc.h"
#include "fuzz.h"
#include "record/snapshot.h"

#define REQUESTS_MAX 40
#define TIME_MAX 2000000u /* ticks */
#define MODE_CNC 0x80u    /* bit of the first byte */

static struct sim sim;
static uint64_t left;

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    (void)context, (void)bytes, (void)length;
}

static void check_answer(char *text)
{
    json_error_t error;
    FUZZ_CHECK(text != NULL, "no memory");
    size_t length = strlen(text);
    FUZZ_CHECK(length > 0 && strchr(text, '\n') == text + length - 1, "%s", text);
    json_t *json = json_loadb(text, length, JSON_ALLOW_NUL, &error);
    FUZZ_CHECK(json_is_object(json), "%s: %s", error.text, text);
    json_decref(json);
    free(text);
}

/* Wait for a condition, up to 100 ms. */
static json_t *wait_for(const json_t *params, struct refusal *refusal)
{
    uint64_t ticks = left < 100000 ? left : 100000;
    const json_t *until = json_object_get(params, "until");
    struct condition *condition = until ? condition_read(&sim, until, refusal) : NULL;
    if (!until)
        refuse(refusal, REFUSED_PARAMS, "until: missing");
    if (!condition)
        return NULL;
    condition_arm(condition);
    left -= ticks;
    bool held = condition_run(condition, sim_now(&sim) + ticks);
    FUZZ_CHECK(held == condition_holds(condition), "a condition that holds does not");
    char *text = condition_text(condition);
    json_t *result = json_pack("{s:b, s:s}", "held", held, "text", text);
    FUZZ_CHECK(result, "no text");
    free(text);
    condition_free(condition);
    return result;
}

/* As the control socket does it, but for what needs files or a clock. */
static void obey(const char *line, size_t length)
{
    struct rpc_request request = {0};
    struct refusal refusal = {0};
    json_t *result = NULL;
    if (rpc_read(&request, line, length, 1, &refusal)) {
        json_object_del(request.params, "file");
        result = strcmp(request.method, "wait") == 0 ? wait_for(request.params, &refusal)
                                                     : sim_command(&sim, request.method, request.params, &refusal);
    }
    FUZZ_CHECK(result || (refusal.code != 0 && refusal.text[0]), "refused without a reason");
    if (request.id)
        check_answer(result ? rpc_result(request.id, json_incref(result)) : rpc_error(request.id, &refusal));
    json_decref(result);
    rpc_end(&request);
}

static unsigned digit_of(uint8_t character)
{
    return (character & 15u) + (character > '9' ? 9u : 0);
}

static void take(const uint8_t *hex, size_t length)
{
    uint8_t bytes[256];
    size_t n = 0;
    for (; n < sizeof bytes && 2 * n + 1 < length; n++)
        bytes[n] = (uint8_t)(digit_of(hex[2 * n]) << 4 | (digit_of(hex[2 * n + 1]) & 15u));
    if (n <= sim_room(&sim))
        sim_queue_bytes(&sim, bytes, n, sim_now(&sim));
}

static void pass(const uint8_t *text, size_t length)
{
    uint64_t ticks = 0;
    for (size_t i = 0; i < length && ticks < TIME_MAX; i++)
        ticks = ticks * 10 + (text[i] & 15u) * 1000u;
    if (ticks > left)
        ticks = left;
    left -= ticks;
    sim_advance(&sim, sim_now(&sim) + ticks);
}

static void set_cnc(struct sim_config *config)
{
    static const char plc[] = "DATA\nPASSES DW 0\nGO BIT 1\nDATA_END\nMODULE_MAIN\n LOD PASSES\n AD CNST.1\n STO PASSES\n"
                              " LDR BLK[1].M3\n WR GO\nMODULE_MAIN_END\n";
    static const char *const texts[][2] = {{"plc", plc}, {"nc", "G1 X10 F1000\nM3 S500\nG0 X0 Y-1\nG4 P0.1\n"}};
    char error[DEVICE_ERROR_SIZE];
    config->device = device_kind_named("cnc872");
    memset(&config->unit.own, 0, sizeof config->unit.own);
    for (unsigned i = 0; i < 2; i++) {
        json_t *text = json_string(texts[i][1]);
        FUZZ_CHECK(text && config->device->read_setting(&config->unit, texts[i][0], text, error), "%s", error);
        json_decref(text);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const nodes[] = {"1", "3,3", "1,2,7", "16"};
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_hdlc}),
        .turnaround = SEGMENT_TURNAROUND, .seed = 1, .out = hear,
    };
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    config.timed = mode & 4;
    if (mode & MODE_CNC)
        set_cnc(&config);
    left = TIME_MAX;
    memset(&sim, 0, sizeof sim);
    FUZZ_CHECK(node_list_read(&config.nodes, nodes[mode & 3]) && sim_begin(&sim, &config) && snapshots_attach(&sim), "no memory");
    if (mode & 8)
        FUZZ_CHECK(snapshots_keep_journal(&sim), "no memory");
    for (unsigned i = 0; i < REQUESTS_MAX && fuzz.left > 0; i++) {
        size_t length;
        const uint8_t *line = fuzz_until(&fuzz, '\n', &length);
        if (length > 0 && line[0] == '+')
            pass(line + 1, length - 1);
        else if (length > 0 && line[0] == '<')
            take(line + 1, length - 1);
        else
            obey((const char *)line, length);
    }
    sim_advance(&sim, sim_now(&sim) + 50000);
    sim_end(&sim);
    return 0;
}

/* SPDX-License-Identifier: MIT */
/* fuzz_message.c: the message handler (section 3): messages bare, in frames, damaged, for others, broadcast, and any bytes on
 * the line, with time between them. An answer has the number of its request, comes whole out of its frame, and comes only to
 * whom it is due. First byte: 1 plain, 2 slow changes of speed, the rest n: each n-th operation of the flash fails. Then
 * actions: a byte that chooses, and what it needs. */
#include <string.h>

#include <rkm04/unit.h>

#include "fuzz.h"

#define NODE 3
#define MESSAGE_MAX 300

static struct rkm04_unit unit;
static uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
static uint8_t answer[12000], frame[4 * MESSAGE_MAX], line[64], heard[12000];
static struct rkm04_receiver host;
static unsigned operations, failing; /* of the flash; each failing-th fails, 0: none */

static bool fails(void)
{
    return failing > 0 && ++operations % failing == 0;
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS && offset + length <= RKM04_FLASH_BLOCK_SIZE, "%u %u %u", block, offset, length);
    memcpy(data, &flash[block][offset], length);
    return fails();
}

static int flash_erase(void *context, unsigned block)
{
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS, "%u", block);
    memset(flash[block], 0xff, sizeof flash[block]);
    return fails();
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    FUZZ_CHECK(block < RKM04_FLASH_BLOCKS && offset + length <= RKM04_FLASH_BLOCK_SIZE, "%u %u %u", block, offset, length);
    FUZZ_CHECK(offset % 8 == 0 && length % 8 == 0, "%u bytes at %u", length, offset);
    memcpy(&flash[block][offset], data, length);
    return fails();
}

static const struct rkm04_port port = {.flash_read = flash_read, .flash_erase = flash_erase, .flash_program = flash_program};

static bool is_motor(uint8_t motor)
{
    return motor >= '1' && motor <= '4';
}

/* The text of Get Tabul Run: " n;[(s;v),…]", steps never going back (P7). */
static void check_table(const uint8_t *text, size_t length)
{
    unsigned long points, seen = 0, step, last = 0;
    char copy[2000], *at;
    FUZZ_CHECK(length < sizeof copy && length > 4 && text[length - 1] == ']', "%zu bytes", length);
    memcpy(copy, text, length);
    copy[length] = '\0';
    points = strtoul(copy, &at, 10);
    FUZZ_CHECK(at[0] == ';' && at[1] == '[', "%s", copy);
    for (at += 2; *at == '('; seen++) {
        step = strtoul(at + 1, &at, 10);
        FUZZ_CHECK(*at == ';' && step >= last, "%s", copy);
        FUZZ_CHECK(strtoul(at + 1, &at, 10) <= RKM04_SPEED_MAX && *at == ')', "%s", copy);
        last = step;
        at += at[1] == ',' ? 2 : 1;
    }
    FUZZ_CHECK(seen == points && *at == ']', "%s", copy);
}

/* The text of Get Command is read without an error (P8). */
static void check_program(const uint8_t *text, size_t length)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    rkm04_read_begin(&reader, text, length);
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND)
        ;
    FUZZ_CHECK(found == RKM04_READ_END, "%.*s", (int)length, (const char *)text);
}

static void check_answer(uint8_t number, uint8_t motor, const uint8_t *bytes, size_t length)
{
    FUZZ_CHECK(length >= 2 && length <= 9200, "%zu bytes to %u", length, number);
    if (number < 1 || number > 7) {
        FUZZ_CHECK(length == 4 && bytes[0] == 255 && bytes[1] == number, "%u %u", bytes[0], bytes[1]);
        return;
    }
    FUZZ_CHECK(bytes[0] == number, "%u to %u", bytes[0], number);
    if (number == 1)
        FUZZ_CHECK(length == 2u + bytes[1], "%zu bytes", length);
    else
        FUZZ_CHECK(bytes[1] == motor, "motor %u for %u", bytes[1], motor);
    if (number == 2)
        FUZZ_CHECK(length == 4 && bytes[2] <= 3 && (bytes[2] == 1 || bytes[2] == 2 || bytes[3] == 0), "flag %u", bytes[2]);
    if (number == 3)
        FUZZ_CHECK(length == 3 && (bytes[2] == 0 || failing > 0 || !is_motor(motor)), "err %u", bytes[2]);
    if (number == 5 && is_motor(motor))
        check_program(bytes + 2, length - 2);
    if (number == 6 && is_motor(motor))
        check_table(bytes + 2, length - 2);
}

/* A message without a frame. */
static void exchange(struct fuzz *fuzz)
{
    size_t length, answered;
    uint8_t size = fuzz_byte(fuzz);
    const uint8_t *message = fuzz_take(fuzz, size, &length);
    if (rkm04_sending(&unit))
        return;
    answered = rkm04_exchange(&unit, message, length, answer, sizeof answer);
    if (length == 0)
        FUZZ_CHECK(answered == 0, "%zu bytes to nothing", answered);
    else
        check_answer(message[0], length > 1 ? message[1] : '0', answer, answered);
}

/* What the unit sends has whole frames in it. The host knows no silence: the bytes may be fetched at any time. */
static void drain(size_t bytes)
{
    const struct rkm04_framing *framing = unit.config.framing;
    for (; bytes > 0; bytes--) {
        size_t n = rkm04_send(&unit, line, 1);
        if (n == 0) {
            FUZZ_CHECK(!rkm04_sending(&unit), "something to send, but no byte");
            return;
        }
        if (framing->receive(&host, line[0], 0, heard, sizeof heard))
            FUZZ_CHECK(heard[0] == 255 || (heard[0] >= 1 && heard[0] <= 7), "answer %u", heard[0]);
        FUZZ_CHECK(host.bad_check + host.malformed + host.too_long == 0, "a damaged answer");
    }
}

/* A message in a frame; `to` says for whom, `damage` whether a bit is wrong. The unit may still be sending. */
static void send_frame(struct fuzz *fuzz)
{
    const struct rkm04_framing *framing = unit.config.framing;
    struct rkm04_sender sender = {0};
    struct rkm04_counters before = rkm04_counters(&unit), after;
    uint8_t kind = fuzz_byte(fuzz), to = kind & 1 ? NODE : kind & 2 ? 0 : kind >> 4, damage = kind & 4 ? fuzz_byte(fuzz) : 0;
    size_t length, n, taken;
    uint8_t size = fuzz_byte(fuzz);
    const uint8_t *message = fuzz_take(fuzz, size, &length);
    n = framing->begin(&sender, to, kind & 8 ? kind >> 4 : 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        n += framing->put(&sender, message[i], frame + n);
    n += framing->end(&sender, frame + n);
    if (damage > 0)
        frame[damage % n] ^= (uint8_t)(1u << (damage & 7));
    bool busy = rkm04_sending(&unit);
    taken = rkm04_receive(&unit, frame, n);
    FUZZ_CHECK(taken <= n && (taken == n || busy || unit.waiting), "%zu of %zu taken", taken, n);
    after = rkm04_counters(&unit);
    FUZZ_CHECK(after.requests >= before.requests && after.others >= before.others, "counters go back");
}

static void act(struct fuzz *fuzz)
{
    uint8_t choice = fuzz_byte(fuzz), size;
    const uint8_t *bytes;
    size_t length;
    switch (choice % 8) {
    case 0:
    case 1:
        exchange(fuzz);
        break;
    case 2:
    case 3:
        send_frame(fuzz);
        break;
    case 4:
        size = fuzz_byte(fuzz);
        bytes = fuzz_take(fuzz, size, &length);
        FUZZ_CHECK(rkm04_receive(&unit, bytes, length) <= length, "more taken than given");
        break;
    case 5:
        drain(choice & 8 ? 20000 : choice >> 4);
        break;
    case 6:
        rkm04_set_inputs(&unit, fuzz_byte(fuzz));
        break;
    default:
        rkm04_advance(&unit, choice & 8 ? fuzz_number(fuzz, 3) : (uint64_t)(choice >> 4) * 1000u);
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    struct rkm04_config config = {.node = NODE, .framing = mode & 1 ? &rkm04_plain : &rkm04_hdlc,
                                  .readings.speed_change = mode & 2 ? 700 : 0};
    failing = mode >> 2;
    operations = 0;
    memset(flash, 0xff, sizeof flash);
    memset(&host, 0, sizeof host);
    rkm04_init(&unit, &config, &port, NULL);
    for (unsigned i = 0; i < 200 && fuzz.left > 0; i++)
        act(&fuzz);
    drain(40000);
    drain(40000); /* of a request that waited */
    FUZZ_CHECK(!rkm04_sending(&unit) && !unit.waiting, "still sending");
    return 0;
}

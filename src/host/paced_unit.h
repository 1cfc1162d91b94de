/* paced_unit.h: a unit at the end of a line of 19200 baud, in virtual time. Pure: no file, no clock.
 *
 * A byte takes 10 bits, 3125/6 us, in either direction. One from the host sets out when it is handed over or when the byte
 * before it has arrived, and the unit gets it at the tick at which its stop bit ends (K4); a byte of an answer reaches the
 * host likewise. What has arrived while the unit cannot take it (P10) waits here, and no time is lost by that. */
#ifndef RKM04_HOST_PACED_UNIT_H
#define RKM04_HOST_PACED_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/unit.h>

#define PACED_UNIT_ROOM 4096u /* bytes from the host that may be under way */

/* Gets the bytes of answers, each at the tick at which it reaches the host. */
typedef void paced_unit_out(void *context, const uint8_t *bytes, size_t length);

struct paced_unit {
    struct rkm04_unit unit;
    bool paced;        /* false: bytes take no time */
    paced_unit_out *out;
    void *context;
    uint64_t in_free, out_free; /* sixths of a tick: when the byte before has passed */
    uint64_t out_due;  /* tick at which the next byte of an answer has passed; RKM04_NEVER: none is going out */
    bool refused;      /* the unit takes no more until it has sent (P10) */
    bool in_frame;     /* the bytes taken so far do not end with a whole frame */
    uint32_t frames;   /* seen by the unit */
    size_t head, count; /* of the queue */
    struct {
        uint64_t due;
        uint8_t byte;
    } queue[PACED_UNIT_ROOM];
};

/* Power-up at tick 0. config, port, context: as for rkm04_init(). */
void paced_unit_begin(struct paced_unit *paced, const struct rkm04_config *config, const struct rkm04_port *port, void *context);

/* Bytes that the queue still takes. */
size_t paced_unit_room(const struct paced_unit *paced);

/* The host hands over `length` <= paced_unit_room() bytes at `tick` >= rkm04_now(). */
void paced_unit_take(struct paced_unit *paced, const uint8_t *bytes, size_t length, uint64_t tick);

/* Do all ticks before `tick`, and move every byte that is due by `tick`. */
void paced_unit_advance(struct paced_unit *paced, uint64_t tick);

/* The earliest tick at which a byte is to be moved; RKM04_NEVER: none is under way. */
uint64_t paced_unit_due(const struct paced_unit *paced);

#endif

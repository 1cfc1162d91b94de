/* SPDX-License-Identifier: MIT */
/* modbus_framing.h: frames of Modbus RTU for the wire monitor and the host of a scenario. A message is function and data, without
 * address and check value. */
#ifndef RKM04_DEVICE_MODBUS_FRAMING_H
#define RKM04_DEVICE_MODBUS_FRAMING_H

#include "device.h"

/* For rkm04_framing: bytes of a frame; those of an answer have the address of its sender. */
size_t modbus_begin_frame(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out);
size_t modbus_put_byte(struct rkm04_sender *sender, uint8_t byte, uint8_t *out);
size_t modbus_end_frame(struct rkm04_sender *sender, uint8_t *out);

/* For device_framing.link and .end; the device says after which silence a frame is over. */
extern const struct rkm04_framing modbus_link;
bool modbus_end(struct rkm04_receiver *receiver, uint8_t *buffer, bool answer);

#endif

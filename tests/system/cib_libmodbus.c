/* SPDX-License-Identifier: MIT */
/* A Modbus master with libmodbus for cib.sh: cib_libmodbus PORT. */
#include <errno.h>
#include <modbus/modbus.h>
#include <stdio.h>
#include <stdlib.h>

#define LIMIT 30 /* s until an answer counts as never coming */

static void check(int right, const char *what)
{
    if (right)
        return;
    fprintf(stderr, "%s: %s\n", what, modbus_strerror(errno));
    exit(1);
}

int main(int argc, char **argv)
{
    const uint16_t command[] = {1, 102, 0, 3, 100};
    uint16_t word[8];
    uint8_t bit[8];
    if (argc != 2)
        return 2;
    modbus_t *bus = modbus_new_rtu(argv[1], 19200, 'N', 8, 1);
    check(bus != NULL && modbus_set_slave(bus, 1) == 0 && modbus_connect(bus) == 0, "connect");
    check(modbus_set_response_timeout(bus, LIMIT, 0) == 0 && modbus_set_byte_timeout(bus, LIMIT, 0) == 0, "time limits");
    check(modbus_read_input_registers(bus, 0x30, 2, word) == 2 && word[0] == 0x0808, "type");
    check(modbus_write_registers(bus, 0x10, 5, command) == 5, "command");
    check(modbus_read_input_registers(bus, 0x10, 2, word) == 2 && word[0] == 1, "ACK");
    check(modbus_write_bit(bus, 4, 1) == 1 && modbus_read_bits(bus, 0, 8, bit) == 8 && bit[4] == 1, "coil");
    check(modbus_read_input_bits(bus, 0, 8, bit) == 8, "inputs");
    check(modbus_read_registers(bus, 9, 1, word) == -1 && errno == EMBXILADD, "exception 02");
    check(modbus_write_register(bus, 1, 10001) == -1 && errno == EMBXILVAL, "exception 03");
    modbus_close(bus);
    modbus_free(bus);
    return 0;
}

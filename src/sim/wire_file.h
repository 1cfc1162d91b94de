/* wire_file.h: a file that takes down what passes on the wires: FILE.log for people, FILE.pcapng for Wireshark. The name chooses
 * the format. */
#ifndef RKM04_SIM_WIRE_FILE_H
#define RKM04_SIM_WIRE_FILE_H

#include "sim.h"

#define WIRE_FILE_EXPECTED "a name that ends with .log or .pcapng"

struct wire_file;

/* As in trace_file.h. */
bool wire_file_named(const char *path);
struct wire_file *wire_file_begin(struct sim *sim, const char *path, char **error);
int wire_file_failed(const struct wire_file *file);
int wire_file_end(struct wire_file *file);

#endif

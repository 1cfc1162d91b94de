#include "record.h"

struct record *record_begin(struct sim *sim, FILE *out) { (void)sim, (void)out; return NULL; }
int record_end(struct record *record) { (void)record; return 0; }
void record_flush(struct record *record) { (void)record; }

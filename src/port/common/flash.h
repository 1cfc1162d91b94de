/* SPDX-License-Identifier: MIT */
/* flash.h: for boards without flash that a program may write: memory that behaves like it. The blocks lie in the section .blocks,
 * which has to be where a reset leaves it alone. They keep the rules of the real thing: a core that broke them would be found
 * out here. */
#ifndef FLASH_H
#define FLASH_H

/* Once, at the start: erases the blocks if they hold nothing yet, as after switching on. */
void flash_start(void);

/* Callbacks of struct rkm04_port. Return 0; 1 outside the blocks, or if 8 bytes are programmed twice without an erase. */
int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length);
int flash_erase(void *context, unsigned block);
int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length);

#endif

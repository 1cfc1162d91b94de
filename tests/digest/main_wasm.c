/* SPDX-License-Identifier: MIT */
/* main_wasm.c: the digest in WebAssembly, without a C library; run_wasm.mjs runs it. */
#include "digest.h"

__attribute__((import_module("host"), import_name("say"))) void host_say(const char *line);

void digest_main(void);
void digest_main(void)
{
    digest_run(host_say);
}

/* ---- What the compiler calls for where there is no library of its own -------------------------------------------- */

/* 128 bits of a product. */
__int128 __multi3(__int128 a, __int128 b);
__int128 __multi3(__int128 a, __int128 b)
{
    const uint64_t half = UINT32_MAX;
    uint64_t a_low = (uint64_t)a, a_high = (uint64_t)(a >> 64), b_low = (uint64_t)b, b_high = (uint64_t)(b >> 64);
    uint64_t low = (a_low & half) * (b_low & half), one = (a_low >> 32) * (b_low & half) + (low >> 32);
    uint64_t other = (a_low & half) * (b_low >> 32) + (one & half);
    uint64_t high = (a_low >> 32) * (b_low >> 32) + (one >> 32) + (other >> 32) + a_low * b_high + a_high * b_low;
    return (__int128)((unsigned __int128)high << 64 | (other << 32 | (low & half)));
}

void *memcpy(void *restrict to, const void *restrict from, size_t length);
void *memcpy(void *restrict to, const void *restrict from, size_t length)
{
    for (size_t i = 0; i < length; i++)
        ((uint8_t *)to)[i] = ((const uint8_t *)from)[i];
    return to;
}

void *memset(void *to, int byte, size_t length);
void *memset(void *to, int byte, size_t length)
{
    for (size_t i = 0; i < length; i++)
        ((uint8_t *)to)[i] = (uint8_t)byte;
    return to;
}

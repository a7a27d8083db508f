/* SPDX-License-Identifier: BSD-3-Clause */
/* Which vector instructions the processor has and the operating system saves: cpuid, by intrinsics that gcc, clang and MSVC
 * share, so that what the tests run is what every compiler builds. Intel's Software Developer's Manual 2A, CPUID; 1, 13.3. */
#ifndef HAIRLUT_CPU_H
#define HAIRLUT_CPU_H

#include <stdint.h>

#include "platform.h"

typedef enum hairlut_cpu { HAIRLUT_CPU_PLAIN, HAIRLUT_CPU_AVX2, HAIRLUT_CPU_AVX512 } hairlut_cpu;

/* A build for one known processor defines HAIRLUT_CPU as one of these: then the processor is not queried. */

#ifdef HAIRLUT_X86
#ifdef _MSC_VER
#include <intrin.h>
#else
#include <cpuid.h>
#endif

typedef struct hairlut_cpuid {
    uint32_t a, b, c, d;
} hairlut_cpuid;

static inline hairlut_cpuid hairlut_read_cpuid(uint32_t leaf)
{
    hairlut_cpuid r = {0, 0, 0, 0};
#ifdef _MSC_VER
    int registers[4];
    __cpuidex(registers, (int)leaf, 0);
    r.a = (uint32_t)registers[0], r.b = (uint32_t)registers[1], r.c = (uint32_t)registers[2], r.d = (uint32_t)registers[3];
#else
    __cpuid_count(leaf, 0, r.a, r.b, r.c, r.d);
#endif
    return r;
}

/* XCR0: the registers that the operating system saves. Only where cpuid says OSXSAVE. */
static inline uint32_t hairlut_saved_registers(void)
{
#ifdef _MSC_VER
    return (uint32_t)_xgetbv(0);
#else
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
#endif
}

static inline int hairlut_has_bits(uint32_t word, uint32_t bits)
{
    return (word & bits) == bits;
}

/* The kernels need AVX2, BMI2 and POPCNT, the wider ones AVX512F, DQ, BW and VL besides. */
static inline hairlut_cpu hairlut_ask_cpu(void)
{
    enum { POPCNT = 1u << 23, OSXSAVE = 1u << 27, AVX = 1u << 28 }; /* leaf 1, ecx */
    enum { AVX2 = 1u << 5, BMI2 = 1u << 8 };                        /* leaf 7, ebx */
    const uint32_t avx512 = 1u << 16 | 1u << 17 | 1u << 30 | 1u << 31;
    const uint32_t saves_ymm = 0x6, saves_zmm = 0xe6; /* with the masks, and the upper halves and sixteen */
    if (hairlut_read_cpuid(0).a < 7)
        return HAIRLUT_CPU_PLAIN;
    const uint32_t wide = hairlut_read_cpuid(7).b;
    if (!hairlut_has_bits(hairlut_read_cpuid(1).c, POPCNT | OSXSAVE | AVX) || !hairlut_has_bits(wide, AVX2 | BMI2) ||
        !hairlut_has_bits(hairlut_saved_registers(), saves_ymm))
        return HAIRLUT_CPU_PLAIN;
    return hairlut_has_bits(wide, avx512) && hairlut_has_bits(hairlut_saved_registers(), saves_zmm) ? HAIRLUT_CPU_AVX512
                                                                                                    : HAIRLUT_CPU_AVX2;
}

/* What hairlut_ask_cpu answered, kept: cpuid takes hundreds of cycles, in a virtual machine thousands. Whichever thread comes first,
 * each writes the same number in one store. */
static inline hairlut_cpu hairlut_this_cpu(void)
{
    enum { UNKNOWN = -1 };
#if defined(HAIRLUT_CPU)
    return HAIRLUT_CPU;
#elif defined(_MSC_VER)
    static volatile long known = UNKNOWN; /* an aligned word: read and written whole */
    if (known == UNKNOWN)
        known = (long)hairlut_ask_cpu();
    return (hairlut_cpu)known;
#else
    static int known = UNKNOWN;
    int cpu = __atomic_load_n(&known, __ATOMIC_RELAXED);
    if (cpu == UNKNOWN)
        __atomic_store_n(&known, cpu = (int)hairlut_ask_cpu(), __ATOMIC_RELAXED);
    return (hairlut_cpu)cpu;
#endif
}
#endif

#endif

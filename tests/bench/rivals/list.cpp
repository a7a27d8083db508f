/* SPDX-License-Identifier: BSD-3-Clause
 * All rivals that were built and that this processor runs. */
#include "rivals.h"

extern "C" {
extern const rival rivals_one[], rivals_native[], rivals_arrays256[], rivals_arrays512[];
#ifdef HAVE_MKL
extern const rival rivals_mkl[];
#endif
extern const rival chiang_one[], chiang_native[], chiang_arrays256[], chiang_arrays512[];
}

/* Without AVX-512, arrays of that width are the narrower ones by another name. */
static bool has_avx512()
{
#if defined(__x86_64__) || defined(__i386__)
    return __builtin_cpu_supports("avx512f");
#else
    return false;
#endif
}

extern "C" const rival *rival_at(int index)
{
    const bool wide = has_avx512();
    const rival *lists[] = {rivals_one,
                            rivals_native,
                            rivals_arrays256,
                            wide ? rivals_arrays512 : nullptr,
#ifdef HAVE_MKL
                            rivals_mkl,
#endif
                            chiang_one,
                            chiang_native,
                            chiang_arrays256,
                            wide ? chiang_arrays512 : nullptr};
    for (const rival *list : lists)
        for (; list && list->name; ++list)
            if (index-- == 0)
                return list;
    return nullptr;
}

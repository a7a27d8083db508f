/* SPDX-License-Identifier: BSD-3-Clause
 * All rivals that were built and that this processor runs. */
#include "rivals.h"

extern "C" {
extern const rival rivals_one[], rivals_native[], chiang_one[], chiang_native[];
#if defined(__x86_64__) || defined(__i386__)
extern const rival rivals_arrays256[], rivals_arrays512[], chiang_arrays256[], chiang_arrays512[];
#else
extern const rival rivals_arrays128[], chiang_arrays128[];
#endif
#ifdef HAVE_MKL
extern const rival rivals_mkl[];
#endif
}

extern "C" const rival *rival_at(int index)
{
#if defined(__x86_64__) || defined(__i386__)
    /* without AVX-512, arrays of that width are the narrower ones by another name */
    const bool wide = __builtin_cpu_supports("avx512f");
    const rival *arrays[] = {rivals_arrays256, chiang_arrays256, wide ? rivals_arrays512 : nullptr,
                             wide ? chiang_arrays512 : nullptr};
#else
    const rival *arrays[] = {rivals_arrays128, chiang_arrays128};
#endif
    const rival *lists[] = {
        rivals_one, rivals_native, chiang_one, chiang_native,
#ifdef HAVE_MKL
        rivals_mkl,
#endif
    };
    for (const rival *list : arrays)
        for (; list && list->name; ++list)
            if (index-- == 0)
                return list;
    for (const rival *list : lists)
        for (; list->name; ++list)
            if (index-- == 0)
                return list;
    return nullptr;
}

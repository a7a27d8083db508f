/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernels for one instruction set, written once. A file that includes this has included a simd_*.h, whose operations
 * work on LANES floats (real), 32-bit integers (whole) or truth values (mask):
 *
 *   smaller(a, b) = a < b ? a : b and larger(a, b) = a > b ? a : b, so that NaN in a gives b
 *   truncated(a)    towards zero; any integer where a has none
 *   imul(a, b)      of integers in [0, 2^15)
 *   iproduct(a, b)  of any integers
 *   flipped(a, s)   a, negated where s's sign bit is set
 *   by_sign(a, n, p)  n where a's sign bit is set, else p
 *   every(m)        whether all lanes are true
 *   iwhere(m, a)    a in the lanes that are true, 0 in the others
 *   as_whole(a)     the integers of the same bits
 *   lanes_of(m)     the lanes that are true, bit l for lane l
 *   how_many(lanes) how many these are
 *   permuted(a, p)  a with its lanes in the order p: to_the_front(lanes) brings those to the front, without changing their order;
 *                   after from_the_front(lanes) lane l of them has what stood as far from the front as there are before it
 *   shifted(a)      the floats whose bits are those of a > 0 shifted right by two
 *   gather4(p, at, x)  lane l of x[k] = p[at[l] + k], at[l] a multiple of 4
 *   lookup(table, vectors, i)  lane l has table[i[l]]; the table has whole vectors
 *   gather_links(links, at, offset, h)  those of links[at[l]] in lane l
 *   HAIRLUT_COUNTS(groups, above, at, t, x, n, alike)  may be defined: lane l has the count of groups and above + at[l], t[l], x[l]
 *
 * Every formula repeats the scalar one operation by operation, without fused multiply-add: that makes the results equal bit
 * for bit. The work on a block is done in passes, each short enough that a processor has several vectors of it under way: a
 * single pass would wait for where to load from, then for the loads, then for quotients (tests/bench/NOTES.md). Outputs are
 * written when no input of the block is read any more: that is what allows outputs in place of inputs. */
#ifndef HAIRLUT_BATCH_KERNEL_H
#define HAIRLUT_BATCH_KERNEL_H

#include "batch_arrays.h"

#endif

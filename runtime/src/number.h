/* SPDX-License-Identifier: BSD-3-Clause */
/* Decimal numbers from text whatever the locale: strtod reads "0,5" where the program's user set a comma. */
#ifndef HAIRLUT_NUMBER_H
#define HAIRLUT_NUMBER_H

#include <stdint.h>

static inline int hairlut_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* value * 10^exponent, |exponent| <= 400. Powers up to 22 are exact doubles. */
static inline double hairlut_scale_decimal(double value, int exponent)
{
    for (; exponent >= 22; exponent -= 22)
        value *= 1e22;
    for (; exponent <= -22; exponent += 22)
        value /= 1e22;
    double power = 1.0;
    for (int k = 0; k < (exponent < 0 ? -exponent : exponent); ++k)
        power *= 10.0;
    return exponent < 0 ? value / power : value * power;
}

/* Reads a number as luts/FORMAT.md defines it at *text (ending at `end`): an optional sign, 1 to 100 digits with at most one
 * point among them, an optional exponent; at most 1e300 in size. To within 2 ulp of double; moves *text behind it. Returns 0,
 * without moving, where no such number stands. */
static inline int hairlut_read_number(const char **text, const char *end, double *number)
{
    const char *p = *text;
    const int negative = p < end && *p == '-';
    uint64_t mantissa = 0;
    int exponent = 0, digits = 0, point = 0;
    p += p < end && (*p == '-' || *p == '+');
    for (; p < end && (hairlut_is_digit(*p) || (*p == '.' && !point)); ++p) {
        if (*p == '.') {
            point = 1;
            continue;
        }
        ++digits;
        if (mantissa < UINT64_C(100000000000000000)) { /* 18 digits are kept, more than a double has */
            mantissa = 10 * mantissa + (uint64_t)(*p - '0');
            exponent -= point;
        } else {
            exponent += !point;
        }
    }
    if (digits == 0 || digits > 100)
        return 0;
    if (p < end && (*p == 'e' || *p == 'E')) {
        int power = 0, down = 0;
        ++p;
        down = p < end && *p == '-';
        p += p < end && (*p == '-' || *p == '+');
        if (p == end || !hairlut_is_digit(*p))
            return 0;
        for (; p < end && hairlut_is_digit(*p); ++p)
            power = power < 1000 ? 10 * power + (*p - '0') : power;
        exponent += down ? -power : power;
    }
    if (mantissa > 0 && exponent > 300)
        return 0;
    const double magnitude = mantissa == 0 || exponent < -400 ? 0.0 : hairlut_scale_decimal((double)mantissa, exponent);
    if (magnitude > 1e300)
        return 0;
    *number = negative ? -magnitude : magnitude;
    *text = p;
    return 1;
}

#endif

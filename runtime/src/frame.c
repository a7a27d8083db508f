/* World directions and (theta, phi) in a fibre frame. */
#include <math.h>

#include "angle.h"
#include "hairlut.h"

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void hairlut_angles(const hairlut_frame *frame, const float direction[3], float *theta, float *phi)
{
    const float t = dot(direction, frame->tangent);
    const float n = dot(direction, frame->normal);
    const float b = dot(direction, frame->binormal);
    const float across = sqrtf(n * n + b * b);
    const int known = hairlut_is_finite(t) && hairlut_is_finite(across);
    /* atan2 keeps its precision next to the pole, where asin loses half the digits */
    *theta = known ? atan2f(t, across) : 0.0f;
    *phi = known && across > 0.0f ? hairlut_wrap(atan2f(b, n), -hairlut_pi) : 0.0f;
}

void hairlut_direction(const hairlut_frame *frame, float theta, float phi, float direction[3])
{
    const float s = sinf(theta), c = cosf(theta);
    const float cn = c * cosf(phi), cb = c * sinf(phi);
    for (int k = 0; k < 3; ++k)
        direction[k] = s * frame->tangent[k] + cn * frame->normal[k] + cb * frame->binormal[k];
}

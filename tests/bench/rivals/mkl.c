/* The analytic sampler with MKL's vector mathematics, in its fastest mode, block by block so that all stays in cache. */
#include <mkl_vml.h>

#include "rivals.h"

enum { BLOCK = 512 };

void rival_mkl_vector(rival_table table, RIVAL_ARRAYS)
{
    const MKL_INT64 mode = VML_EP | VML_FTZDAZ_ON | VML_ERRMODE_IGNORE;
    float low[BLOCK], high[BLOCK], mean[BLOCK], width[BLOCK], z[BLOCK];
    for (size_t s = 0; s < n; s += BLOCK) {
        const int m = n - s < BLOCK ? (int)(n - s) : BLOCK;
        rival_lobe lobe = {0};
        for (int i = 0; i < m; ++i) {
            lobe = rival_lobe_at(table, theta_r[s + (size_t)i]);
            mean[i] = lobe.mean;
            width[i] = lobe.width;
            low[i] = (lobe.low - lobe.mean) / lobe.width;
            high[i] = (lobe.high - lobe.mean) / lobe.width;
        }
        vmsErf(m, low, low, mode);
        vmsErf(m, high, high, mode);
        for (int i = 0; i < m; ++i)
            z[i] = rival_inside(low[i] + u[s + (size_t)i] * (high[i] - low[i]));
        vmsErfInv(m, z, z, mode);
        for (int i = 0; i < m; ++i) {
            x[s + (size_t)i] = rival_angle(z[i], mean[i], width[i], lobe.low, lobe.high);
            pdf[s + (size_t)i] = rival_density(z[i], width[i], high[i] - low[i]);
        }
    }
}

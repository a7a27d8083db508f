/* The analytic sampler with Boost.Math's inverse of erf in single precision. */
#include <boost/math/special_functions/erf.hpp>

#include "rivals.h"

using policy = boost::math::policies::policy<boost::math::policies::promote_float<false>>;

extern "C" void rival_boost_scalar(rival_table table, RIVAL_ARRAYS)
{
    for (size_t i = 0; i < n; ++i) {
        const rival_lobe lobe = rival_lobe_at(table, theta_r[i]);
        const float start = erff((lobe.low - lobe.mean) / lobe.width);
        const float span = erff((lobe.high - lobe.mean) / lobe.width) - start;
        const float z = boost::math::erf_inv(rival_inside(start + u[i] * span), policy());
        x[i] = rival_angle(z, lobe.mean, lobe.width, lobe.low, lobe.high);
        pdf[i] = rival_density(z, lobe.width, span);
    }
}

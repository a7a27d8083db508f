/* SPDX-License-Identifier: BSD-3-Clause
 * erf and its inverse from Boost.Math, in single precision. */
#ifndef RIVALS_BOOST_H
#define RIVALS_BOOST_H

#include <boost/math/special_functions/erf.hpp>

namespace {

struct Boost {
    using policy = boost::math::policies::policy<boost::math::policies::promote_float<false>>;
    static float erf(float x) { return boost::math::erf(x, policy()); }
    static float erf_inverse(float x) { return boost::math::erf_inv(x, policy()); }
};

} // namespace

#endif

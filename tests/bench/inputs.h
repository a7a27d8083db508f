// SPDX-License-Identifier: BSD-3-Clause
// Random inputs of a call over arrays, and room for its outputs. theta_r uniform over its range, phi_r and the random numbers
// uniform, the light's direction uniform on the sphere.
#pragma once

#include <cmath>
#include <new>
#include <random>
#include <vector>

#include "rivals/rivals.h"

namespace bench {

constexpr size_t count = 1 << 12; // 16 KiB an array: inputs and outputs of a call stay in the second-level cache

// Floats that begin where a cache line does, as an engine's arrays would
template <class T> struct Aligned {
    using value_type = T;
    Aligned() = default;
    template <class U> Aligned(const Aligned<U> &) {}
    T *allocate(size_t n) { return static_cast<T *>(::operator new(n * sizeof(T), std::align_val_t(64))); }
    void deallocate(T *p, size_t) { ::operator delete(p, std::align_val_t(64)); }
    bool operator==(const Aligned &) const { return true; }
    bool operator!=(const Aligned &) const { return false; }
};

using Floats = std::vector<float, Aligned<float>>;

class Inputs {
public:
    explicit Inputs(unsigned seed) : random_(seed)
    {
        const float pi = 3.1415926f;
        view_.n = count;
        view_.theta_r = uniform(-0.5f * pi, 0.5f * pi);
        view_.phi_r = uniform(-pi, pi);
        view_.offset = uniform(-1.0f, 1.0f);
        view_.u_lobe = uniform(0.0f, 1.0f);
        view_.u_theta = uniform(0.0f, 1.0f);
        view_.u_phi = uniform(0.0f, 1.0f);
        float *sine = uniform(-1.0f, 1.0f);
        for (size_t i = 0; i < count; ++i)
            sine[i] = std::asin(sine[i]);
        view_.theta_light = sine;
        view_.phi_light = uniform(-pi, pi);
        for (float **output : {&view_.theta_i, &view_.phi_i, &view_.pdf_angle, &view_.pdf_solid_angle, &view_.pdf_light})
            *output = uniform(0.0f, 1.0f);
    }
    Inputs(const Inputs &) = delete;

    const rival_arrays &view() const { return view_; }

private:
    // count numbers in [low, high), of 24 random bits each
    float *uniform(float low, float high)
    {
        Floats &made = kept_.emplace_back(count);
        for (float &x : made)
            x = low + (high - low) * (static_cast<float>(random_() >> 8) / 16777216.0f);
        return made.data();
    }

    std::mt19937 random_;
    std::vector<Floats> kept_;
    rival_arrays view_ = {};
};

} // namespace bench

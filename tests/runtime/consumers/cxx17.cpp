/* SPDX-License-Identifier: BSD-3-Clause */
// The header from C++17: linkage, and nothing that C++ refuses.
#include "hairlut.h"

#include <cmath>
#include <type_traits>

static_assert(std::is_trivially_copyable_v<hairlut_sample>);
static_assert(std::is_same_v<decltype(&hairlut_free), void (*)(hairlut_model *)>);

int main()
{
    const hairlut_model *hair = hairlut_builtin("printed");
    const auto s = hairlut_sample_multiple(hair, 0.3f, 1.0f, 0.25f, 0.75f);
    float u[2];
    hairlut_invert_lobe(hair, hairlut_lobe_index(hair, "multiple"), 0.3f, 1.0f, s.theta_i, s.phi_i, u);
    return std::abs(u[0] - 0.25f) < 1e-5f && std::abs(u[1] - 0.75f) < 1e-5f ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
// The functions of hairlut.h as calls over arrays, beside those of the rivals.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "hairlut.h"
#include "rivals/rivals.h"

extern "C" {
#include "batch.h"
}

namespace bench {

using Call = std::function<void(const rival_arrays &)>;
using Calls = std::vector<std::pair<std::string, Call>>;

// sample, density and vertex of the whole hair: a call of a function a sample, or over arrays by these kernels
Calls hair_calls(const hairlut_model &model);
Calls hair_calls(const hairlut_model &model, const hairlut_batch &kernels);

// sample_NAME and pdf_NAME of one lobe
Calls lobe_calls(const hairlut_model &model, const std::string &name);
Calls lobe_calls(const hairlut_model &model, const std::string &name, const hairlut_batch &kernels);

// sample_strand, pdf_strand and vertex_strand of a model over parameters: random ones in their ranges, the same for `run` samples
// in succession, as where a strand is hit several times. Runs longer than 1 stand in the names: vertex_strand_64.
Calls strand_calls(const hairlut_model &model, size_t run);
Calls strand_array_calls(const hairlut_model &model, size_t run);

// hit: a sample and the densities of four directions, as where four lights are sampled at one hit; hit_viewer and vertex_viewer: by
// a hairlut_viewer. Of a model over parameters, with other random ones for each sample: hit_strand and so on.
Calls hit_calls(const hairlut_model &model);

} // namespace bench

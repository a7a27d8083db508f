// SPDX-License-Identifier: BSD-3-Clause
#include "calls.h"

#include <memory>

#include "inputs.h"

namespace bench {
namespace {

void put(const rival_arrays &all, size_t i, hairlut_sample s)
{
    all.theta_i[i] = s.theta_i;
    all.phi_i[i] = s.phi_i;
    all.pdf_angle[i] = s.pdf_angle;
    all.pdf_solid_angle[i] = s.pdf_solid_angle;
}

hairlut_samples outputs(const rival_arrays &all)
{
    return {all.theta_i, all.phi_i, all.pdf_angle, all.pdf_solid_angle};
}

void sample_one(const hairlut_model &model, const rival_arrays &all, size_t i)
{
    put(all, i,
        hairlut_sample_hair(&model, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i], all.u_lobe[i], all.u_theta[i],
                            all.u_phi[i]));
}

void density_of_one(const hairlut_model &model, const rival_arrays &all, size_t i)
{
    all.pdf_light[i] =
        hairlut_pdf_hair(&model, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i], all.theta_light[i], all.phi_light[i]);
}

void sample_arrays(const hairlut_model &model, const hairlut_batch &kernels, const rival_arrays &all)
{
    kernels.sample_hair(&model, all.n, nullptr, all.theta_r, all.phi_r, all.offset, all.u_lobe, all.u_theta, all.u_phi,
                        outputs(all));
}

void density_of_arrays(const hairlut_model &model, const hairlut_batch &kernels, const rival_arrays &all)
{
    kernels.pdf_hair(&model, all.n, nullptr, all.theta_r, all.phi_r, all.offset, all.theta_light, all.phi_light,
                     all.pdf_light);
}

// Parameters of `count` samples, in the order of the one-direction calls and in that of arrays
struct Strands {
    size_t parameters;
    Floats by_sample, by_parameter;

    const float *of(size_t i) const { return &by_sample[i * parameters]; }
};

std::shared_ptr<const Strands> random_strands(const hairlut_model &model, size_t run)
{
    const auto made = std::make_shared<Strands>();
    made->parameters = static_cast<size_t>(hairlut_parameter_count(&model));
    made->by_sample.resize(count * made->parameters);
    made->by_parameter.resize(count * made->parameters);
    std::mt19937 random(3);
    for (size_t i = 0; i < count; ++i)
        for (size_t p = 0; p < made->parameters; ++p) {
            float &value = made->by_sample[i * made->parameters + p];
            float least, most;
            hairlut_parameter_range(&model, static_cast<int>(p), &least, &most, nullptr);
            value = i % run ? made->of(i - 1)[p] : std::uniform_real_distribution<float>(least, most)(random);
            made->by_parameter[p * count + i] = value;
        }
    return made;
}

void sample_strand(const hairlut_model &model, const float *strand, const rival_arrays &all, size_t i)
{
    put(all, i,
        hairlut_sample_strand(&model, strand, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i], all.u_lobe[i],
                              all.u_theta[i], all.u_phi[i]));
}

void density_of_strand(const hairlut_model &model, const float *strand, const rival_arrays &all, size_t i)
{
    all.pdf_light[i] = hairlut_pdf_strand(&model, strand, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i],
                                          all.theta_light[i], all.phi_light[i]);
}

void sample_strands(const hairlut_model &model, const Strands &strands, const rival_arrays &all)
{
    hairlut_sample_strand_n(&model, all.n, strands.by_parameter.data(), nullptr, all.theta_r, all.phi_r, all.offset,
                            all.u_lobe, all.u_theta, all.u_phi, outputs(all));
}

void density_of_strands(const hairlut_model &model, const Strands &strands, const rival_arrays &all)
{
    hairlut_pdf_strand_n(&model, all.n, strands.by_parameter.data(), nullptr, all.theta_r, all.phi_r, all.offset,
                         all.theta_light, all.phi_light, all.pdf_light);
}

constexpr size_t lights = 4; // of a hit

// The sum of the densities of as many lights' directions, those of i and the next
template <class Density> float sum_of_lights(const rival_arrays &all, size_t i, size_t count, Density density)
{
    float sum = 0.0f;
    for (size_t k = 0; k < count; ++k) {
        const size_t light = (i + k) % all.n;
        sum += density(all.theta_light[light], all.phi_light[light]);
    }
    return sum;
}

// strand: its parameters, or nullptr
void hit(const hairlut_model &model, const float *strand, const rival_arrays &all, size_t i)
{
    sample_strand(model, strand, all, i);
    all.pdf_light[i] = sum_of_lights(all, i, lights, [&](float theta, float phi) {
        return hairlut_pdf_strand(&model, strand, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i], theta, phi);
    });
}

void hit_by_viewer(const hairlut_model &model, const float *strand, const rival_arrays &all, size_t i, size_t count)
{
    hairlut_viewer viewer;
    hairlut_viewer_at(&viewer, &model, strand, nullptr, all.theta_r[i], all.phi_r[i], all.offset[i]);
    put(all, i, hairlut_viewer_sample(&viewer, all.u_lobe[i], all.u_theta[i], all.u_phi[i]));
    all.pdf_light[i] =
        sum_of_lights(all, i, count, [&](float theta, float phi) { return hairlut_viewer_pdf(&viewer, theta, phi); });
}

std::string of_run(const char *call, size_t run)
{
    return run == 1 ? call : std::string(call) + "_" + std::to_string(run);
}

} // namespace

Calls strand_calls(const hairlut_model &model, size_t run)
{
    const auto strands = random_strands(model, run);
    return {{of_run("sample_strand", run),
             [&model, strands](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     sample_strand(model, strands->of(i), all, i);
             }},
            {of_run("pdf_strand", run),
             [&model, strands](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     density_of_strand(model, strands->of(i), all, i);
             }},
            {of_run("vertex_strand", run), [&model, strands](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i) {
                     sample_strand(model, strands->of(i), all, i);
                     density_of_strand(model, strands->of(i), all, i);
                 }
             }}};
}

Calls hit_calls(const hairlut_model &model)
{
    const auto strands = random_strands(model, 1);
    const bool some = strands->parameters > 0;
    const std::string of = some ? "_strand" : "";
    const auto at = [strands, some](size_t i) { return some ? strands->of(i) : nullptr; };
    return {{"hit" + of,
             [&model, at](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     hit(model, at(i), all, i);
             }},
            {"hit" + of + "_viewer",
             [&model, at](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     hit_by_viewer(model, at(i), all, i, lights);
             }},
            {"vertex" + of + "_viewer", [&model, at](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     hit_by_viewer(model, at(i), all, i, 1);
             }}};
}

Calls strand_array_calls(const hairlut_model &model, size_t run)
{
    const auto strands = random_strands(model, run);
    return {
        {of_run("sample_strand", run), [&model, strands](const rival_arrays &all) { sample_strands(model, *strands, all); }},
        {of_run("pdf_strand", run),
         [&model, strands](const rival_arrays &all) { density_of_strands(model, *strands, all); }},
        {of_run("vertex_strand", run), [&model, strands](const rival_arrays &all) {
             sample_strands(model, *strands, all);
             density_of_strands(model, *strands, all);
         }}};
}

Calls hair_calls(const hairlut_model &model)
{
    return {{"sample_hair",
             [&model](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     sample_one(model, all, i);
             }},
            {"pdf_hair",
             [&model](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     density_of_one(model, all, i);
             }},
            {"vertex", [&model](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i) {
                     sample_one(model, all, i);
                     density_of_one(model, all, i);
                 }
             }}};
}

Calls hair_calls(const hairlut_model &model, const hairlut_batch &kernels)
{
    return {{"sample_hair", [&](const rival_arrays &all) { sample_arrays(model, kernels, all); }},
            {"pdf_hair", [&](const rival_arrays &all) { density_of_arrays(model, kernels, all); }},
            {"vertex", [&](const rival_arrays &all) {
                 sample_arrays(model, kernels, all);
                 density_of_arrays(model, kernels, all);
             }}};
}

Calls lobe_calls(const hairlut_model &model, const std::string &name)
{
    const int lobe = hairlut_lobe_index(&model, name.c_str());
    return {{"sample_" + name,
             [&model, lobe](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     put(all, i,
                         hairlut_sample_lobe(&model, lobe, all.theta_r[i], all.phi_r[i], all.u_theta[i], all.u_phi[i]));
             }},
            {"pdf_" + name, [&model, lobe](const rival_arrays &all) {
                 for (size_t i = 0; i < all.n; ++i)
                     all.pdf_light[i] =
                         hairlut_pdf_lobe(&model, lobe, all.theta_r[i], all.phi_r[i], all.theta_light[i], all.phi_light[i]);
             }}};
}

Calls lobe_calls(const hairlut_model &model, const std::string &name, const hairlut_batch &kernels)
{
    const int lobe = hairlut_lobe_index(&model, name.c_str());
    return {{"sample_" + name,
             [&, lobe](const rival_arrays &all) {
                 kernels.sample_lobe(&model, lobe, all.n, all.theta_r, all.phi_r, all.u_theta, all.u_phi, outputs(all));
             }},
            {"pdf_" + name, [&, lobe](const rival_arrays &all) {
                 kernels.pdf_lobe(&model, lobe, all.n, all.theta_r, all.phi_r, all.theta_light, all.phi_light,
                                  all.pdf_light);
             }}};
}

} // namespace bench

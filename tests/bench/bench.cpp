// Times the library and its rivals in one run. Names: TARGET/HOW/MODEL/TABLE (NOTES.md); every benchmark has the counter
// "ns", the time of one sample. Inputs are random: theta_r uniform over its range, u uniform in [0, 1).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <string>
#include <vector>

extern "C" {
#include "batch.h"
#include "internal.h"
}
#include "axis_bench.h"
#include "rivals/rivals.h"
#include "warps.h"

namespace {

constexpr size_t count = 1 << 13;  // 32 KiB an array: inputs and outputs stay in the second-level cache

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

struct Arrays {
    std::vector<float, Aligned<float>> theta_r, phi_r, u_theta, u_phi, a, b, c, d, corners;
    Arrays() : a(count), b(count), c(count), d(count), corners(4 * count)
    {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> angle(-1.5707963f, 1.5707963f), turn(-3.1415926f, 3.1415926f);
        for (size_t i = 0; i < count; ++i) {
            theta_r.push_back(angle(random));
            phi_r.push_back(turn(random));
            u_theta.push_back(static_cast<float>(random() >> 8) / 16777216.0f);
            u_phi.push_back(static_cast<float>(random() >> 8) / 16777216.0f);
        }
    }
};

Arrays &arrays()
{
    static Arrays all;
    return all;
}

using Body = std::function<void(Arrays &)>;

// The body with its stack that many bytes further on
__attribute__((noinline)) void further_on(size_t bytes, const Body &body, Arrays &all)
{
    volatile char *skipped = static_cast<char *>(__builtin_alloca(bytes));
    skipped[0] = 0;
    body(all);
    skipped[bytes - 1] = 0;
}

// Where a function's own arrays lie among ours costs it up to 12 % (NOTES.md): a repeat goes through all places in a page.
void add(const std::string &name, const Body &body)
{
    benchmark::RegisterBenchmark(name.c_str(), [body](benchmark::State &state) {
        Arrays &all = arrays();
        size_t place = 0;
        for (auto _ : state) {
            place = place % 4096 + 64;
            further_on(place, body, all);
            benchmark::ClobberMemory();
        }
        state.counters["ns"] = benchmark::Counter(1e-9 * count, benchmark::Counter::kIsIterationInvariantRate
                                                                    | benchmark::Counter::kInvert);
    });
}

struct Table {
    const char *name;
    hairlut_axis hairlut_model::*axis;
};
constexpr Table tables[] = {{"direct_theta", &hairlut_model::direct_theta},
                            {"direct_phi", &hairlut_model::direct_phi},
                            {"multiple_theta", &hairlut_model::multiple_theta}};

// The kernels of every instruction set that this processor runs; the last one is also registered as "batch".
std::vector<const axis_kernels *> vector_kernels()
{
    std::vector<const axis_kernels *> found;
    for (int level = 1; const hairlut_batch *batch = hairlut_batch_level(level); ++level) {
#if defined(__x86_64__) || defined(__i386__)
        for (const axis_kernels *kernels : {&axis_avx2, &axis_avx512})
#elif defined(__aarch64__)
        for (const axis_kernels *kernels : {&axis_neon})
#else
        for (const axis_kernels *kernels : std::vector<const axis_kernels *>())
#endif
            if (std::strcmp(kernels->name, batch->name) == 0)
                found.push_back(kernels);
    }
    return found;
}

void add_axis(const std::string &how, const axis_kernels &kernels, const std::string &name, const hairlut_axis &axis)
{
    add("sample/" + how + "/" + name, [&](Arrays &all) {
        kernels.sample(&axis, count, all.theta_r.data(), all.u_theta.data(), all.a.data(), all.b.data());
    });
    const auto drawn = std::make_shared<std::vector<float>>(count);
    std::vector<float> density(count);
    axis_scalar.sample(&axis, count, arrays().theta_r.data(), arrays().u_theta.data(), drawn->data(), density.data());
    add("pdf/" + how + "/" + name, [&, drawn](Arrays &all) {
        kernels.pdf(&axis, count, all.theta_r.data(), drawn->data(), all.a.data());
    });
}

// The same texels read as if their knots were uniform in u: the same code path, without the warp.
const hairlut_axis &uniform(const hairlut_axis &axis)
{
    auto *copy = new hairlut_axis(axis);
    copy->warp = HAIRLUT_WARP_UNIFORM;
    copy->scale = static_cast<float>(axis.columns - 1);
    copy->origin = 0;
    return *copy;
}

void add_uniform(const std::string &how, const axis_kernels &kernels, const std::string &name, const hairlut_axis &axis)
{
    const hairlut_axis &flat = uniform(axis);
    add("uniform/" + how + "/" + name, [&](Arrays &all) {
        kernels.sample(&flat, count, all.theta_r.data(), all.u_theta.data(), all.a.data(), all.b.data());
    });
}

// The texel of column i in row j: the x0 of the cell that begins there, seen from the nearer end
float texel(const hairlut_axis &axis, int j, int i)
{
    const int mirrored = axis.columns - 1 - i;
    return axis.ends[mirrored < i][std::min(i, mirrored) * axis.pitch + HAIRLUT_CELL * j];
}

// The four corners of every cell as one record of 16 bytes, and the records of the samples' cells.
void add_floor(const axis_kernels &kernels, const std::string &name, const hairlut_axis &axis)
{
    const int cells = axis.columns - 1;
    auto records = std::make_shared<std::vector<float>>(4 * static_cast<size_t>(cells * (axis.height - 1)));
    for (int j = 0, k = 0; j + 1 < axis.height; ++j)
        for (int i = 0; i < cells; ++i, k += 4) {
            const float four[4] = {texel(axis, j, i), texel(axis, j, i + 1), texel(axis, j + 1, i), texel(axis, j + 1, i + 1)};
            std::copy(four, four + 4, records->begin() + k);
        }
    auto index = std::make_shared<std::vector<int>>(count);
    for (size_t i = 0; i < count; ++i) {
        const int row = std::min(axis.height - 2, static_cast<int>((arrays().theta_r[i] - axis.row_origin) * axis.row_scale));
        (*index)[i] = 4 * (row * cells + static_cast<int>(arrays().u_theta[i] * static_cast<float>(cells)));
    }
    add("floor/index/" + name, [&kernels, records, index](Arrays &all) {
        kernels.floor_index(records->data(), count, index->data(), all.corners.data());
    });
    add("floor/angles/" + name, [&kernels, &axis, records](Arrays &all) {
        kernels.floor_angles(&axis, records->data(), count, all.theta_r.data(), all.u_theta.data(), all.corners.data());
    });
}

// The widest kernels that have a floor: those in AVX-512 fetch their cells with AVX2's.
const axis_kernels &widest_floor(const std::vector<const axis_kernels *> &kernels)
{
    return **std::find_if(kernels.rbegin(), kernels.rend(), [](const axis_kernels *some) { return some->floor_index; });
}

void add_tables(const std::string &model_name, const hairlut_model &model)
{
    const auto vectors = vector_kernels();
    for (const Table &table : tables) {
        const hairlut_axis &axis = model.*table.axis;
        const std::string name = model_name + "/" + table.name;
        add_axis("scalar", axis_scalar, name, axis);
        add_uniform("scalar", axis_scalar, name, axis);
        for (const axis_kernels *kernels : vectors)
            add_axis(kernels->name, *kernels, name, axis);
        if (!vectors.empty()) {
            add_axis("batch", *vectors.back(), name, axis);
            add_uniform("batch", *vectors.back(), name, axis);
            add_floor(widest_floor(vectors), name, axis);
        }
    }
}

using Sample = void (*)(const hairlut_model *, size_t, const float *, const float *, const float *, const float *,
                        hairlut_samples);
using Density = void (*)(const hairlut_model *, size_t, const float *, const float *, const float *, const float *, float *);

void add_lobe(const std::string &how, Sample sample, Density pdf, const std::string &name, const hairlut_model &model)
{
    add("lobe/sample/" + how + "/" + name, [&model, sample](Arrays &all) {
        sample(&model, count, all.theta_r.data(), all.phi_r.data(), all.u_theta.data(), all.u_phi.data(),
               {all.a.data(), all.b.data(), all.c.data(), all.d.data()});
    });
    auto theta = std::make_shared<std::vector<float>>(count), phi = std::make_shared<std::vector<float>>(count);
    sample(&model, count, arrays().theta_r.data(), arrays().phi_r.data(), arrays().u_theta.data(), arrays().u_phi.data(),
           {theta->data(), phi->data(), nullptr, nullptr});
    add("lobe/pdf/" + how + "/" + name, [&model, pdf, theta, phi](Arrays &all) {
        pdf(&model, count, all.theta_r.data(), all.phi_r.data(), theta->data(), phi->data(), all.a.data());
    });
}

void add_lobes(const std::string &name, const hairlut_model &model)
{
    const hairlut_batch &one = *hairlut_batch_level(0);  // the portable kernels call the one-direction functions
    add_lobe("scalar", one.sample_direct, one.pdf_direct, name + "/direct", model);
    add_lobe("scalar", one.sample_multiple, one.pdf_multiple, name + "/multiple", model);
    add_lobe("batch", hairlut_sample_direct_n, hairlut_pdf_direct_n, name + "/direct", model);
    add_lobe("batch", hairlut_sample_multiple_n, hairlut_pdf_multiple_n, name + "/multiple", model);
}

using Analytic = void (*)(rival_table, size_t, const float *, const float *, float *, float *);
using Hybrid = void (*)(const rival_rows *, size_t, const float *, const float *, float *, float *);

void add_analytic(const std::string &how, Analytic rival, const std::string &name, rival_table table)
{
    add("rival/" + how + "/" + name, [=](Arrays &all) {
        rival(table, count, all.theta_r.data(), all.u_theta.data(), all.a.data(), all.b.data());
    });
}

void add_hybrid(const std::string &how, Hybrid rival, const std::string &name, rival_table table)
{
    auto rows = std::make_shared<rival_rows>();
    rival_fill_rows(table, rows.get());
    add("rival/hybrid/" + how + "/" + name, [rival, rows](Arrays &all) {
        rival(rows.get(), count, all.theta_r.data(), all.u_theta.data(), all.a.data(), all.b.data());
    });
}

// Without AVX-512, a rival of that width is the 256-bit one by another name.
bool has_avx512()
{
#if defined(__x86_64__) || defined(__i386__)
    return __builtin_cpu_supports("avx512f");
#else
    return false;
#endif
}

void add_rivals()
{
    const std::pair<std::string, rival_table> lobes[] = {
        {"printed/direct_theta", PRINTED_DIRECT_THETA}, {"printed/direct_phi", DIRECT_PHI},
        {"printed/multiple_theta", MULTIPLE_THETA},     {"fitted/direct_theta", FITTED_DIRECT_THETA},
        {"fitted/direct_phi", DIRECT_PHI},              {"fitted/multiple_theta", MULTIPLE_THETA}};
    for (const auto &[name, table] : lobes) {
        add_analytic("analytic/scalar", rival_analytic_scalar, name, table);
        add_analytic("analytic/vector256", rival_analytic_vector256, name, table);
        add_hybrid("scalar", rival_hybrid_scalar, name, table);
        add_hybrid("vector256", rival_hybrid_vector256, name, table);
        if (has_avx512()) {
            add_analytic("analytic/vector512", rival_analytic_vector512, name, table);
            add_hybrid("vector512", rival_hybrid_vector512, name, table);
        }
#ifdef HAVE_BOOST
        add_analytic("boost/scalar", rival_boost_scalar, name, table);
#endif
#ifdef HAVE_MKL
        add_analytic("mkl/vector", rival_mkl_vector, name, table);
#endif
    }
#ifdef HAVE_MKL
    float angle = 0.0f, u = 0.5f, x, pdf;
    rival_mkl_vector(DIRECT_PHI, 1, &angle, &u, &x, &pdf); // its first call loads what fits the processor
#endif
}

void add_warps(const std::string &how, const bench_warp *warps)
{
    for (int i = 0; i < BENCH_WARPS; ++i)
        add("warp/" + how + "/" + warps[i].name, [map = warps[i].map](Arrays &all) {
            map(count, all.u_theta.data(), all.a.data());
        });
}

// Every subdirectory of `directory` is a model; without one, the compiled-in models stand in.
std::map<std::string, const hairlut_model *> models(const std::string &directory)
{
    std::map<std::string, const hairlut_model *> found;
    if (directory.empty())
        return {{"printed", hairlut_builtin("printed")}, {"fitted", hairlut_builtin("fitted")}};
#ifdef HAVE_EXR
    char message[HAIRLUT_MESSAGE_SIZE];
    for (const auto &entry : std::filesystem::directory_iterator(directory)) {
        hairlut_model *model = nullptr;
        if (!entry.is_directory())
            continue;
        if (hairlut_load_with(entry.path().c_str(), nullptr, &model, message) != HAIRLUT_OK) {
            std::fprintf(stderr, "%s\n", message);
            std::exit(1);
        }
        found[entry.path().filename()] = model;
    }
#else
    std::fprintf(stderr, "--luts %s: built without the EXR loader (OpenEXR >= 3.1 was not found)\n", directory.c_str());
    std::exit(2);
#endif
    return found;
}

// Removes "--luts DIR" from the arguments.
std::string luts_argument(int &argc, char **argv)
{
    std::string directory;
    int kept = 1;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--luts") == 0 && i + 1 < argc)
            directory = argv[++i];
        else
            argv[kept++] = argv[i];
    }
    argc = kept;
    return directory;
}

}  // namespace

int main(int argc, char **argv)
{
    const std::string directory = luts_argument(argc, argv);
    benchmark::AddCustomContext("kernels", hairlut_batch_widest()->name);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    for (const auto &[name, model] : models(directory)) {
        add_tables(name, *model);
        add_lobes(name, *model);
    }
    add_rivals();
    add_warps("scalar", bench_warps_scalar);
    add_warps("vector", bench_warps_vector);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

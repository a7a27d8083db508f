// SPDX-License-Identifier: BSD-3-Clause
// Times the calls of hairlut.h and those of its rivals in one run. Names: MODEL/CALL/WHO/HOW (NOTES.md); every benchmark has the
// counter "ns", the time of one sample.
#include <benchmark/benchmark.h>

#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <thread>

#include "calls.h"
#include "floor.h"
#include "inputs.h"
#include "warps.h"

namespace {

using bench::Call;
using bench::count;

// The call with its stack that many bytes further on
__attribute__((noinline)) void further_on(size_t bytes, const Call &call, const rival_arrays &all)
{
    volatile char *skipped = static_cast<char *>(__builtin_alloca(bytes));
    skipped[0] = 0;
    call(all);
    skipped[bytes - 1] = 0;
}

// Where a function's own arrays lie among ours costs it up to 12 % (NOTES.md): a repeat goes through all places in a page.
void time_call(benchmark::State &state, const Call &call, const rival_arrays &all)
{
    size_t place = 0;
    for (auto _ : state) {
        place = place % 4096 + 64;
        further_on(place, call, all);
        benchmark::ClobberMemory();
    }
    state.counters["ns"] =
        benchmark::Counter(1e-9 * count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void add(const std::string &name, const Call &call)
{
    static const bench::Inputs inputs(1);
    benchmark::RegisterBenchmark(name.c_str(), [call](benchmark::State &state) { time_call(state, call, inputs.view()); });
}

// All threads draw from one model; the time is that of a processor for a sample, over the number of threads.
void add_threads(const std::string &name, const Call &call, int threads)
{
    benchmark::RegisterBenchmark((name + std::to_string(threads)).c_str(), [call](benchmark::State &state) {
        const bench::Inputs own(static_cast<unsigned>(2 + state.thread_index()));
        time_call(state, call, own.view());
    })->Threads(threads);
}

void add_all(const std::string &model, const bench::Calls &calls, const std::string &how)
{
    for (const auto &[name, call] : calls)
        add(model + "/" + name + "/hairlut/" + how, call);
}

// Over arrays the widest kernels are called "arrays", narrower ones by their own name.
void add_model(const std::string &name, const hairlut_model &model)
{
    std::vector<std::string> lobes;
    for (const char *lobe : {"direct", "multiple"})
        if (hairlut_lobe_index(&model, lobe) >= 0)
            lobes.push_back(lobe);
    add_all(name, bench::hair_calls(model), "one");
    add_all(name, bench::hit_calls(model), "one");
    for (const std::string &lobe : lobes)
        add_all(name, bench::lobe_calls(model, lobe), "one");
    for (int level = 0; const hairlut_batch *kernels = hairlut_batch_level(level); ++level) {
        const std::string how = kernels == hairlut_batch_widest() ? "arrays" : kernels->name;
        add_all(name, bench::hair_calls(model, *kernels), how);
        for (const std::string &lobe : lobes)
            add_all(name, bench::lobe_calls(model, lobe, *kernels), how);
    }
    if (hairlut_parameter_count(&model))
        for (const size_t run : {1, 64}) {
            add_all(name, bench::strand_calls(model, run), "one");
            add_all(name, bench::strand_array_calls(model, run), "arrays");
        }
    for (int threads = 1; threads <= static_cast<int>(std::thread::hardware_concurrency()); threads *= 2)
        for (const auto &[call, function] : bench::hair_calls(model, *hairlut_batch_widest()))
            add_threads(name + "/" + call + "/hairlut/threads", function, threads);
}

void add_rivals()
{
    for (int i = 0; const rival *one = rival_at(i); ++i) {
        const std::pair<const char *, rival_call *> calls[] = {{"sample_direct", one->sample_direct},
                                                               {"pdf_direct", one->pdf_direct},
                                                               {"sample_multiple", one->sample_multiple},
                                                               {"pdf_multiple", one->pdf_multiple},
                                                               {"sample_hair", one->sample_hair},
                                                               {"pdf_hair", one->pdf_hair},
                                                               {"vertex", one->vertex},
                                                               {"hit", one->hit}};
        for (const auto &[name, call] : calls)
            if (call)
                add(std::string(one->model) + "/" + name + "/" + one->name + "/" + one->how,
                    [call = call](const rival_arrays &all) { call(&all); });
    }
}

bool same(hairlut_sample a, hairlut_sample b)
{
    return a.theta_i == b.theta_i && a.phi_i == b.phi_i && a.pdf_angle == b.pdf_angle &&
           a.pdf_solid_angle == b.pdf_solid_angle;
}

// Ends the program where its numbers are not the library's, to the bit: it would be the floor of something else.
void check_floor(const bench_floor &floor, const hairlut_model &fitted)
{
    const bench::Inputs inputs(3);
    const rival_arrays &all = inputs.view();
    for (size_t i = 0; i < all.n; ++i) {
        const float theta_r = all.theta_r[i], phi_r = all.phi_r[i], theta = all.theta_light[i], phi = all.phi_light[i];
        if (floor.pdf(theta_r, phi_r, theta, phi) != hairlut_pdf_hair(&fitted, nullptr, theta_r, phi_r, 0.0f, theta, phi) ||
            !same(
                floor.sample(theta_r, phi_r, all.u_lobe[i], all.u_theta[i], all.u_phi[i]),
                hairlut_sample_hair(&fitted, nullptr, theta_r, phi_r, 0.0f, all.u_lobe[i], all.u_theta[i], all.u_phi[i]))) {
            std::fprintf(stderr, "floor.c: its numbers are not those of the library\n");
            std::exit(1);
        }
    }
}

void add_floor(const hairlut_model &fitted)
{
    const bench_floor *const floor = bench_floor_of(&fitted);
    if (!floor)
        return;
    check_floor(*floor, fitted);
    const auto sample = [floor](const rival_arrays &all, size_t i) {
        const hairlut_sample s = floor->sample(all.theta_r[i], all.phi_r[i], all.u_lobe[i], all.u_theta[i], all.u_phi[i]);
        all.theta_i[i] = s.theta_i;
        all.phi_i[i] = s.phi_i;
        all.pdf_angle[i] = s.pdf_angle;
        all.pdf_solid_angle[i] = s.pdf_solid_angle;
    };
    const auto pdf = [floor](const rival_arrays &all, size_t i) {
        all.pdf_light[i] = floor->pdf(all.theta_r[i], all.phi_r[i], all.theta_light[i], all.phi_light[i]);
    };
    add("fitted/sample_hair/floor/one", [sample](const rival_arrays &all) {
        for (size_t i = 0; i < all.n; ++i)
            sample(all, i);
    });
    add("fitted/pdf_hair/floor/one", [pdf](const rival_arrays &all) {
        for (size_t i = 0; i < all.n; ++i)
            pdf(all, i);
    });
    add("fitted/pdf_direct/floor/one", [floor](const rival_arrays &all) {
        for (size_t i = 0; i < all.n; ++i)
            all.pdf_light[i] = floor->pdf_direct(all.theta_r[i], all.phi_r[i], all.theta_light[i], all.phi_light[i]);
    });
    add("fitted/vertex/floor/one", [sample, pdf](const rival_arrays &all) {
        for (size_t i = 0; i < all.n; ++i) {
            sample(all, i);
            pdf(all, i);
        }
    });
}

void add_warps(const std::string &how, const bench_warp *warps)
{
    for (int i = 0; i < BENCH_WARPS; ++i)
        add(std::string("warp/") + warps[i].name + "/alone/" + how,
            [map = warps[i].map](const rival_arrays &all) { map(all.n, all.u_theta, all.theta_i); });
}

// Memory from malloc, of which *user has how much is in use; its size is kept before it
constexpr size_t before = alignof(std::max_align_t);

void *counted(void *user, size_t size)
{
    char *memory = static_cast<char *>(std::malloc(before + size));
    if (!memory)
        return nullptr;
    std::memcpy(memory, &size, sizeof size);
    *static_cast<size_t *>(user) += size;
    return memory + before;
}

void released(void *user, void *memory)
{
    char *start = static_cast<char *>(memory) - before;
    size_t size;
    std::memcpy(&size, start, sizeof size);
    *static_cast<size_t *>(user) -= size;
    std::free(start);
}

// The models compiled into the library, and every directory below `directory` that holds one
std::map<std::string, const hairlut_model *> models(const std::string &directory)
{
    std::map<std::string, const hairlut_model *> found;
    for (const char *name : {"printed", "fitted", "brown"})
        if (const hairlut_model *model = hairlut_builtin(name))
            found[name] = model;
    if (directory.empty())
        return found;
#ifdef HAVE_EXR
    char message[HAIRLUT_MESSAGE_SIZE];
    for (const auto &entry : std::filesystem::directory_iterator(directory)) {
        hairlut_model *model = nullptr;
        if (!entry.is_directory())
            continue;
        size_t bytes = 0;
        const hairlut_allocator memory = {counted, released, &bytes};
        if (hairlut_load_with(entry.path().c_str(), &memory, &model, message) != HAIRLUT_OK) {
            std::fprintf(stderr, "%s\n", message);
            std::exit(1);
        }
        const std::string name = entry.path().filename();
        benchmark::AddCustomContext("bytes of " + name, std::to_string(bytes));
        found[name] = model;
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

} // namespace

int main(int argc, char **argv)
{
    const std::string directory = luts_argument(argc, argv);
    benchmark::AddCustomContext("kernels", hairlut_batch_widest()->name);
    benchmark::AddCustomContext("compiler", "gcc " __VERSION__);
#ifdef __GLIBC__
    benchmark::AddCustomContext("libm", std::string("glibc ") + gnu_get_libc_version());
#endif
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    for (const auto &[name, model] : models(directory))
        add_model(name, *model);
    if (const hairlut_model *fitted = hairlut_builtin("fitted"))
        add_floor(*fitted);
    add_rivals();
    add_warps("one", bench_warps_scalar);
    add_warps("arrays", bench_warps_vector);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

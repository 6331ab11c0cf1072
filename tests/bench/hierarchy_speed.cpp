#include "builder.h"
#include "sections.h"
#include "subjects.h"
#include "surface.h"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>

namespace xgc::bench {
namespace {

struct Seconds {
    double wall = 0;
    double cpu = 0; ///< of all threads: what a loaded machine changes least
};

Seconds secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpuStart = std::clock();
    work();
    const std::clock_t cpuEnd = std::clock();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            double(cpuEnd - cpuStart) / CLOCKS_PER_SEC};
}

/// Levels by the packaged meshoptimizer: each simplified to half of the one before, down to 128 triangles.
void simplifyByHalves(const Surface& surface) {
    std::vector<uint32_t> from(&surface.triangles[0].x, &surface.triangles[0].x + 3 * surface.triangles.size());
    std::vector<uint32_t> to(from.size());
    while (from.size() > 3 * 128) {
        to.resize(from.size());
        const size_t n =
            meshopt_simplify(to.data(), from.data(), from.size(), &surface.points[0].x, surface.points.size(),
                             sizeof(glm::vec3), from.size() / 6 * 3, 1e10f, 0, nullptr);
        if (n > from.size() / 100 * 95) break;
        to.resize(n);
        std::swap(from, to);
    }
}

/// The seconds on the clock and of the processor that a command prints, given a file.
Seconds secondsBeside(const std::string& command, const std::filesystem::path& file) {
    FILE* out = popen(fmt::format("{} '{}'", command, file.string()).c_str(), "r");
    Seconds s;
    if (!out || std::fscanf(out, "%lf %lf", &s.wall, &s.cpu) != 2) s = {NAN, NAN};
    if (out) pclose(out);
    return s;
}

/// What is timed, in turn with the others.
struct Timed {
    std::string name;
    std::function<Seconds()> run;
    uint32_t every = 1; ///< takes part in each run of this number
    std::vector<double> wall, cpu;
};

std::vector<Timed> timedOn(const Flags& flags, const Subject& subject, const Surface& surface,
                           const std::filesystem::path& file) {
    const auto onThreads = [&subject](size_t threads, bool errors) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return secondsOf([&] {
            const bake::Hierarchy h = build(subject, subject.parts);
            if (errors) measureErrors(subject, h);
        });
    };
    const auto threads = size_t(tbb::info::default_concurrency());
    std::vector<Timed> timed{{"build, 1 thread", [=] { return onThreads(1, false); }, 1, {}, {}},
                             {"build and errors, 1 thread", [=] { return onThreads(1, true); }, 2, {}, {}}};
    if (threads > 1) {
        timed.push_back(
            {fmt::format("build, {} threads", threads), [=] { return onThreads(threads, false); }, 1, {}, {}});
        timed.push_back({fmt::format("build and errors, {} threads", threads),
                         [=] { return onThreads(threads, true); },
                         2,
                         {},
                         {}});
    }
    timed.push_back({"meshopt_simplify 0.18 by halves",
                     [&surface] { return secondsOf([&] { simplifyByHalves(surface); }); },
                     1,
                     {},
                     {}});
    if (!flags.beside.empty())
        timed.push_back({"beside", [&flags, file] { return secondsBeside(flags.beside, file); }, 1, {}, {}});
    return timed;
}

void measure(const Flags& flags, const Subject& subject, Csv& csv) {
    const Surface surface = surfaceOf(subject.mesh);
    const std::filesystem::path file = std::filesystem::temp_directory_path() / (subject.name + "-xgc-speed.ply");
    if (!flags.beside.empty() && !writePly(file, surface).ok()) return;
    std::vector<Timed> timed = timedOn(flags, subject, surface, file);
    const double faces = subject.mesh.faceCount();
    const uint32_t runs = faces > 3e6 ? 1 : flags.runs;
    for (uint32_t run = 0; run < runs; ++run) {
        for (Timed& t : timed) {
            if (run % t.every != 0) continue;
            const Seconds seconds = t.run();
            t.wall.push_back(seconds.wall);
            t.cpu.push_back(seconds.cpu);
        }
    }
    fmt::print("\n{}, {} faces, {} runs\n", subject.name, subject.mesh.faceCount(), runs);
    fmt::print("  {:<34} {:>8} {:>8} {:>10} {:>10} {:>16}\n", "", "wall s", "CPU s", "Mfaces/s", "a CPU s",
               "CPU of the first");
    for (const Timed& t : timed) {
        const double wall = median(t.wall), cpu = median(t.cpu);
        fmt::print("  {:<34} {:>8.3f} {:>8.3f} {:>10.3f} {:>10.3f} {:>16.2f}\n", t.name, wall, cpu, faces / wall * 1e-6,
                   faces / cpu * 1e-6, cpu / median(timed[0].cpu));
        csv.row(fmt::format("{},{},\"{}\",{:.5f},{:.5f}", subject.name, subject.mesh.faceCount(), t.name, wall, cpu));
    }
    std::filesystem::remove(file);
}

} // namespace

int benchSpeed(const Flags& flags) {
    Csv csv(flags, "speed", "model,faces,what,wall_seconds,cpu_seconds");
    std::vector<Source> sources{{"terrain20k", {}, 20'000, true}, {"terrain1M", {}, 1'000'000, true}};
    if (!flags.data.empty()) sources.push_back({"psb113", flags.data / "psb/off/113.off", 0, true});
    for (Source& s : dragon()) sources.push_back({s.name, s.file, 0, true});
    sources.push_back({"terrain8M", {}, 8'000'000, true});
    return forSubjects(flags, sources, [&](const Subject& subject) { measure(flags, subject, csv); });
}

} // namespace xgc::bench

#include "builder.h"
#include "sections.h"
#include "surface.h"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>

namespace xgc::bench {
namespace {

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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

/// Seconds that a command prints, given a file.
std::optional<double> secondsBeside(const std::string& command, const std::filesystem::path& file) {
    FILE* out = popen(fmt::format("{} '{}'", command, file.string()).c_str(), "r");
    double seconds = 0;
    const bool good = out && std::fscanf(out, "%lf", &seconds) == 1;
    if (out) pclose(out);
    return good ? std::optional(seconds) : std::nullopt;
}

/// What is timed, in turn with the others.
struct Timed {
    std::string name;
    std::function<double()> run;
    uint32_t every = 1; ///< takes part in each run of this number
    std::vector<double> seconds;
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
    std::vector<Timed> timed{{"build, 1 thread", [=] { return onThreads(1, false); }, 1, {}},
                             {"build and errors, 1 thread", [=] { return onThreads(1, true); }, 2, {}}};
    if (threads > 1) {
        timed.push_back({fmt::format("build, {} threads", threads), [=] { return onThreads(threads, false); }, 1, {}});
        timed.push_back(
            {fmt::format("build and errors, {} threads", threads), [=] { return onThreads(threads, true); }, 2, {}});
    }
    timed.push_back({"meshopt_simplify 0.18 by halves",
                     [&surface] { return secondsOf([&] { simplifyByHalves(surface); }); },
                     1,
                     {}});
    if (!flags.beside.empty())
        timed.push_back({"beside", [&flags, file] { return secondsBeside(flags.beside, file).value_or(0); }, 1, {}});
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
            if (run % t.every == 0) t.seconds.push_back(t.run());
        }
    }
    fmt::print("\n{}, {} faces, {} runs\n", subject.name, subject.mesh.faceCount(), runs);
    for (const Timed& t : timed) {
        const double seconds = median(t.seconds);
        fmt::print("  {:<34} {:>8.3f} s {:>8.3f} Mfaces/s  {:>5.2f} of the first\n", t.name, seconds,
                   faces / seconds * 1e-6, seconds / median(timed[0].seconds));
        csv.row(fmt::format("{},{},{},{:.5f},{:.4f}", subject.name, subject.mesh.faceCount(), t.name, seconds,
                            faces / seconds * 1e-6));
    }
    std::filesystem::remove(file);
}

} // namespace

int benchSpeed(const Flags& flags) {
    Csv csv(flags, "speed", "model,faces,what,seconds,million_faces_a_second");
    std::vector<Source> sources{{"terrain20k", {}, 20'000, true}, {"terrain1M", {}, 1'000'000, true}};
    if (!flags.data.empty()) sources.push_back({"psb113", flags.data / "psb/off/113.off", 0, true});
    for (Source& s : dragon()) sources.push_back({s.name, s.file, 0, true});
    sources.push_back({"terrain8M", {}, 8'000'000, true});
    for (const Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        Subject subject;
        if (const bake::Status s = load(source, subject); !s.ok()) {
            fmt::print(stderr, "{}\n", s.message);
            return int(s.outcome);
        }
        measure(flags, subject, csv);
    }
    return 0;
}

} // namespace xgc::bench

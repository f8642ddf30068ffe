// Experiments on the GPU kernels: brute force and shadow maps.
#include "editor/command_line/bench_runner.h"

#include <algorithm>

namespace sunfleck::command_line {
namespace {

// A form of brute force's kernel, as its settings say it.
struct Candidate {
    std::string pixels, lights, maps;
    bool shadows;
    std::vector<double> ns{};
};

// Every shape of the kernel, and last, for each value of `shadows`, the shape that brute force itself uses.
std::vector<Candidate> kernel_candidates() {
    std::vector<Candidate> candidates;
    for (const bool shadows : {false, true})
        for (const char* pixels : {"1", "2", "4", "8", "16"})
            for (const char* lights : {"uniform", "storage"})
                for (const char* maps : {"texel", "storage"})
                    if (shadows || maps == std::string("texel"))
                        candidates.push_back({pixels, lights, maps, shadows});
    for (const bool shadows : {false, true})
        candidates.push_back({"0", "standard", "standard", shadows});
    return candidates;
}

// Alternates the order of the candidates, so that a slow spell of the machine affects all of them alike.
Status measure_kernels(Bench& bench, std::vector<Candidate>& candidates, std::uint32_t rounds) {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 256;
    const double light_pixels = double(settings.lights) * bench.request.width * bench.request.height;
    Progress progress("bench kernel");
    for (std::uint32_t round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            Candidate& candidate = candidates[round % 2 == 0 ? i : candidates.size() - 1 - i];
            settings.shadows = candidate.shadows;
            settings.with("kernel_pixels", candidate.pixels).with("kernel_lights", candidate.lights);
            settings.with("kernel_maps", candidate.maps);
            SUNFLECK_ASSIGN(const Measurement measurement, bench.measure(settings, round == 0 ? 2 : 1, 1, false));
            candidate.ns.push_back(Bench::gpu_median(measurement, "brute force") * 1e6 / light_pixels);
            if (interrupted())
                return Error{"interrupted"};
            progress.show(double(round * candidates.size() + i + 1) / double(rounds * candidates.size()), "");
        }
    return {};
}

Json kernel_row(const Candidate& c, bool used) {
    return {{"shadowed", c.shadows ? "yes" : "no"},
            {"pixels", std::stoi(c.pixels)},
            {"lights", c.lights},
            {"maps", c.shadows ? c.maps : "-"},
            {"ns_per_light_pixel", median(c.ns)},
            {"spread_ns", percentile(c.ns, 0.75) - percentile(c.ns, 0.25)},
            {"used", used ? "brute force" : ""}};
}

} // namespace

Result<BenchTable> bench_kernel(const BenchOptions& options) {
    SUNFLECK_ASSIGN(const auto bench, Bench::create(options, "four_pillars", "bench_1", {640, 360}));
    std::vector<Candidate> candidates = kernel_candidates();
    SUNFLECK_TRY(measure_kernels(*bench, candidates, options.repeat));
    BenchTable table{"kernel", {}, {}};
    const std::size_t shapes = candidates.size() - 2;
    double best[2] = {1e30, 1e30};
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const Candidate& c = candidates[i];
        if (i < shapes)
            best[c.shadows] = std::min(best[c.shadows], median(c.ns));
        table.rows.push_back(kernel_row(c, i >= shapes));
    }
    table.notes["brute_force_over_best_unshadowed"] = median(candidates[shapes].ns) / best[0];
    table.notes["brute_force_over_best_shadowed"] = median(candidates[shapes + 1].ns) / best[1];
    return table;
}

Result<BenchTable> bench_brute_force(const BenchOptions& options) {
    BenchTable table{"brute_force", {}, {}};
    const std::string scene = options.scene.empty() ? "four_pillars" : options.scene;
    for (const Size size : {Size{640, 360}, Size{1024, 768}}) {
        SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "bench_1", size));
        for (const std::uint32_t lights : {64u, 300u, 1024u}) {
            gi::Settings settings = gi::Settings().all_light_by("brute_force");
            settings.lights = lights;
            SUNFLECK_ASSIGN(const Measurement m, bench->measure(settings, 2, options.repeat, true));
            table.rows.push_back({{"size", std::to_string(size.width) + "x" + std::to_string(size.height)},
                                  {"lights", lights},
                                  {"frame_ms", median(m.frame_ms)},
                                  {"frame_ms_p95", percentile(m.frame_ms, 0.95)},
                                  {"brute_force_ms", Bench::gpu_median(m, "brute force")},
                                  {"shadow_maps_ms", Bench::gpu_median(m, "shadow maps")},
                                  {"map_copies_ms", Bench::gpu_median(m, "shadow map copies")},
                                  {"g_buffer_ms", Bench::gpu_median(m, "g-buffer")},
                                  {"composition_ms", Bench::gpu_median(m, "composition")},
                                  {"map_updates", m.counters["shadow_map_updates"]}});
            if (interrupted())
                return Error{"interrupted"};
        }
    }
    return table;
}

namespace {

struct MapTimes {
    std::vector<double> draw, copy;
    gi::Report counters;
};

// Each measurement has new samples, so that every map is drawn; the first one is not counted.
Result<MapTimes> measure_maps(Bench& bench, std::uint32_t resolution, std::uint32_t repeat) {
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 256;
    settings.shadow_map_resolution = resolution;
    MapTimes times;
    for (std::uint32_t i = 0; i <= repeat; ++i) {
        settings.seed = i + 1;
        SUNFLECK_ASSIGN(const Measurement m, bench.measure(settings, 0, 1, false));
        if (i == 0)
            continue;
        times.draw.push_back(Bench::gpu_median(m, "shadow maps"));
        times.copy.push_back(Bench::gpu_median(m, "shadow map copies"));
        times.counters = m.counters;
    }
    return times;
}

} // namespace

Result<BenchTable> bench_shadow_maps(const BenchOptions& options) {
    BenchTable table{"shadow_maps", {}, {}};
    for (const char* scene : {"cornell", "table_room", "four_pillars"})
        for (const std::uint32_t resolution : {128u, 256u, 512u}) {
            SUNFLECK_ASSIGN(const auto bench, Bench::create(options, scene, "bench_1", {64, 36}));
            SUNFLECK_ASSIGN(const MapTimes times, measure_maps(*bench, resolution, options.repeat));
            const double maps = double(times.counters["shadow_map_updates"]);
            const double vertices = double(times.counters["shadow_map_vertices"]);
            table.rows.push_back({{"scene", scene},
                                  {"resolution", resolution},
                                  {"maps", times.counters["shadow_map_updates"]},
                                  {"faces", times.counters["shadow_map_faces"]},
                                  {"vertices_per_map", vertices / maps},
                                  {"us_per_map", median(times.draw) * 1e3 / maps},
                                  {"us_copy_per_map", median(times.copy) * 1e3 / maps},
                                  {"us_per_1000_vertices", median(times.draw) * 1e6 / vertices}});
        }
    return table;
}

} // namespace sunfleck::command_line

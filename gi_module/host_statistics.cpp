// The numbers that a foreign host can show.
#include "gi_module/host_context.h"

namespace sunfleck::host {
namespace {

// The only place here that knows which counters there are.
std::vector<Statistic> counters_of(const gi::System& system) {
    const gi::Counters& counters = system.counters();
    std::vector<Statistic> list;
    const auto add = [&](const char* name, std::uint64_t value) { list.push_back({name, double(value), ""}); };
    add("light samples", counters.light_samples);
    add("light samples, direct", counters.light_samples_direct);
    add("light samples, dynamic", counters.light_samples_dynamic);
    add("light samples, moved", counters.light_samples_moved);
    add("light samples, blocked", counters.light_samples_blocked);
    add("shadow map updates", counters.shadow_map_updates);
    add("shadow map faces", counters.shadow_map_faces);
    add("shadow map vertices", counters.shadow_map_vertices);
    add("shadow maps, stale", counters.shadow_maps_stale);
    add("light batches", counters.light_batches);
    add("surface patches", counters.surface_patches);
    add("visibility tests", counters.visibility.tests);
    add("light map updates", counters.light_map_updates);
    add("light map texels", counters.light_map_texels);
    add("baked light updates", counters.baked_light_updates);
    add("baked light, waiting", counters.baked_light_waiting);
    add("pixels, low resolution", counters.pixels.pixels_low_resolution);
    add("pixels, repaired", counters.pixels.pixels_repaired);
    add("pixels, not repaired", counters.pixels.pixels_not_repaired);
    add("transfer vertices", counters.transfer_vertices);
    return list;
}

std::vector<Statistic> times_of(const std::map<std::string, double>& milliseconds) {
    std::vector<Statistic> list;
    for (const auto& [name, time] : milliseconds)
        list.push_back({name, time, "ms"});
    return list;
}

} // namespace

Statistics Context::statistics() const {
    const Implementation& self = *implementation_;
    Statistics result;
    result.gpu_serial = self.timers->latest().serial;
    result.gpu_passes = times_of(self.timers->latest().milliseconds);
    result.cpu_stages = times_of(self.system->cpu_times());
    result.counters = counters_of(*self.system);
    for (const auto& [name, bytes] : self.device->memory().usage())
        result.memory.push_back({name, double(bytes) / 1048576.0, "MiB"});
    return result;
}

} // namespace sunfleck::host

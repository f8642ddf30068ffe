// The numbers that a foreign host can show.
#include "gi_module/host_context.h"

namespace sunfleck::host {
namespace {

std::vector<Statistic> counters_of(const gi::System& system) {
    std::vector<Statistic> list;
    for (const gi::Counter* counter : gi::all_counters())
        list.push_back({std::string(counter->name), system.counters()[counter->name], std::string(counter->unit)});
    return list;
}

std::vector<Statistic> times_of(const std::map<std::string, double>& milliseconds) {
    std::vector<Statistic> list;
    list.reserve(milliseconds.size());
    for (const auto& [name, time] : milliseconds)
        list.push_back({name, time, "ms"});
    return list;
}

} // namespace

Statistics Context::statistics() const {
    Implementation& self = *implementation_;
    const Result<Statistics> result = self.run([&]() -> Result<Statistics> {
        SUNFLECK_TRY(self.check_ready());
        Statistics numbers;
        numbers.gpu_serial = self.timers->latest().serial;
        numbers.gpu_passes = times_of(self.timers->latest().milliseconds);
        if (self.follower != nullptr) {
            numbers.cpu_stages = times_of(self.follower->system->cpu_times().milliseconds());
            numbers.counters = counters_of(*self.follower->system);
        }
        for (const auto& [name, bytes] : self.device->memory().usage())
            numbers.memory.push_back({name, double(bytes) / 1048576.0, "MiB"});
        return numbers;
    });
    return result ? *result : Statistics();
}

} // namespace sunfleck::host

#include "viewer/trace.h"
#include "engine/core/file.h"

#include <nlohmann/json.hpp>

namespace sunfleck::viewer {
namespace {

using Json = nlohmann::ordered_json;

enum Row { cpu_row = 1, gpu_row = 2 }; // threads, as viewers of traces call them

Json row_name(Row row, const char* name) {
    return {{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", int(row)}, {"args", {{"name", name}}}};
}

Json event(const std::string& name, Row row, double begin_ms, double end_ms) {
    return {{"name", name},
            {"ph", "X"},
            {"pid", 1},
            {"tid", row},
            {"ts", begin_ms * 1e3},
            {"dur", (end_ms - begin_ms) * 1e3}};
}

// The two clocks cannot be compared; the GPU cannot begin before the CPU has handed over the frame's work.
double gpu_begin(const FrameStatistics& frame) {
    for (const gpu::ScopeTime& scope : frame.cpu_scopes)
        if (scope.name == "recording")
            return scope.end_ms;
    return 0.0;
}

} // namespace

void Trace::add(const FrameStatistics& frame) {
    frames_.push_back({end_ms_, frame});
    end_ms_ += frame.frame_ms;
}

Status Trace::write(const std::filesystem::path& path) const {
    Json events = {row_name(cpu_row, "CPU"), row_name(gpu_row, "GPU (aligned with the end of recording)")};
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        const auto& [begin, frame] = frames_[i];
        events.push_back(event("frame " + std::to_string(i), cpu_row, begin, begin + frame.frame_ms));
        for (const gpu::ScopeTime& scope : frame.cpu_scopes)
            events.push_back(event(scope.name, cpu_row, begin + scope.begin_ms, begin + scope.end_ms));
        const double offset = begin + gpu_begin(frame);
        for (const gpu::ScopeTime& scope : frame.gpu_scopes)
            events.push_back(event(scope.name, gpu_row, offset + scope.begin_ms, offset + scope.end_ms));
    }
    return write_file(path, Json{{"traceEvents", events}, {"displayTimeUnit", "ms"}}.dump(1) + "\n");
}

} // namespace sunfleck::viewer

// Common parts of the experiments of `bench splatting`: Dachsbacher and Stamminger, "Splatting Indirect Illumination",
// I3D 2006, its figures beside ours. All rows have the same columns.
#pragma once

#include "editor/command_line/bench_runner.h"

namespace sunfleck::command_line {

// Of pictures that are compared with a limit of 65,536 lights, and of frames whose time is taken.
inline constexpr Size splat_picture_size{160, 90}, splat_flicker_size{64, 36}, splat_time_size{640, 360};

struct SplatExperiment {
    const BenchOptions& options;
    BenchTable& table;
    std::string part{};

    void row(const std::string& scene, const std::string& what, const std::string& measure, double value,
             const std::string& note = "") {
        table.rows.push_back(
            {{"part", part}, {"scene", scene}, {"case", what}, {"measure", measure}, {"value", value}, {"note", note}});
    }
};

// The scene, with the ceiling lamps of `arena` switched off.
Result<std::unique_ptr<Bench>> open_splat_scene(const BenchOptions& options, const std::string& scene, Size size);

// The first bounce alone, of all emitters, by pixel lights; nothing interpolated.
gi::Settings splats_alone(std::uint32_t count, const char* occlusion);
// The limit: each of 65,536 texels a pixel light.
gi::Settings splat_limit(const char* occlusion);

// The irradiance at a step of the scene. `orbit`: degrees that the camera has turned.
Result<io::Picture> splat_picture(Bench& bench, std::uint64_t step, float orbit = 0.0f);

// Medians of a measurement, ms: of GPU passes by the beginning of their names, and of stages of the CPU.
double passes_ms(const Measurement& measurement, std::initializer_list<std::string_view> names);
double stage_ms(const Measurement& measurement, const std::string& stage);

// E of light by warping, of slope, by number of lights; F and E with moving lamp or camera.
Status splat_errors(SplatExperiment& experiment);
Status splat_flicker(SplatExperiment& experiment);
// Shadows of pixel lights: truth error and cost; the threshold: evaluations and error; the paper's tables.
Status splat_occlusion(SplatExperiment& experiment);
Status splat_cutoff(SplatExperiment& experiment);
// Time at equal error, beside light that is gathered from reflective shadow maps, and without lists of tiles.
Status splat_gather(SplatExperiment& experiment);
// Evaluations within the bounds of pixel lights, beside shapes on the screen.
Status splat_bounds(SplatExperiment& experiment);
// 64 lamps that move, on one budget; beside light samples, all bounces; a polished ring's caustic.
Status splat_lamps(SplatExperiment& experiment);
Status splat_system(SplatExperiment& experiment);
Status splat_caustics(SplatExperiment& experiment);
Status splat_table1(SplatExperiment& experiment);
Status splat_table2(SplatExperiment& experiment);
Status splat_table3(SplatExperiment& experiment);

} // namespace sunfleck::command_line

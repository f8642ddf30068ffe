// The commands of the tool: what each takes from the command line (main.cpp) and what it does.
#pragma once

#include "editor/command_line/common.h"
#include "viewer/picture_settings.h"

namespace sunfleck::command_line {

struct RenderOptions {
    SceneOptions scene;
    std::string output;
    std::string view = "final";
    std::vector<std::string> settings;
    viewer::PictureSettings picture;
    std::string statistics;
    std::string trace; // file
    bool print_graph = false;
};
std::vector<std::string> view_names();
Status render(const RenderOptions& options);

// Of the path tracer and of all that it sees that is made by code (patterns, skies): raised with whatever makes its
// pictures differ, so that a saved state of the method before is not gone on with. A test has pictures of this one.
inline constexpr int reference_method = 4;

struct ReferenceOptions {
    SceneOptions scene;
    std::string output;
    std::uint32_t samples = 256;
    std::string view = "final";
    bool antialiasing = false;
    bool unlimited = false;
    bool lambertian = false;
    bool caustics = true;
    bool light_paths = false; // LightTracer in place of PathTracer
    std::string statistics;
    float save_interval = 30.0f; // s
};
Status reference(const ReferenceOptions& options);

struct CompareOptions {
    std::string a, b, difference;
    bool as_json = false;
};
Status compare(const CompareOptions& options);

struct BenchOptions {
    std::string suite, csv, plot, device, scene;
    std::string part;                      // of thesis and splatting, or preset of the suite picture; empty: all
    std::string folder;                    // of the suite picture: keeps what is finished
    std::uint32_t views = 8, samples = 64; // of the suite picture: views, and samples a pixel of the path tracer
    bool as_json = false;
    std::uint32_t repeat = 5;
    std::uint32_t memory_mib = 0; // that may be taken; 0: memory_limit's default
    std::uint32_t turns = 15;     // of contenders whose ratio is taken
};
// Names of the thesis's experiments, for BenchOptions::part.
std::vector<std::string> thesis_parts();
std::vector<std::string> picture_parts();
std::vector<std::string> splatting_parts();
Status bench(const BenchOptions& options);

Status describe_device(const std::string& wanted, bool as_json);
// What a scene file holds, and what its import leaves out.
Status describe_scene(const std::string& scene, bool allow_outside, bool as_json);

} // namespace sunfleck::command_line

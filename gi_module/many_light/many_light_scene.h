// What the many-light system lights, as its parts follow it.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/charts/curved_charts.h"
#include "gi_module/transport/light_row.h"
#include "gi_module/visibility/visibility_database.h"

#include <span>

namespace sunfleck::gi {

// What is lit, and by what.
struct ManyLightScene {
    VisibilityDatabase& database;
    const CurvedCharts& curved;
    const scene::GpuScene& gpu_scene;
    std::span<const LightSample> samples;
    std::span<const shared::LightRow> rows;
    bool strengths_wait = false; // more of them change in the next frames (SampleSet::late_changes)
};

} // namespace sunfleck::gi

#include "gi_module/light_composer.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t all_receivers = shared::receiver_fixed | shared::receiver_mover;

// Kinds of receivers that a technique lights.
std::uint32_t receivers_of(CellSet cells) {
    const CellSet on_mover = cells_where([](LightCell cell) { return cell.on_mover; });
    return ((cells & ~on_mover).any() ? shared::receiver_fixed : 0u) |
           ((cells & on_mover).any() ? shared::receiver_mover : 0u);
}

bool has_view(const TechniqueEntry& entry, const DebugView& view) {
    return std::any_of(entry.views.begin(), entry.views.end(),
                       [&](const DebugView& own) { return own.name == view.name; });
}

} // namespace

Result<std::unique_ptr<LightComposer>> LightComposer::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    auto composer = std::make_unique<LightComposer>();
    SUNFLECK_ASSIGN(composer->low_resolution_, LowResolution::create(device, pipelines));
    SUNFLECK_ASSIGN(composer->light_sum_, LightSum::create(device, pipelines));
    return composer;
}

std::vector<LightComposer::Part> LightComposer::parts_of(const LightPlan& plan, const DebugView* view) {
    std::vector<Part> parts;
    std::optional<std::size_t> shared; // the part of techniques that share sums
    for (std::size_t i = 0; i < techniques().size(); ++i) {
        const TechniqueEntry& entry = techniques()[i];
        const CellSet cells = plan.lit_by(std::int32_t(i));
        if (cells.none() || entry.lights_specular || (view != nullptr && !has_view(entry, *view)))
            continue;
        // What is shown is shown on all receivers.
        const std::uint32_t receivers = view != nullptr ? all_receivers : receivers_of(cells);
        const bool shares = entry.lights_pixels && receivers == all_receivers;
        if (shares && shared) {
            parts[*shared].techniques.push_back(i);
            continue;
        }
        if (shares)
            shared = parts.size();
        parts.push_back({{i}, receivers, entry.adds_in_place, entry.supports != nullptr});
    }
    return parts;
}

Status LightComposer::add_part(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> all,
                               const Part& part, Services& services, LightTarget& target) {
    std::vector<PixelLighting> contributors;
    LowResolutionFrame frame{target.g_buffer, target.camera, target.irradiance, services.input.serial,
                             services.input.completed_serial};
    frame.every_pixel = target.view != nullptr && target.view->every_pixel;
    for (const std::size_t i : part.techniques) {
        SUNFLECK_TRY(all[i]->add_passes(graph, services, target));
        frame.bytes_per_group = std::max(frame.bytes_per_group, target.bytes_per_group);
        if (techniques()[i].lights_pixels)
            contributors.emplace_back([&services, &technique = *all[i]](const PixelStage& stage) {
                return technique.light_pixels(stage, services);
            });
    }
    if (contributors.empty())
        return {};
    if (!services.input.light_pixels)
        return light_sum_->clear(graph, target.g_buffer, target.irradiance, services.resources);
    return low_resolution_->add_passes(graph, services.settings, frame, contributors, services.resources);
}

// The first part writes the picture, if it lights every receiver; the light of the others is added, by themselves or
// from a layer.
Status LightComposer::add_passes(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> all,
                                 const LightPlan& plan, Services& services, LightTarget target) {
    const gpu::ResourceId picture = target.irradiance;
    bool empty = true;
    for (const Part& part : parts_of(plan, target.view)) {
        target.area = {0, 0, target.g_buffer.width, target.g_buffer.height};
        target.irradiance = picture;
        target.holds_light = !empty;
        if ((empty || part.adds_in_place) && !part.replaces && part.receivers == all_receivers) {
            SUNFLECK_TRY(add_part(graph, all, part, services, target));
            empty = false;
            continue;
        }
        if (empty)
            SUNFLECK_TRY(light_sum_->clear(graph, target.g_buffer, picture, services.resources));
        empty = false;
        target.holds_light = false;
        target.irradiance =
            graph.create_image("light of " + std::string(techniques()[part.techniques.front()].name),
                               VK_FORMAT_R16G16B16A16_SFLOAT, target.g_buffer.width, target.g_buffer.height);
        SUNFLECK_TRY(add_part(graph, all, part, services, target));
        SUNFLECK_TRY(light_sum_->add(graph, target.gpu_scene, target.g_buffer,
                                     {target.irradiance, target.area, part.replaces, part.receivers}, picture,
                                     services.resources));
    }
    if (empty)
        SUNFLECK_TRY(light_sum_->clear(graph, target.g_buffer, picture, services.resources));
    target.irradiance = picture;
    return add_specular(graph, all, plan, services, target);
}

// Its techniques write only where they find something glossy: the rest, which is all when it lies beside the picture or
// behind the camera, has none.
Status LightComposer::add_specular(gpu::FrameGraph& graph, std::span<const std::unique_ptr<Technique>> all,
                                   const LightPlan& plan, Services& services, LightTarget& target) {
    if (!target.specular.valid())
        return {};
    light_sum_->set_to_zero(graph, target.specular);
    for (std::size_t i = 0; i < techniques().size() && target.view == nullptr; ++i)
        if (techniques()[i].lights_specular && plan.uses(std::int32_t(i)))
            SUNFLECK_TRY(all[i]->add_passes(graph, services, target));
    return {};
}

} // namespace sunfleck::gi

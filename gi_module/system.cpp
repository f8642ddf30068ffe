#include "gi_module/system.h"

#include "engine/core/progress_part.h"
#include "gi_module/inspection/visibility_listing.h"
#include "gi_module/light_part_views.h"

#include <cmath>
#include <string>
#include <utility>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr float until_samples = 0.1f; // of FrameInput::progress; visibility takes most of the rest

// Where a camera stands: of all points, the one that has no x, y and w in clip space. None without perspective.
std::optional<vec3> eye_of(const std::optional<mat4>& view_projection) {
    if (!view_projection)
        return std::nullopt;
    const vec4 eye = glm::inverse(*view_projection) * vec4(0.0f, 0.0f, 1.0f, 0.0f);
    const vec3 position = vec3(eye) / eye.w;
    return std::isfinite(glm::dot(position, position)) ? std::optional(position) : std::nullopt;
}

} // namespace

std::vector<gpu::EmbeddedShader> shaders() {
    std::vector<gpu::EmbeddedShader> result;
    const auto add = [&](std::span<const gpu::EmbeddedShader> part) {
        result.insert(result.end(), part.begin(), part.end());
    };
    add(gpu::sunfleck_gi_shaders());
    for (const TechniqueEntry& technique : techniques())
        if (technique.shaders != nullptr)
            add(technique.shaders());
    return result;
}

Result<std::unique_ptr<System>> System::create(gpu::Device& device, gpu::PipelineStore& pipelines) {
    std::unique_ptr<System> system(new System(device));
    SUNFLECK_ASSIGN(system->shadows_, ShadowService::create(device, pipelines));
    SUNFLECK_ASSIGN(system->composer_, LightComposer::create(device, pipelines));
    for (const TechniqueEntry& entry : techniques()) {
        SUNFLECK_ASSIGN(std::unique_ptr<Technique> technique, entry.create(device, pipelines));
        system->techniques_.push_back(std::move(technique));
    }
    system->restarts_.resize(system->techniques_.size());
    SUNFLECK_ASSIGN(system->plan_, system->settings_.light_plan());
    system->shown_ = system->plan_;
    return system;
}

System::~System() = default;

Status System::set_settings(const Settings& settings) {
    SUNFLECK_TRY(settings.validate());
    SUNFLECK_ASSIGN(plan_, settings.light_plan());
    shown_ = plan_;
    Settings known = settings_; // the budget of a frame asks for nothing to be made again
    known.map_budget = settings.map_budget;
    if (known != settings)
        ++settings_generation_;
    settings_ = settings;
    return {};
}

Technique* System::technique(std::string_view name) {
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        if (techniques()[i].name == name)
            return techniques_[i].get();
    return nullptr;
}

// Whether a technique in use requests something of the shared rooms.
bool System::any_in_use(bool TechniqueEntry::*request) const {
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        if (techniques()[i].*request && plan_.uses(std::int32_t(i)))
            return true;
    return false;
}

// Specular light is only that of glossy surfaces.
CellSet System::cells_with_maps(const scene::GpuScene& gpu_scene) const {
    CellSet cells;
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        if (techniques()[i].reads_maps && (!techniques()[i].lights_specular || gpu_scene.has_glossy_surfaces()))
            cells |= plan_.lit_by(std::int32_t(i));
    return cells;
}

bool System::wants_visibility() const {
    return settings_.kept_maps || any_in_use(&TechniqueEntry::wants_visibility);
}

Services System::services() {
    VisibilityDatabase* database = wants_visibility() ? &visibility_.database() : nullptr;
    return {settings_, input_, samples_, *shadows_, database, resources_, restart_, cache_folder_, cpu_times_};
}

Status System::update(ecs::Registry& registry, const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                      const scene::GpuScene& gpu_scene, const raytrace::RayScene& rays, const FrameInput& input) {
    cpu_times_.clear();
    input_ = input;
    restart_ = !recorded_ || input.previous_frame_lost;
    recorded_ = false;
    if (restart_)
        restarts_.assign(techniques_.size(), 1);
    if (input.previous_frame_lost)
        composer_->drop_last_counts();
    shadows_->begin_frame(restart_);
    resources_.begin_frame(input.serial, input.completed_serial);
    SUNFLECK_TRY(find_view());
    const SceneView scene{registry, changes, meshes, gpu_scene, rays};
    SUNFLECK_TRY(update_samples(scene));
    // Kept samples keep what was found for them.
    const bool static_changed = !samples_.outdated() && geometry_generation_ != rays.static_generation();
    if (!samples_.outdated())
        geometry_generation_ = rays.static_generation();
    SUNFLECK_TRY(make_rows(scene, static_changed));
    SUNFLECK_TRY(update_visibility(scene, static_changed));
    {
        const StageTimer timer(cpu_times_, "shadow scheduling");
        shadows_->measured(input.measured_serial, input.measured_map_milliseconds);
        shadows_->schedule(samples_, {gpu_scene, services().visibility, input.serial, input.map_budget,
                                      input.view_projection, cells_with_maps(gpu_scene), input.milliseconds});
    }
    SUNFLECK_TRY(update_techniques(scene));
    input_.progress = {}; // what it refers to may end with this call
    return {};
}

// A view is its owner's while that lights something.
Status System::find_view() {
    view_ = nullptr;
    shown_ = plan_;
    if (input_.view.empty())
        return {};
    for (const DebugView& view : light_part_views())
        if (view.name == input_.view) {
            shown_ = plan_.part(cells_of(view));
            return {};
        }
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        for (const DebugView& view : techniques()[i].views)
            if (view.name == input_.view) {
                view_ = &view;
                if (plan_.uses(std::int32_t(i)))
                    return {};
                return Error{"view '" + std::string(view.name) + "' belongs to " + std::string(techniques()[i].name) +
                             ", which lights nothing here"};
            }
    return Error{"there is no view '" + std::string(input_.view) + "'"};
}

std::vector<ExplainedLight> System::explain(const ReceiverPoint& point, const raytrace::RayScene& rays) const {
    const CellSet received =
        cells_where([&](LightCell cell) { return cell.on_mover == point.on_mover && !cell.specular; });
    std::vector<ExplainedLight> result;
    for (std::size_t i = 0; i < techniques_.size(); ++i) {
        const CellSet cells = plan_.lit_by(std::int32_t(i)) & received;
        if (cells.none())
            continue;
        ExplainedLight part{techniques()[i].name};
        if (auto shares = techniques_[i]->explain({point, rays, samples_, cells, settings_.shadows})) {
            part.divided = true;
            part.shares = std::move(*shares);
        }
        result.push_back(std::move(part));
    }
    return result;
}

Status System::draw_overlay(std::string_view name, OverlayLines& lines) {
    const Services shared = services();
    for (const Overlay& overlay : shared_overlays())
        if (overlay.name == name) {
            draw_shared_overlay(overlay.code, samples_, shared.visibility, lines);
            return {};
        }
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        for (const Overlay& overlay : techniques()[i].overlays)
            if (overlay.name == name) {
                if (plan_.uses(std::int32_t(i)))
                    techniques_[i]->draw_overlay(overlay, shared, lines);
                return {};
            }
    return Error{"there is no overlay '" + std::string(name) + "'"};
}

Result<ListingContent> System::fill_listing(std::string_view name, const ListedPlace* place) {
    const auto named = [&](const Listing& listing) { return listing.name == name; };
    const auto lacks_place = [&](const Listing& listing) { return listing.of_place && place == nullptr; };
    const ListingContent no_place{"Choose a place in the picture", {}};
    for (const Listing& listing : ShadowService::listings())
        if (named(listing))
            return shadows_->list_maps(samples_);
    for (const Listing& listing : visibility_listings())
        if (named(listing))
            return lacks_place(listing)
                       ? no_place
                       : list_visibility(services().visibility, samples_, place->entity, place->point.on_mover,
                                         place->point.position, place->point.geometric_normal);
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        for (const Listing& listing : techniques()[i].listings)
            if (named(listing)) {
                if (!plan_.uses(std::int32_t(i)))
                    return ListingContent{std::string(techniques()[i].name) + " lights nothing here", {}};
                return lacks_place(listing) ? no_place : techniques_[i]->fill_listing(listing, services(), place);
            }
    return Error{"there is no listing '" + std::string(name) + "'"};
}

Status System::act(std::string_view name, std::uint32_t action, std::uint32_t key, bool on) {
    for (const Listing& listing : ShadowService::listings())
        if (listing.name == name) {
            shadows_->act(action, key, on);
            return {};
        }
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        for (const Listing& listing : techniques()[i].listings)
            if (listing.name == name) {
                techniques_[i]->act(listing, action, key, on);
                return {};
            }
    return Error{"nothing can be done to rows of '" + std::string(name) + "'"};
}

Status System::update_samples(const SceneView& scene) {
    const StageTimer timer(cpu_times_, "light samples");
    return samples_.update(scene, settings_.sample_request(plan_), settings_,
                           {restart_, input_.keep_samples, progress_part(input_.progress, 0.0f, until_samples)});
}

Status System::make_rows(const SceneView& scene, bool static_changed) {
    const StageTimer timer(cpu_times_, "light samples");
    const MapPolicy policy{wants_visibility(), any_in_use(&TechniqueEntry::needs_full_maps)};
    SUNFLECK_TRY(shadows_->configure(settings_, policy, samples_.size(), resources_));
    samples_.update_rows(scene, settings_, shadows_->slots(),
                         {input_.indirect_scale, input_.strength_budget, eye_of(input_.view_projection)});
    shadows_->follow(samples_, static_changed);
    return {};
}

Status System::update_visibility(const SceneView& scene, bool static_changed) {
    if (!wants_visibility()) {
        visibility_.forget();
        return {};
    }
    const StageTimer timer(cpu_times_, "visibility");
    const auto lit_elsewhere = [&](const scene::DrawItem& item) {
        for (std::size_t i = 0; i < techniques_.size(); ++i)
            if (const TechniqueEntry& entry = techniques()[i]; entry.supports != nullptr &&
                                                               plan_.uses(std::int32_t(i)) &&
                                                               entry.supports(item, scene.registry, scene.meshes))
                return true;
        return false;
    };
    SUNFLECK_TRY(visibility_.update(
        settings_, {scene.registry, scene.changes, scene.meshes, scene.gpu_scene, samples_.samples(),
                    samples_.generation(), samples_.moved(), static_changed, lit_elsewhere, settings_generation_,
                    progress_part(input_.progress, until_samples, 1.0f), cpu_times_, max_buffer_bytes_}));
    return {};
}

Status System::update_techniques(const SceneView& scene) {
    Services shared = services();
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        if (const CellSet cells = shown_.lit_by(std::int32_t(i)); cells.any()) {
            shared.restart = std::exchange(restarts_[i], std::uint8_t(0)) != 0;
            SUNFLECK_TRY(techniques_[i]->update(scene, shared, cells));
        }
    return {};
}

Result<gpu::ResourceId> System::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene,
                                           const GBufferInput& g_buffer, const gpu::UploadSlice& camera,
                                           VkFormat output_format) {
    const gpu::ResourceId output = graph.create_image("irradiance", output_format, g_buffer.width, g_buffer.height);
    SUNFLECK_TRY(add_passes(graph, gpu_scene, g_buffer, camera, output));
    return output;
}

Status System::add_passes(gpu::FrameGraph& graph, const scene::GpuScene& gpu_scene, const GBufferInput& g_buffer,
                          const gpu::UploadSlice& camera, gpu::ResourceId output, gpu::ResourceId specular) {
    const StageTimer timer(cpu_times_, "light lists");
    if (restart_)
        graph.add_full_barrier();
    if (!shadows_->slots_are_shared(samples_.size()))
        SUNFLECK_TRY(shadows_->add_passes(graph, gpu_scene, samples_, input_.light_pixels, resources_));
    Services shared = services();
    LightTarget target{gpu_scene, g_buffer, camera, output};
    target.view = view_;
    target.specular = specular;
    SUNFLECK_TRY(composer_->add_passes(graph, techniques_, shown_, shared, target));
    graph.when_executed([this] { recorded_ = true; });
    make_report();
    return {};
}

void System::make_report() {
    report_.clear();
    samples_.report(report_);
    shadows_->report(report_);
    if (wants_visibility())
        visibility_.report(report_);
    composer_->report(report_);
    for (std::size_t i = 0; i < techniques_.size(); ++i)
        if (shown_.uses(std::int32_t(i)))
            techniques_[i]->report(report_);
}

} // namespace sunfleck::gi

#include "gi_module/adaptive_shadows/adaptive_shadows_technique.h"

#include "gi_module/adaptive_shadows/receiver_cells.h"
#include "gi_module/shadows/light_batches.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gpu {
std::span<const EmbeddedShader> sunfleck_gi_adaptive_shadows_shaders();
}

namespace sunfleck::gi {
namespace {

constexpr Counter punctual_lights{"punctual_lights", "lights", "punctual light",
                                  "Suns, point lights and spots with adaptive shadow maps"};
constexpr Counter tiles_needed{"shadow_tiles", "tiles", "punctual light",
                               "Tiles of shadow maps that the picture needs"};
constexpr Counter tiles_drawn{"shadow_tile_updates", "tiles", "punctual light", "Tiles drawn in this frame"};
constexpr Counter tiles_stale{"shadow_tiles_stale", "tiles", "punctual light",
                              "Tiles that are still missing or stale after this frame"};
constexpr Counter tile_memory{"shadow_tile_maps", "B", memory_group, "Tiles of shadow maps, including static parts"};
constexpr Counter technique_counters[] = {punctual_lights, tiles_needed, tiles_drawn, tiles_stale, tile_memory};

std::uint32_t map_kind(const shared::LightRow& row, std::uint32_t light_class) {
    if (light_class == shared::light_class_directional)
        return shared::map_of_directions;
    return row.position_bound.w > 0.0f ? shared::map_of_cone : shared::map_of_sphere;
}

} // namespace

const TypeDescription& AdaptiveShadowsSettings::description() {
    using S = AdaptiveShadowsSettings;
    static const TypeDescription type{
        "AdaptiveShadowsSettings",
        1,
        "Sharp shadows of suns, point lights and spots.",
        {SUNFLECK_FIELD(S, shadow_detail, "texels", 0.05, 4,
                        "Texels of a shadow map for each pixel, along a side: less is blurred, and faster where the "
                        "camera or things move"),
         SUNFLECK_FIELD(S, shadow_tile_memory, "MiB", 8, 65536,
                        "Limit of the memory of shadow map tiles; where it does not suffice, all are coarser"),
         SUNFLECK_FIELD(S, moving_light_tiles, "tiles", 1, 1024,
                        "Tiles of a light that moves, all of which are drawn in each frame")}};
    return type;
}

const TechniqueEntry& adaptive_shadows_technique();
const TechniqueEntry& adaptive_shadows_technique() {
    static const TechniqueEntry entry{
        .name = "adaptive_shadows",
        .tooltip = "Suns, point lights and spots at every pixel, with about a texel of shadow map a pixel",
        .can_light = cells_where([](LightCell cell) { return cell.path == PathPart::punctual && !cell.specular; }),
        .reads_maps = false,
        .adds_in_place = true,
        .settings = settings_of<AdaptiveShadowsSettings>(),
        .counters = technique_counters,
        .listings = AdaptiveShadowsTechnique::listings(),
        .shaders = gpu::sunfleck_gi_adaptive_shadows_shaders,
        .create = AdaptiveShadowsTechnique::create,
    };
    return entry;
}

Result<std::unique_ptr<Technique>> AdaptiveShadowsTechnique::create(gpu::Device& device,
                                                                    gpu::PipelineStore& pipelines) {
    auto technique = std::make_unique<AdaptiveShadowsTechnique>();
    SUNFLECK_ASSIGN(technique->maps_, ShadowMaps::create(device, pipelines,
                                                         {.maps = "shadow tiles",
                                                          .copies = "shadow tile copies",
                                                          .static_maps = "static shadow tiles",
                                                          .staging = "shadow tile staging"}));
    SUNFLECK_ASSIGN(technique->kernel_, PunctualKernel::create(device, pipelines));
    return std::unique_ptr<Technique>(std::move(technique));
}

bool AdaptiveShadowsTechnique::lit(const Light& light) {
    const vec4& intensity = light.row.intensity_slot;
    return intensity.x + intensity.y + intensity.z > 0.0f;
}

Status AdaptiveShadowsTechnique::update(const SceneView& scene, Services& services, CellSet cells) {
    const StageTimer timer(services.cpu_times, "shadow tiles");
    maps_->begin_frame(services.restart);
    if (services.restart)
        store_.lose_last();
    drawn_ = {};
    stale_ = 0;
    follow_receivers(scene);
    follow_lights(services, cells);
    if (lights_.empty())
        return {};
    SUNFLECK_TRY(configure_maps(services, scene.gpu_scene));
    follow_movers(scene.gpu_scene);
    return {};
}

// Movers are drawn over kept static parts, if there are any.
Status AdaptiveShadowsTechnique::configure_maps(const Services& services, const scene::GpuScene& gpu_scene) {
    keep_static_ = std::any_of(gpu_scene.draws().begin(), gpu_scene.draws().end(),
                               [](const scene::DrawItem& item) { return !item.is_static && item.casts_shadow; });
    MapLayout layout;
    layout.resolution = shared::tile_side;
    layout.bits = 32;
    layout.memory_bytes =
        std::uint64_t(double(services.settings.of<AdaptiveShadowsSettings>().shadow_tile_memory) * 1048576.0);
    layout.wanted = std::uint32_t(layout.memory_bytes / (shared::tile_side * shared::tile_side * 4u));
    layout.keep_static = keep_static_;
    SUNFLECK_ASSIGN(const bool lost, maps_->configure(layout, services.resources));
    if (lost)
        store_.reset(maps_->slots());
    return {};
}

void AdaptiveShadowsTechnique::follow_receivers(const SceneView& scene) {
    if (geometry_generation_ == scene.rays.static_generation())
        return;
    geometry_generation_ = scene.rays.static_generation();
    receivers_ = receiver_cells(scene.changes, scene.meshes);
    store_.reset(store_.slots());
    selected_ = false;
    lights_.clear();
}

// A light's tiles last while it stays where it is. If lights come or go, all tiles are drawn again.
void AdaptiveShadowsTechnique::follow_lights(const Services& services, CellSet cells) {
    std::vector<Light> now;
    const SampleSet& samples = services.samples;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        if (sample.punctual && owns_sample(cells, sample))
            now.push_back({sample.emitter, i, samples.light_class_of(i), samples.rows()[i], false, {}});
    }
    const bool same_lights =
        std::equal(now.begin(), now.end(), lights_.begin(), lights_.end(), [](const Light& a, const Light& b) {
            return a.emitter == b.emitter && a.light_class == b.light_class;
        });
    if (!same_lights) {
        store_.reset(store_.slots());
        selected_ = false;
    }
    for (std::uint32_t i = 0; same_lights && i < now.size(); ++i) {
        // Of a row, all but intensity and slot decide what is in the map.
        shared::LightRow before = lights_[i].row;
        before.intensity_slot = now[i].row.intensity_slot;
        now[i].moved = std::memcmp(&before, &now[i].row, sizeof before) != 0;
        if (now[i].moved)
            store_.outdate(i);
        else
            now[i].places = std::move(lights_[i].places);
        selected_ = selected_ && !now[i].moved && !lights_[i].moved && lit(now[i]) == lit(lights_[i]);
    }
    lights_ = std::move(now);
}

ShadowRequest AdaptiveShadowsTechnique::request_of(const TileKey& key) const {
    ShadowRequest request;
    request.light_class = lights_[key.light].light_class;
    request.light = lights_[key.light].row;
    request.tile = tile_on_map(key);
    return request;
}

// Movers receive shadows like all else, and those that moved change the tiles where they were and where they are.
void AdaptiveShadowsTechnique::follow_movers(const scene::GpuScene& gpu_scene) {
    std::vector<Bounds> affected(gpu_scene.removed_bounds().begin(), gpu_scene.removed_bounds().end());
    movers_.clear();
    for (const scene::DrawItem& item : gpu_scene.draws()) {
        if (item.is_static)
            continue;
        movers_.push_back(item.bounds);
        selected_ = selected_ && !item.moved;
        if (!item.moved || !item.casts_shadow)
            continue;
        affected.push_back(item.bounds);
        if (!item.previous_bounds.empty())
            affected.push_back(item.previous_bounds);
    }
    selected_ = selected_ && affected.empty();
    if (!affected.empty())
        store_.mark([&](const TileKey& key) {
            return std::any_of(affected.begin(), affected.end(),
                               [&](const Bounds& bounds) { return maps_->covers(request_of(key), bounds); });
        });
}

std::vector<std::optional<float>> AdaptiveShadowsTechnique::pixel_sides(const Services& services,
                                                                        std::uint32_t height) const {
    Bounds scene;
    for (const Bounds& receiver : receivers_)
        scene.add(receiver);
    // Without a camera: as if a thousand pixels showed the whole scene.
    std::vector<std::optional<float>> pixels(receivers_.size() + movers_.size(), glm::length(scene.extent()) / 1000.0f);
    if (!services.input.view_projection)
        return pixels;
    const TileView view(*services.input.view_projection, height);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = view.pixel_side(i < receivers_.size() ? receivers_[i] : movers_[i - receivers_.size()]);
    return pixels;
}

// Coarser until there is memory for all. Of a light that moves, only the receivers that are seen are placed on its map.
std::vector<TileKey> AdaptiveShadowsTechnique::tiles_of(std::uint32_t index,
                                                        std::span<const std::optional<float>> pixels,
                                                        const Selection& selection) {
    Light& light = lights_[index];
    const auto place = [&](std::uint32_t first, std::span<const Bounds> boxes, bool all) {
        std::vector<ReceiverPlace> places;
        for (std::uint32_t i = 0; i < boxes.size(); ++i)
            if (all || pixels[first + i])
                add_places(light.row, light.light_class, first + i, boxes[i], places);
        return places;
    };
    if (light.places.empty() || light.moved)
        light.places = place(0, receivers_, !light.moved);
    const std::vector<ReceiverPlace> moving = place(std::uint32_t(receivers_.size()), movers_, false);
    // What is seen of a moving light lies in finer tiles: the whole map is not worth drawing in each frame.
    const TileDemand demand{{light.places, moving}, pixels, selection.detail, !light.moved};
    std::size_t most = selection.slots / lights_.size();
    if (light.moved)
        most = std::min<std::size_t>(most, selection.moving_light_tiles);
    std::vector<TileKey> tiles;
    for (float coarser = 0.0f; coarser <= float(shared::tile_levels); coarser += 0.5f) {
        tiles = needed_tiles(index, demand, coarser);
        if (tiles.size() <= most)
            break;
    }
    tiles.resize(std::min(tiles.size(), most));
    if (light.moved)
        light.places.clear(); // they are those of what is seen now
    return tiles;
}

// Nothing to do while camera and world stand still.
void AdaptiveShadowsTechnique::select_tiles(const Services& services, std::uint32_t height) {
    const auto& settings = services.settings.of<AdaptiveShadowsSettings>();
    const Selection selection{services.input.view_projection.value_or(mat4(0.0f)), height, settings.shadow_detail,
                              settings.moving_light_tiles, store_.slots()};
    if (selected_ && selection == selection_)
        return;
    selected_ = true;
    selection_ = selection;
    const std::vector<std::optional<float>> pixels = pixel_sides(services, height);
    needed_.clear();
    for (std::uint32_t light = 0; light < lights_.size(); ++light) {
        if (!lit(lights_[light]))
            continue;
        const std::vector<TileKey> tiles = tiles_of(light, pixels, selection);
        needed_.insert(needed_.end(), tiles.begin(), tiles.end());
    }
    std::stable_sort(needed_.begin(), needed_.end(),
                     [](const TileKey& a, const TileKey& b) { return a.level < b.level; });
}

// The host's budget holds for maps of all techniques; that of the settings for those that movers make stale.
Status AdaptiveShadowsTechnique::draw_tiles(gpu::FrameGraph& graph, Services& services, const LightTarget& target) {
    const StageTimer timer(services.cpu_times, "shadow tiles");
    select_tiles(services, target.g_buffer.height);
    const std::size_t others = services.shadows.to_draw().size();
    const std::size_t budget = services.input.map_budget - std::min<std::size_t>(services.input.map_budget, others);
    const auto moves = [&](std::uint32_t light) { return lights_[light].moved; };
    std::vector<ShadowRequest> lasting, moving;
    for (const TileStore::Drawing& drawing :
         store_.draw(needed_, {std::uint32_t(budget), services.settings.map_budget}, moves)) {
        ShadowRequest request = request_of(drawing.key);
        request.slot = drawing.slot;
        request.redraw_static = drawing.redraw_static;
        request.detail_texels = direct_detail_texels;
        if (services.visibility != nullptr)
            request.hidden = services.visibility->hidden_entities(lights_[drawing.key.light].sample);
        (drawing.whole ? moving : lasting).push_back(std::move(request));
    }
    stale_ = store_.stale();
    const MapOptions kept{.keep_static = keep_static_, .detail = services.settings.map_detail};
    const MapOptions whole{.detail = services.settings.map_detail, .detail_of_all = true};
    for (const auto& [requests, options] : {std::pair(&lasting, kept), std::pair(&moving, whole)})
        if (!requests->empty())
            SUNFLECK_TRY(maps_->add_passes(graph, target.gpu_scene, services.resources, *requests, options, drawn_));
    return {};
}

// The finest tile of each cell that there is.
shared::TileLight AdaptiveShadowsTechnique::make_table(std::uint32_t light, std::vector<std::uint32_t>& table) const {
    shared::TileLight result{lights_[light].row, std::uint32_t(table.size()), 1, 0, 0};
    for (const TileKey& key : needed_)
        if (key.light == light)
            result.table_side = std::max(result.table_side, 1u << key.level);
    table.resize(table.size() + std::size_t(result.table_side) * result.table_side);
    for (const TileKey& key : needed_) { // coarse ones first
        const std::optional<std::uint32_t> slot = key.light == light ? store_.slot_of(key) : std::nullopt;
        if (!slot)
            continue;
        const std::size_t cells = result.table_side >> key.level;
        for (std::size_t y = key.y * cells; y < (key.y + 1) * cells; ++y)
            std::fill_n(&table[result.table_first + y * result.table_side + key.x * cells], cells,
                        (*slot + 1u) | (key.level << shared::tile_level_shift));
    }
    return result;
}

std::vector<PunctualBatch> AdaptiveShadowsTechnique::make_batches(std::vector<std::uint32_t>& table) const {
    std::vector<PunctualBatch> batches;
    for (std::uint32_t light = 0; light < lights_.size(); ++light) {
        if (!lit(lights_[light]))
            continue;
        if (batches.empty() || batches.back().lights.size() == shared::lights_per_pass)
            batches.emplace_back();
        PunctualBatch& batch = batches.back();
        batch.kind_lights[map_kind(lights_[light].row, lights_[light].light_class)] |= 1u << batch.lights.size();
        batch.lights.push_back(make_table(light, table));
    }
    return batches;
}

Status AdaptiveShadowsTechnique::add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) {
    const bool dark = std::none_of(lights_.begin(), lights_.end(), lit);
    if (dark && target.holds_light)
        return {};
    const bool shadows = services.settings.shadows && !dark;
    if (shadows)
        SUNFLECK_TRY(draw_tiles(graph, services, target));
    std::vector<std::uint32_t> table;
    std::vector<PunctualBatch> batches;
    if (!dark)
        batches = make_batches(table);
    if (batches.empty())
        batches.emplace_back();
    if (table.empty())
        table.push_back(0);
    return kernel_->add_passes({graph, target.g_buffer, target.camera, shadows ? &maps_->texels() : nullptr,
                                target.irradiance, target.holds_light},
                               batches, table, services.resources);
}

void AdaptiveShadowsTechnique::report(Report& report) const {
    report.set(punctual_lights, double(lights_.size()));
    report.set(tiles_needed, lights_.empty() ? 0.0 : double(needed_.size()));
    report.set(tiles_drawn, double(drawn_.maps));
    report.set(tiles_stale, double(stale_));
    report.set(tile_memory, double(maps_->texels().size() + maps_->static_texels().size()));
}

} // namespace sunfleck::gi

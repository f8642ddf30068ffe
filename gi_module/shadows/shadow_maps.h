// Octahedral shadow maps of light samples (VPLs): their storage and the passes that redraw them. Thesis sec. 4.2. All
// maps lie in one texel buffer, slot after slot, row after row; they are drawn as layers of a depth image, many at
// once, and copied over.
#pragma once

#include "engine/scene/gpu_scene.h"
#include "gi_module/shadows/map_area.h"
#include "gi_module/shadows/shadow_map_shared.h"
#include "gi_module/shadows/shadow_settings.h"
#include "gi_module/transport/light_row.h"

#include "engine/gpu/frame_graph.h"

#include <bit>
#include <memory>
#include <span>

namespace sunfleck::gi {

// Largest error of simplified surfaces in maps of direct light, in texels: such shadows show their outline.
inline constexpr float direct_detail_texels = 0.35f;

// One map to draw, or a tile of one.
struct ShadowRequest {
    std::uint32_t slot = 0;
    std::uint32_t light_class = 0;
    shared::LightRow light;
    bool redraw_static = true; // the static part is stale, too
    // Largest error of a mover's simplified surface, in texels.
    float detail_texels = 0.5f;
    std::vector<std::uint8_t> hidden; // by entity index: 1 for occluders that cast no shadow of their own because
                                      // static geometry hides them from the light; may be shorter
    MapTile tile{};
    bool has_cone_map() const { return light_class == shared::light_class_point && light.position_bound.w > 0.0f; }
    bool hides(ecs::Entity entity) const { return entity.index < hidden.size() && hidden[entity.index] != 0; }
};

struct MapLayout {
    std::uint32_t resolution = 256;
    std::uint32_t bits = 16;
    std::uint32_t wanted = 0;       // maps
    std::uint64_t memory_bytes = 0; // limit for all layers together
    bool keep_static = false;       // a second layer per map, with static geometry only
    bool shrink = false;            // lower the resolution rather than the number of maps
    bool operator==(const MapLayout&) const = default;
};

struct MapOptions {
    bool keep_static = false;   // draw movers over the static layer
    bool detail = false;        // draw movers with only as much detail as texels resolve
    bool detail_of_all = false; // and, where nothing is kept, static geometry, too
};

struct ShadowCounters {
    std::uint64_t maps = 0;     // drawn
    std::uint64_t faces = 0;    // with at least one occluder
    std::uint64_t draws = 0;    // draw calls (indirect commands count as one call)
    std::uint64_t vertices = 0; // shaded, by the size of the meshes
};

// Of passes and memory, as profilers and reports show them.
struct MapNames {
    const char* maps = "shadow maps";
    const char* copies = "shadow map copies";
    const char* static_maps = "static shadow maps";
    const char* staging = "shadow map staging";
};

class ShadowMaps {
public:
    static Result<std::unique_ptr<ShadowMaps>> create(gpu::Device& device, gpu::PipelineStore& pipelines,
                                                      const MapNames& names = {});

    // Starts a frame. `previous_lost`: what was added since the last call never reached the GPU, or not all of it.
    void begin_frame(bool previous_lost);

    // Sets resolution, bits and number of slots. Returns true if any of them changed: the content of all maps is then
    // lost. The number of slots is limited by the request, the memory and the device; with `shrink`, the resolution is
    // lowered instead.
    Result<bool> configure(const MapLayout& layout, gpu::FrameResources& resources);

    std::uint32_t slots() const { return slots_; }
    std::uint32_t resolution() const { return resolution_; }
    std::uint32_t bits() const { return bits_; }
    const gpu::Buffer& texels() const { return texels_; }
    // Static geometry only; empty unless it is kept.
    const gpu::Buffer& static_texels() const { return static_texels_; }

    // Adds passes that draw the requested maps with everything in `scene` as occluders. Faces without occluders are
    // left empty without being drawn.
    Status add_passes(gpu::FrameGraph& graph, const scene::GpuScene& scene, gpu::FrameResources& resources,
                      std::span<const ShadowRequest> requests, const MapOptions& options, ShadowCounters& counters);

    // Adds a pass after which the maps, and their static parts, let no light through.
    void add_clearing(gpu::FrameGraph& graph, std::span<const std::uint32_t> slots);

    // A bit per face: set if the box may be visible in it. For directional lights only bit 0.
    // Whether the box may have a part in the map, or in the tile of it.
    bool covers(const ShadowRequest& request, const Bounds& bounds) const {
        return part_covered(request, bounds, false).faces != 0;
    }
    static std::uint32_t faces_that_see(const ShadowRequest& request, const Bounds& bounds);

private:
    ShadowMaps(gpu::Device& device, const MapNames& names) : device_(device), names_(names) {}
    struct Chunk;
    struct ChunkPart;
    // What a box may cover of a map: faces, and texels (none if no face).
    struct MapPart {
        std::uint32_t faces = 0;
        MapArea area;
    };
    enum class Occluders { all, static_only, movers };
    void add_item(const scene::DrawItem& item, std::span<const ShadowRequest> requests, Occluders occluders,
                  bool detail, ChunkPart& part) const;
    Result<Chunk> prepare_chunk(const scene::GpuScene& scene, gpu::FrameResources& resources,
                                std::span<const ShadowRequest> requests, Occluders occluders, bool detail,
                                ShadowCounters& counters) const;
    void find_copied_areas(std::span<const ShadowRequest> requests, bool over_static, Chunk& chunk);
    std::size_t detail_level(const ShadowRequest& request, const scene::DrawItem& item) const;
    MapPart part_covered(const ShadowRequest& request, const Bounds& bounds, bool wants_area) const;
    static bool shows_front_faces_only(const ShadowRequest& request, const scene::DrawItem& item);
    std::size_t maps_of_a_pass(const scene::GpuScene& scene, Occluders occluders) const;
    Status add_drawing(gpu::FrameGraph& graph, const scene::GpuScene& scene, const Chunk& chunk,
                       const gpu::Buffer& target, bool over_static);
    Status draw_chunk(gpu::PassContext& context, const scene::GpuScene& scene, const Chunk& chunk, bool load) const;
    Status draw_holes(gpu::PassContext& context, const scene::GpuScene& scene, const Chunk& chunk) const;
    void fill_slots(gpu::PassContext& context, std::span<const std::uint32_t> slots, const gpu::Buffer& texels) const;
    Status copy_chunk(gpu::PassContext& context, const Chunk& chunk, const gpu::Buffer& buffer, bool to_buffer) const;

    gpu::Device& device_;
    const MapNames names_;
    const gpu::Pipeline* pipelines16_[2] = {}; // both sides of triangles; sides that face the light
    const gpu::Pipeline* pipelines32_[2] = {};
    const gpu::Pipeline* hole_pipelines_[2] = {}; // 16 bits, 32 bits
    gpu::Buffer texels_, static_texels_;
    std::vector<MapAreas> movers_shown_; // by slot: where the map may differ from its static part
    std::vector<std::pair<std::uint32_t, MapAreas>> shown_before_; // slots drawn in this frame
    MapLayout layout_;
    gpu::Image staging_;
    std::uint32_t resolution_ = 0, bits_ = 0, slots_ = 0, layers_ = 0;
};

} // namespace sunfleck::gi

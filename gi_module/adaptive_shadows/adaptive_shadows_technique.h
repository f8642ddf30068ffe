// Punctual light with adaptive shadow maps, as a technique of gi::System: `adaptive_shadows`.
#pragma once

#include "gi_module/adaptive_shadows/adaptive_shadows_settings.h"
#include "gi_module/adaptive_shadows/punctual_kernel.h"
#include "gi_module/adaptive_shadows/tile_store.h"
#include "gi_module/technique.h"

namespace sunfleck::gi {

class AdaptiveShadowsTechnique final : public Technique {
public:
    static Result<std::unique_ptr<Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines);

    Status update(const SceneView& scene, Services& services, CellSet cells) override;
    Status add_passes(gpu::FrameGraph& graph, Services& services, LightTarget& target) override;
    void report(Report& report) const override;
    static std::span<const Listing> listings();
    ListingContent fill_listing(const Listing& listing, const Services& services,
                                const ListedPlace* place) const override;
    void act(const Listing& listing, std::uint32_t action, std::uint32_t key, bool on) override;
    std::optional<std::vector<LightShare>> explain(const PointQuestion& question) const override {
        return sample_shares(question);
    }

private:
    struct Light {
        ecs::Entity emitter;
        std::uint32_t sample = 0; // of this frame's light samples
        std::uint32_t light_class = 0;
        shared::LightRow row;
        bool moved = false;                // in this frame
        std::vector<ReceiverPlace> places; // of receivers_; empty until the light rests
    };

    static bool lit(const Light& light);
    void follow_lights(const Services& services, CellSet cells);
    void follow_receivers(const SceneView& scene);
    void follow_movers(const scene::GpuScene& gpu_scene);
    Status configure_maps(const Services& services, const scene::GpuScene& gpu_scene);
    // What decides which tiles are needed, beside the scene.
    struct Selection {
        mat4 view_projection{0.0f};
        std::uint32_t height = 0;
        float detail = 0.0f;
        std::uint32_t moving_light_tiles = 0, slots = 0;
        bool operator==(const Selection&) const = default;
    };
    std::vector<std::optional<float>> pixel_sides(const Services& services, std::uint32_t height) const;
    void select_tiles(const Services& services, std::uint32_t height);
    std::vector<TileKey> tiles_of(std::uint32_t light, std::span<const std::optional<float>> pixels,
                                  const Selection& selection);
    Status draw_tiles(gpu::FrameGraph& graph, Services& services, const LightTarget& target);
    std::vector<PunctualBatch> make_batches(std::vector<std::uint32_t>& table) const;
    shared::TileLight make_table(std::uint32_t light, std::vector<std::uint32_t>& table) const;
    ShadowRequest request_of(const TileKey& key) const;

    std::unique_ptr<ShadowMaps> maps_;
    std::unique_ptr<PunctualKernel> kernel_;
    TileStore store_;
    std::vector<Light> lights_;
    std::vector<Bounds> receivers_, movers_; // static ones; those that move
    std::vector<TileKey> needed_;            // in this frame
    Selection selection_;                    // that they were selected by
    bool selected_ = false;                  // and the scene is still the same
    std::uint64_t geometry_generation_ = 0;
    bool keep_static_ = false;
    ShadowCounters drawn_;
    std::size_t stale_ = 0; // tiles, after this frame
};

} // namespace sunfleck::gi

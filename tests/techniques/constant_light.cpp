#include "tests/techniques/constant_light.h"

#include "engine/gpu/compute_pass.h"
#include "tests/techniques/constant_light_shared.h"

namespace sunfleck::gpu {
std::span<const EmbeddedShader> constant_light_shaders();
}

namespace sunfleck::tests {
namespace {

constexpr gi::Counter pixels{"constant_light_pixels", "pixels", "constant light", "Pixels that got the constant light"};
constexpr gi::Counter all_counters[] = {pixels};
constexpr gi::DebugView all_views[] = {{"constant_light_surfaces", "Where the constant light falls",
                                        "green: a surface that it lights", "", "constant light",
                                        shared::constant_light_shows_surfaces}};

constexpr gi::Overlay all_overlays[] = {
    {"constant_light_cube", "A cube of the scene's unit about its origin", "green: always", "constant light"}};

constexpr gi::ListingColumn columns[] = {{"channel", "", "Of the light"},
                                         {"times asked", "", "How often it was marked"}};
constexpr gi::ListingAction row_actions[] = {{"Mark", "Counts one more"}};
constexpr gi::Listing all_listings[] = {
    {"constant_light_channels", "What the constant light is made of", "constant light", columns, row_actions}};

class ConstantLight final : public gi::Technique {
public:
    static Result<std::unique_ptr<gi::Technique>> create(gpu::Device& device, gpu::PipelineStore& pipelines) {
        auto technique = std::make_unique<ConstantLight>(device);
        VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
        SUNFLECK_VK(device.vk.vkCreateSampler(device.handle(), &sampler, nullptr, &technique->sampler_),
                    "creating a sampler");
        gpu::ComputeDescription description;
        description.shader = "tests/techniques/constant_light.comp";
        SUNFLECK_ASSIGN(technique->kernel_, pipelines.compute(description));
        return std::unique_ptr<gi::Technique>(std::move(technique));
    }

    explicit ConstantLight(gpu::Device& device) : device_(device) {}
    ~ConstantLight() override { device_.vk.vkDestroySampler(device_.handle(), sampler_, nullptr); }

    Status update(const gi::SceneView&, gi::Services&, gi::CellSet) override { return {}; }

    Status add_passes(gpu::FrameGraph& graph, gi::Services& services, gi::LightTarget& target) override {
        const gi::GBufferInput& g_buffer = target.g_buffer;
        const auto& settings = services.settings.of<ConstantLightSettings>();
        shared::ConstantLightConstants constants{g_buffer.width,
                                                 g_buffer.height,
                                                 target.view != nullptr ? target.view->code
                                                                        : shared::constant_light_shows_nothing,
                                                 settings.constant_irradiance,
                                                 settings.constant_work,
                                                 -1.0f};
        pixels_ = std::uint64_t(constants.width) * constants.height;
        const auto add = [&](const char* name) {
            gpu::ComputePass(graph, name, *kernel_)
                .sampled(g_buffer.depth, sampler_)
                .storage_write(target.irradiance)
                .push(constants)
                .dispatch((constants.width + 7) / 8, (constants.height + 7) / 8);
        };
        if (constants.work > 0)
            add("constant work");
        constants.work = 0;
        add("constant light");
        return {};
    }

    void draw_overlay(const gi::Overlay&, const gi::Services&, gi::OverlayLines& lines) const override {
        lines.box({vec3(-1.0f), vec3(1.0f)}, vec3(0.0f, 1.0f, 0.0f));
    }
    gi::ListingContent fill_listing(const gi::Listing&, const gi::Services&, const gi::ListedPlace*) const override {
        gi::ListingContent content{"3 channels", {}};
        for (std::uint32_t i = 0; i < 3; ++i)
            content.rows.push_back({i, std::nullopt, {std::string(1, "rgb"[i]), double(marks_[i])}, {}});
        return content;
    }
    void act(const gi::Listing&, std::uint32_t, std::uint32_t key, bool) override { ++marks_[key]; }
    void report(gi::Report& report) const override { report.set(pixels, double(pixels_)); }

private:
    gpu::Device& device_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    const gpu::Pipeline* kernel_ = nullptr;
    std::uint64_t pixels_ = 0;
    int marks_[3] = {};
};

} // namespace

const TypeDescription& ConstantLightSettings::description() {
    static const TypeDescription type{"ConstantLightSettings",
                                      1,
                                      "The same light everywhere.",
                                      {SUNFLECK_FIELD(ConstantLightSettings, constant_irradiance, "W/m2", 0, 1000,
                                                      "What every surface gets of the constant light"),
                                       SUNFLECK_FIELD(ConstantLightSettings, constant_work, "turns", 0, 1000000,
                                                      "Work for nothing at each pixel, in a pass of its own")}};
    return type;
}

const gi::TechniqueEntry& constant_light() {
    static const gi::TechniqueEntry entry{
        .name = "constant_light",
        .tooltip = "The same irradiance everywhere",
        .can_light =
            gi::cells_where([](gi::LightCell cell) { return cell.path != gi::PathPart::direct && !cell.specular; }),
        .settings = gi::settings_of<ConstantLightSettings>(),
        .counters = all_counters,
        .views = all_views,
        .overlays = all_overlays,
        .listings = all_listings,
        .shaders = gpu::constant_light_shaders,
        .create = ConstantLight::create,
    };
    return entry;
}

} // namespace sunfleck::tests

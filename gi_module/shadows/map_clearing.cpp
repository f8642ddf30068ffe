// Maps that hold something else or nothing at all, and that the budget leaves undrawn.
#include "gi_module/shadows/shadow_maps.h"

#include <bit>

namespace sunfleck::gi {

void ShadowMaps::add_clearing(gpu::FrameGraph& graph, std::span<const std::uint32_t> slots) {
    if (slots.empty())
        return;
    std::vector<const gpu::Buffer*> layers = {&texels_};
    if (static_texels_)
        layers.push_back(&static_texels_);
    auto pass = graph.add_pass("shadow map clearing");
    for (const gpu::Buffer* layer : layers)
        pass.write(graph.import_buffer(*layer), gpu::Usage::transfer_destination);
    pass.execute([this, layers, all = std::vector(slots.begin(), slots.end())](gpu::PassContext& context) {
        for (const gpu::Buffer* layer : layers)
            fill_slots(context, all, *layer);
        return Status();
    });
}

// With what is nearest to the light.
void ShadowMaps::fill_slots(gpu::PassContext& context, std::span<const std::uint32_t> slots,
                            const gpu::Buffer& texels) const {
    const std::uint64_t bytes = std::uint64_t(resolution_) * resolution_ * bits_ / 8;
    for (const std::uint32_t slot : slots)
        context.device.vk.vkCmdFillBuffer(context.commands, texels.handle(), slot * bytes, bytes,
                                          bits_ == 16 ? 0xffffffffu : std::bit_cast<std::uint32_t>(1.0f));
}

} // namespace sunfleck::gi

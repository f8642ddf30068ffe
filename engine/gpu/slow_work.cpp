#include "engine/gpu/slow_work.h"

#include "engine/core/slow_work.h"
#include "engine/gpu/pipeline.h"

#include <algorithm>

namespace sunfleck::gpu {

std::span<const EmbeddedShader> sunfleck_slow_work_shaders();

namespace {

// Made once, for the one device that such a program has, and never destroyed.
Result<const Pipeline*> slow_pipeline(Device& device) {
    static ShaderLibrary* shaders = nullptr;
    static PipelineStore* pipelines = nullptr;
    if (shaders == nullptr) {
        shaders = new ShaderLibrary();
        shaders->add(sunfleck_slow_work_shaders());
        pipelines = new PipelineStore(device, *shaders);
    }
    ComputeDescription description;
    description.shader = "engine/gpu/slow_work.comp";
    return pipelines->compute(description);
}

} // namespace

Status add_slow_work(PassContext& context, const std::string& pass) {
    constexpr int most_groups = 65535;
    const int groups = std::clamp(slow_work_amount(pass), 0, most_groups);
    if (groups == 0)
        return {};
    SUNFLECK_ASSIGN(const Pipeline* pipeline, slow_pipeline(context.device));
    SUNFLECK_ASSIGN(const UploadSlice slice, context.resources.allocate(64 * sizeof(float)));
    const Binding bindings[] = {Binding::storage(slice)};
    SUNFLECK_TRY(context.resources.bind(context.commands, *pipeline, bindings));
    context.device.vk.vkCmdDispatch(context.commands, std::uint32_t(groups), 1, 1);
    return {};
}

} // namespace sunfleck::gpu

#include "engine/gpu/pipeline_cache.h"

namespace sunfleck::gpu {

BuiltPipeline::~BuiltPipeline() {
    device.vk.vkDestroyPipeline(device.handle(), handle, nullptr);
    device.vk.vkDestroyPipelineLayout(device.handle(), layout, nullptr);
    device.vk.vkDestroyDescriptorSetLayout(device.handle(), set_layout, nullptr);
}

// FNV-1a over words.
void PipelineKey::add_code(std::span<const std::uint32_t> words) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const std::uint32_t word : words)
        hash = (hash ^ word) * 0x100000001b3u;
    code.insert(code.end(), {words.size(), hash});
}

std::shared_ptr<const BuiltPipeline> PipelineCache::find(const PipelineKey& key) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [known, pipeline] : pipelines_)
        if (known == key)
            return pipeline;
    return nullptr;
}

std::shared_ptr<const BuiltPipeline> PipelineCache::keep(const PipelineKey& key,
                                                         std::shared_ptr<const BuiltPipeline> pipeline) {
    const std::lock_guard lock(mutex_);
    for (const auto& [known, first] : pipelines_)
        if (known == key)
            return first;
    pipelines_.emplace_back(key, pipeline);
    return pipeline;
}

void PipelineCache::drop_unused() {
    const std::lock_guard lock(mutex_);
    std::erase_if(pipelines_, [](const auto& entry) { return entry.second.use_count() == 1; });
}

std::size_t PipelineCache::size() const {
    const std::lock_guard lock(mutex_);
    return pipelines_.size();
}

} // namespace sunfleck::gpu

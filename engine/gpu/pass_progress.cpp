#include "engine/gpu/pass_progress.h"

#include <cstring>

namespace sunfleck::gpu {

Result<PassProgress> PassProgress::create(Device& device) {
    PassProgress progress(device);
    SUNFLECK_ASSIGN(progress.done_, Buffer::create(device, {"passes done", sizeof(std::uint32_t),
                                                            VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback}));
    std::memset(progress.done_.mapped(), 0, sizeof(std::uint32_t));
    return progress;
}

void PassProgress::pass_recorded(VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    device_->vk.vkCmdPipelineBarrier2(commands, &dependency);
    device_->vk.vkCmdFillBuffer(commands, done_.handle(), 0, sizeof(std::uint32_t), ++recorded_);
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    device_->vk.vkCmdPipelineBarrier2(commands, &dependency);
}

double PassProgress::share_done() const {
    std::uint32_t done = 0;
    std::memcpy(&done, done_.mapped(), sizeof(done));
    return recorded_ > 0 ? double(done) / recorded_ : 0.0;
}

} // namespace sunfleck::gpu

#include "engine/gpu/submission.h"

#include <algorithm>

#include <cstring>

namespace sunfleck::gpu {

Result<std::unique_ptr<Submission>> Submission::create(Device& device, std::uint32_t frames_in_flight) {
    std::unique_ptr<Submission> submission(new Submission(device));
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
    SUNFLECK_VK(device.vk.vkCreateSemaphore(device.handle(), &info, nullptr, &submission->timeline_),
                "creating the frame semaphore");
    for (std::uint32_t i = 0; i < frames_in_flight; ++i) {
        Slot slot;
        VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
        pool.queueFamilyIndex = device.queue_family();
        SUNFLECK_VK(device.vk.vkCreateCommandPool(device.handle(), &pool, nullptr, &slot.pool),
                    "creating a command pool");
        submission->slots_.push_back(slot);
        VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        allocate.commandPool = slot.pool;
        allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        allocate.commandBufferCount = 1;
        SUNFLECK_VK(device.vk.vkAllocateCommandBuffers(device.handle(), &allocate, &submission->slots_.back().commands),
                    "allocating a command buffer");
    }
    return submission;
}

Submission::~Submission() {
    static_cast<void>(wait(serial_ - 1)); // its own work: the queue may be busy with that of others
    for (const Slot& slot : slots_)
        device_.vk.vkDestroyCommandPool(device_.handle(), slot.pool, nullptr);
    device_.vk.vkDestroySemaphore(device_.handle(), timeline_, nullptr);
}

Result<VkCommandBuffer> Submission::begin() {
    Slot& slot = slots_[serial_ % slots_.size()];
    SUNFLECK_TRY(wait(slot.serial));
    SUNFLECK_VK(device_.vk.vkResetCommandPool(device_.handle(), slot.pool, 0), "resetting a command pool");
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    SUNFLECK_VK(device_.vk.vkBeginCommandBuffer(slot.commands, &info), "beginning a command buffer");
    return slot.commands;
}

Status Submission::submit(const PresentSemaphores* semaphores) {
    Slot& slot = slots_[serial_ % slots_.size()];
    SUNFLECK_VK(device_.vk.vkEndCommandBuffer(slot.commands), "ending a command buffer");
    const auto semaphore = [](VkSemaphore handle, std::uint64_t value) {
        VkSemaphoreSubmitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
        info.semaphore = handle;
        info.value = value;
        info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        return info;
    };
    std::vector<VkSemaphoreSubmitInfo> waits, signals{semaphore(timeline_, serial_)};
    if (semaphores != nullptr) {
        waits.push_back(semaphore(semaphores->acquired, 0));
        signals.push_back(semaphore(semaphores->rendered, 0));
    }
    VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    commands.commandBuffer = slot.commands;
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.waitSemaphoreInfoCount = std::uint32_t(waits.size());
    info.pWaitSemaphoreInfos = waits.data();
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &commands;
    info.signalSemaphoreInfoCount = std::uint32_t(signals.size());
    info.pSignalSemaphoreInfos = signals.data();
    const std::scoped_lock lock(device_.queue_mutex());
    SUNFLECK_VK(device_.vk.vkQueueSubmit2(device_.queue(), 1, &info, VK_NULL_HANDLE), "submitting a frame");
    slot.serial = serial_++;
    return {};
}

Result<std::uint64_t> Submission::completed() {
    std::uint64_t value = 0;
    SUNFLECK_VK(device_.vk.vkGetSemaphoreCounterValue(device_.handle(), timeline_, &value),
                "reading the frame semaphore");
    return value;
}

Status Submission::wait(std::uint64_t serial) {
    const Result<bool> done = wait_for(serial, std::chrono::nanoseconds::max());
    return done ? Status() : done.error();
}

Result<bool> Submission::wait_for(std::uint64_t serial, std::chrono::nanoseconds time) {
    if (serial == 0)
        return true;
    VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
    info.semaphoreCount = 1;
    info.pSemaphores = &timeline_;
    info.pValues = &serial;
    const bool for_ever = time == std::chrono::nanoseconds::max();
    const VkResult result =
        device_.vk.vkWaitSemaphores(device_.handle(), &info, for_ever ? UINT64_MAX : std::uint64_t(time.count()));
    if (result == VK_TIMEOUT)
        return false;
    SUNFLECK_VK(result, "waiting for the GPU");
    return true;
}

Status Submission::immediate(const std::function<Status(VkCommandBuffer)>& record) {
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, begin());
    const std::uint64_t serial = serial_;
    SUNFLECK_TRY(record(commands));
    SUNFLECK_TRY(submit());
    return wait(serial);
}

Status upload_now(Device& device, Submission& submission, const Buffer& target, std::span<const std::byte> bytes,
                  VkDeviceSize offset) {
    if (bytes.empty())
        return {};
    SUNFLECK_ASSIGN(const Buffer staging,
                    Buffer::create(device, {"staging", bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                            MemoryUse::upload, VK_FORMAT_UNDEFINED}));
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    return submission.immediate([&](VkCommandBuffer commands) -> Status {
        const VkBufferCopy region{0, offset, bytes.size()};
        device.vk.vkCmdCopyBuffer(commands, staging.handle(), target.handle(), 1, &region);
        return {};
    });
}

namespace {

void move_image(const DeviceFunctions& vk, VkCommandBuffer commands, VkImage image, VkImageLayout from,
                VkImageLayout to) {
    const bool before = from == VK_IMAGE_LAYOUT_UNDEFINED;
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = before ? VK_PIPELINE_STAGE_2_NONE : VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.srcAccessMask = before ? 0 : VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstStageMask = before ? VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT : VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
    barrier.dstAccessMask = before ? VK_ACCESS_2_TRANSFER_WRITE_BIT : VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    vk.vkCmdPipelineBarrier2(commands, &dependency);
}

} // namespace

Result<Image> make_sampled_image(Device& device, Submission& submission, ImageDescription description,
                                 std::span<const std::byte> bytes, std::span<const VkBufferImageCopy> regions) {
    description.usage |= VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    SUNFLECK_ASSIGN(Image image, Image::create(device, description));
    BufferDescription staging;
    staging.name = "image upload";
    staging.size = bytes.size();
    staging.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    staging.memory = MemoryUse::upload;
    SUNFLECK_ASSIGN(const Buffer source, Buffer::create(device, staging));
    std::copy(bytes.begin(), bytes.end(), source.mapped());
    SUNFLECK_TRY(submission.immediate([&](VkCommandBuffer commands) -> Status {
        move_image(device.vk, commands, image.handle(), VK_IMAGE_LAYOUT_UNDEFINED,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        device.vk.vkCmdCopyBufferToImage(commands, source.handle(), image.handle(),
                                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, std::uint32_t(regions.size()),
                                         regions.data());
        move_image(device.vk, commands, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        return {};
    }));
    return image;
}

} // namespace sunfleck::gpu

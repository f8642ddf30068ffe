#include "engine/gpu/timers.h"

#include <cassert>

namespace sunfleck::gpu {
namespace {
constexpr std::uint32_t scopes_per_frame = 1024; // later scopes of a frame are not timed
}

Timers::~Timers() {
    for (const Frame& frame : frames_)
        device_.vk.vkDestroyQueryPool(device_.handle(), frame.pool, nullptr);
    for (VkQueryPool pool : spare_)
        device_.vk.vkDestroyQueryPool(device_.handle(), pool, nullptr);
}

void Timers::begin_frame(std::uint64_t serial, std::uint64_t completed_serial) {
    collect(completed_serial);
    Frame frame;
    frame.serial = serial;
    if (device_.traits().timestamps) {
        if (spare_.empty()) {
            VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
            info.queryType = VK_QUERY_TYPE_TIMESTAMP;
            info.queryCount = scopes_per_frame * 2;
            // Without a pool the frame simply has no times.
            if (device_.vk.vkCreateQueryPool(device_.handle(), &info, nullptr, &frame.pool) != VK_SUCCESS)
                frame.pool = VK_NULL_HANDLE;
        } else {
            frame.pool = spare_.back();
            spare_.pop_back();
        }
        if (frame.pool != VK_NULL_HANDLE)
            device_.vk.vkResetQueryPool(device_.handle(), frame.pool, 0, scopes_per_frame * 2);
    }
    frames_.push_back(std::move(frame));
}

void Timers::begin_scope(VkCommandBuffer commands, const std::string& name) {
    if (device_.debug_labels() && vkCmdBeginDebugUtilsLabelEXT != nullptr) {
        VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
        label.pLabelName = name.c_str();
        vkCmdBeginDebugUtilsLabelEXT(commands, &label);
    }
    if (frames_.empty())
        return;
    Frame& frame = frames_.back();
    const std::uint32_t index = std::uint32_t(frame.names.size());
    frame.open.push_back(index);
    frame.names.push_back(name);
    if (frame.pool != VK_NULL_HANDLE && index < scopes_per_frame)
        device_.vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, frame.pool, index * 2);
}

void Timers::end_scope(VkCommandBuffer commands) {
    if (!frames_.empty()) {
        Frame& frame = frames_.back();
        assert(!frame.open.empty() && "end_scope without begin_scope");
        const std::uint32_t index = frame.open.back();
        frame.open.pop_back();
        if (frame.pool != VK_NULL_HANDLE && index < scopes_per_frame)
            device_.vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, frame.pool, index * 2 + 1);
    }
    if (device_.debug_labels() && vkCmdEndDebugUtilsLabelEXT != nullptr)
        vkCmdEndDebugUtilsLabelEXT(commands);
}

void Timers::collect(std::uint64_t completed_serial) {
    while (!frames_.empty() && frames_.front().serial <= completed_serial) {
        Frame frame = std::move(frames_.front());
        frames_.pop_front();
        if (frame.pool == VK_NULL_HANDLE)
            continue;
        spare_.push_back(frame.pool);
        const std::uint32_t scopes = std::min<std::uint32_t>(std::uint32_t(frame.names.size()), scopes_per_frame);
        std::vector<std::uint64_t> stamps(scopes * 2);
        if (scopes == 0 ||
            device_.vk.vkGetQueryPoolResults(device_.handle(), frame.pool, 0, scopes * 2, stamps.size() * 8,
                                             stamps.data(), 8, VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
            continue;
        latest_ = {};
        latest_.serial = frame.serial;
        for (std::uint32_t i = 0; i < scopes; ++i)
            latest_.milliseconds[frame.names[i]] +=
                double(stamps[i * 2 + 1] - stamps[i * 2]) * double(device_.traits().timestamp_period_ns) * 1e-6;
    }
}

} // namespace sunfleck::gpu

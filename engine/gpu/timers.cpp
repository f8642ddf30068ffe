#include "engine/gpu/timers.h"

#include <algorithm>
#include <cassert>

namespace sunfleck::gpu {
namespace {
constexpr std::uint32_t scopes_per_frame = 1024; // later scopes of a frame are not timed
}

Timers::~Timers() {
    for (VkQueryPool pool : pools_)
        device_.vk.vkDestroyQueryPool(device_.handle(), pool, nullptr);
}

// Null where there are no timestamps, or no pool could be made: the frame simply has no times then.
VkQueryPool Timers::take_pool() {
    VkQueryPool pool = VK_NULL_HANDLE;
    if (!device_.traits().timestamps)
        return pool;
    if (!spare_.empty()) {
        pool = spare_.back();
        spare_.pop_back();
    } else {
        VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        info.queryCount = scopes_per_frame * 2;
        // First, so that memory cannot run out once there is a pool to keep.
        pools_.reserve(pools_.size() + 1);
        spare_.reserve(pools_.size() + 1);
        if (device_.vk.vkCreateQueryPool(device_.handle(), &info, nullptr, &pool) != VK_SUCCESS)
            return VK_NULL_HANDLE;
        pools_.push_back(pool);
    }
    device_.vk.vkResetQueryPool(device_.handle(), pool, 0, scopes_per_frame * 2);
    return pool;
}

Status Timers::begin_frame(std::uint64_t serial, std::uint64_t completed_serial) {
    SUNFLECK_TRY(collect(completed_serial));
    for (Frame& frame : frames_) // greater ones were begun, but never submitted
        frame.serial = std::min(frame.serial, serial);
    frames_.emplace_back();
    frames_.back().serial = serial;
    frames_.back().pool = take_pool();
    return {};
}

void Timers::begin_scope(VkCommandBuffer commands, const std::string& name) {
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
    if (frames_.empty())
        return;
    Frame& frame = frames_.back();
    assert(!frame.open.empty() && "end_scope without begin_scope");
    const std::uint32_t index = frame.open.back();
    frame.open.pop_back();
    if (frame.pool != VK_NULL_HANDLE && index < scopes_per_frame)
        device_.vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, frame.pool, index * 2 + 1);
}

FrameTimes Timers::times_of(const Frame& frame, const std::vector<std::uint64_t>& stamps) const {
    FrameTimes times;
    times.serial = frame.serial;
    const double tick_ms = double(device_.traits().timestamp_period_ns) * 1e-6;
    for (std::size_t i = 0; i * 2 < stamps.size(); ++i) {
        const std::uint64_t begin = stamps[i * 2], end = stamps[i * 2 + 1];
        times.milliseconds[frame.names[i]] += double(end - begin) * tick_ms;
        times.scopes.push_back(
            {frame.names[i], double(begin - stamps[0]) * tick_ms, double(end - stamps[0]) * tick_ms});
    }
    return times;
}

Status Timers::collect(std::uint64_t completed_serial) {
    while (!frames_.empty() && frames_.front().serial <= completed_serial) {
        const Frame frame = std::move(frames_.front());
        frames_.pop_front();
        if (frame.pool == VK_NULL_HANDLE)
            continue;
        spare_.push_back(frame.pool);
        const std::uint32_t scopes = std::min<std::uint32_t>(std::uint32_t(frame.names.size()), scopes_per_frame);
        if (scopes == 0)
            continue;
        std::vector<std::uint64_t> stamps(scopes * 2);
        const VkResult result = device_.vk.vkGetQueryPoolResults(
            device_.handle(), frame.pool, 0, scopes * 2, stamps.size() * 8, stamps.data(), 8, VK_QUERY_RESULT_64_BIT);
        if (result == VK_ERROR_DEVICE_LOST)
            return vulkan_error(result, "reading the times of a frame's passes");
        if (result == VK_SUCCESS)
            latest_ = times_of(frame, stamps);
    }
    return {};
}

} // namespace sunfleck::gpu

#include "engine/gpu/memory.h"

#include "engine/core/large_pages.h"
#include "engine/core/memory_limit.h"
#include "engine/gpu/device.h"

#include <algorithm>
#include <cassert>

namespace sunfleck::gpu {
namespace {
constexpr VkDeviceSize block_size = VkDeviceSize(32) << 20;
// A CPU device's memory is the process's own: pages of a block that were written once count for as long as the block is
// there, whatever is free in it. So blocks are small there, and most pieces have memory of their own, which costs no
// more than other memory.
constexpr VkDeviceSize software_block_size = VkDeviceSize(2) << 20;

VkDeviceSize size_of_blocks(const DeviceTraits& traits) {
    return traits.software ? software_block_size : block_size;
}
// Larger requests get memory of their own: a block would mostly hold just them.
VkDeviceSize largest_in_block(VkDeviceSize size_of_block) {
    return size_of_block / 4;
}

struct UsageEntry {
    std::map<std::string, std::uint64_t>& usage;
    const std::string& what;
    ~UsageEntry() {
        if (const auto entry = usage.find(what); entry != usage.end() && entry->second == 0)
            usage.erase(entry);
    }
};
} // namespace

Memory::Memory(Device& device) : device_(device) {
    device.instance_vk().vkGetPhysicalDeviceMemoryProperties(device.physical_device(), &properties_);
}

Memory::~Memory() {
    for (const Block& block : blocks_)
        if (block.memory != VK_NULL_HANDLE)
            device_.vk.vkFreeMemory(device_.handle(), block.memory, nullptr);
}

Result<std::uint32_t> Memory::choose_type(std::uint32_t allowed, MemoryUse use) const {
    VkMemoryPropertyFlags required = 0, preferred = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    if (use != MemoryUse::device)
        required = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, preferred = 0;
    if (use == MemoryUse::readback)
        preferred = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    for (const VkMemoryPropertyFlags wanted : {required | preferred, required})
        for (std::uint32_t type = 0; type < properties_.memoryTypeCount; ++type)
            if ((allowed & (1u << type)) && (properties_.memoryTypes[type].propertyFlags & wanted) == wanted)
                return type;
    return Error{"the device has no memory type for this use", ErrorCode::unsupported};
}

Result<std::uint32_t> Memory::make_block(VkDeviceSize size, std::uint32_t type, bool linear, bool dedicated, bool map,
                                         const std::string& what) {
    const std::string settings = "the picture's size, the level's, the light samples (lights) or shadow_memory";
    // Other devices have memory of their own, and refuse what does not fit.
    if (device_.traits().shares_memory)
        SUNFLECK_TRY(check_memory(size, "'" + what + "'", settings));
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = size;
    info.memoryTypeIndex = type;
    // Whatever may throw comes first: nothing that the device gave can get lost then.
    Block block;
    block.free_ranges.reserve(2);
    blocks_.reserve(blocks_.size() + 1);
    const std::string doing = "allocating " + std::to_string(size >> 20) + " MiB of GPU memory for '" + what + "'";
    const VkResult allocated = device_.vk.vkAllocateMemory(device_.handle(), &info, nullptr, &block.memory);
    if (allocated == VK_ERROR_OUT_OF_DEVICE_MEMORY || allocated == VK_ERROR_OUT_OF_HOST_MEMORY)
        return Error{vulkan_error(allocated, doing).message + ". Lower " + settings, ErrorCode::memory};
    SUNFLECK_VK(allocated, doing);
    if (map) {
        void* mapped = nullptr;
        const VkResult result = device_.vk.vkMapMemory(device_.handle(), block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
        if (result != VK_SUCCESS) {
            device_.vk.vkFreeMemory(device_.handle(), block.memory, nullptr);
            return vulkan_error(result, "mapping GPU memory for '" + what + "'");
        }
        block.mapped = static_cast<std::byte*>(mapped);
        if (device_.traits().software)
            prefer_large_pages(mapped, size);
    }
    block.size = size;
    block.type = type;
    block.linear = linear;
    block.dedicated = dedicated;
    block.free_ranges.push_back({0, size});
    const auto unused =
        std::find_if(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.memory == VK_NULL_HANDLE; });
    const std::uint32_t index = std::uint32_t(unused - blocks_.begin());
    if (unused == blocks_.end())
        blocks_.push_back(std::move(block));
    else
        *unused = std::move(block);
    return index;
}

bool Memory::take(Block& block, const VkMemoryRequirements& requirements, VkDeviceSize& offset) {
    for (std::size_t i = 0; i < block.free_ranges.size(); ++i) {
        const Range range = block.free_ranges[i];
        const VkDeviceSize start = (range.offset + requirements.alignment - 1) & ~(requirements.alignment - 1);
        const VkDeviceSize end = start + requirements.size;
        if (end > range.offset + range.size)
            continue;
        if (block.free_ranges.capacity() < block.allocations + 2)
            block.free_ranges.reserve(2 * (block.allocations + 2));
        ++block.allocations;
        const Range before{range.offset, start - range.offset}, after{end, range.offset + range.size - end};
        block.free_ranges.erase(block.free_ranges.begin() + std::ptrdiff_t(i));
        for (const Range& rest : {after, before})
            if (rest.size > 0)
                block.free_ranges.insert(block.free_ranges.begin() + std::ptrdiff_t(i), rest);
        offset = start;
        return true;
    }
    return false;
}

void Memory::give_back(Block& block, Range range) {
    auto next = std::lower_bound(block.free_ranges.begin(), block.free_ranges.end(), range.offset,
                                 [](const Range& r, VkDeviceSize offset) { return r.offset < offset; });
    if (next != block.free_ranges.end() && range.offset + range.size == next->offset) {
        range.size += next->size;
        next = block.free_ranges.erase(next);
    }
    if (next != block.free_ranges.begin()) {
        auto previous = std::prev(next);
        if (previous->offset + previous->size == range.offset) {
            previous->size += range.size;
            return;
        }
    }
    block.free_ranges.insert(next, range);
}

Result<Allocation> Memory::allocate(const VkMemoryRequirements& requirements, MemoryUse use, bool linear,
                                    const std::string& what) {
    const std::lock_guard lock(mutex_);
    SUNFLECK_ASSIGN(const std::uint32_t type, choose_type(requirements.memoryTypeBits, use));
    const bool map = use != MemoryUse::device;
    const VkDeviceSize size_of_block = size_of_blocks(device_.traits());
    const bool dedicated = requirements.size > largest_in_block(size_of_block);
    Allocation allocation;
    allocation.size = requirements.size;
    std::uint64_t& used = usage_[what];
    const UsageEntry entry{usage_, what}; // goes again where nothing is allocated
    bool found = false;
    for (std::uint32_t i = 0; !dedicated && i < blocks_.size() && !found; ++i) {
        Block& block = blocks_[i];
        if (block.memory == VK_NULL_HANDLE || block.dedicated || block.type != type || block.linear != linear ||
            (block.mapped != nullptr) != map)
            continue;
        found = take(block, requirements, allocation.offset);
        allocation.block = i;
    }
    if (!found) {
        SUNFLECK_ASSIGN(allocation.block,
                        make_block(dedicated ? requirements.size : size_of_block, type, linear, dedicated, map, what));
        take(blocks_[allocation.block], requirements, allocation.offset);
    }
    const Block& block = blocks_[allocation.block];
    allocation.memory = block.memory;
    allocation.mapped = map ? block.mapped + allocation.offset : nullptr;
    used += requirements.size;
    return allocation;
}

void Memory::free(const Allocation& allocation, const std::string& what) {
    const std::lock_guard lock(mutex_);
    Block& block = blocks_[allocation.block];
    give_back(block, {allocation.offset, allocation.size});
    --block.allocations;
    const auto entry = usage_.find(what);
    assert(entry != usage_.end() && entry->second >= allocation.size);
    if ((entry->second -= allocation.size) == 0)
        usage_.erase(entry);
    if (block.dedicated || (block.allocations == 0 && has_spare(block))) {
        device_.vk.vkFreeMemory(device_.handle(), block.memory, nullptr);
        block = Block{};
    }
}

// One empty block of a kind is kept, for what comes and goes from frame to frame.
bool Memory::has_spare(const Block& block) const {
    return std::ranges::any_of(blocks_, [&](const Block& other) {
        return &other != &block && other.memory != VK_NULL_HANDLE && !other.dedicated && other.allocations == 0 &&
               other.type == block.type && other.linear == block.linear &&
               (other.mapped != nullptr) == (block.mapped != nullptr);
    });
}

void Memory::free_spares() {
    const std::lock_guard lock(mutex_);
    for (Block& block : blocks_)
        if (block.memory != VK_NULL_HANDLE && block.allocations == 0) {
            device_.vk.vkFreeMemory(device_.handle(), block.memory, nullptr);
            block = Block{};
        }
}

std::map<std::string, std::uint64_t> Memory::usage() const {
    const std::lock_guard lock(mutex_);
    return usage_;
}

std::uint64_t Memory::total() const {
    std::uint64_t sum = 0;
    for (const auto& [what, bytes] : usage())
        sum += bytes;
    return sum;
}

} // namespace sunfleck::gpu

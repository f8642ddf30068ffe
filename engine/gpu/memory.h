// Device memory in blocks, handed out in pieces. The interface is what VMA offers, so that it can take over.
#pragma once

#include "engine/gpu/vulkan.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace sunfleck::gpu {

class Device;

enum class MemoryUse {
    device,   // GPU only
    upload,   // mapped, written by the CPU in order, read by the GPU
    readback, // mapped, cached, read by the CPU
};

struct Allocation {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    VkDeviceSize size = 0;
    void* mapped = nullptr; // null for MemoryUse::device
    std::uint32_t block = 0;
};

// Thread safe.
class Memory {
public:
    explicit Memory(Device& device);
    ~Memory();
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // `linear`: buffers and linear images; the others get blocks of their own (bufferImageGranularity).
    Result<Allocation> allocate(const VkMemoryRequirements& requirements, MemoryUse use, bool linear,
                                const std::string& what);
    void free(const Allocation& allocation, const std::string& what);

    // Frees what is kept for later, though nothing is in it. For moments of rest.
    void free_spares();

    // Bytes in use by name.
    std::map<std::string, std::uint64_t> usage() const;
    std::uint64_t total() const;

private:
    struct Range {
        VkDeviceSize offset, size;
    };
    struct Block {
        VkDeviceMemory memory = VK_NULL_HANDLE;
        VkDeviceSize size = 0;
        std::uint32_t type = 0;
        bool linear = true;
        bool dedicated = false;
        std::byte* mapped = nullptr;
        std::vector<Range> free_ranges; // by rising offset, never adjacent
        std::size_t allocations = 0;    // room for one more range than these is reserved: giving back never allocates
    };

    Result<std::uint32_t> choose_type(std::uint32_t allowed, MemoryUse use) const;
    Result<std::uint32_t> make_block(VkDeviceSize size, std::uint32_t type, bool linear, bool dedicated, bool map,
                                     const std::string& what);
    bool has_spare(const Block& block) const;
    static bool take(Block& block, const VkMemoryRequirements& requirements, VkDeviceSize& offset);
    static void give_back(Block& block, Range range);

    Device& device_;
    VkPhysicalDeviceMemoryProperties properties_{};
    mutable std::mutex mutex_;
    std::vector<Block> blocks_;
    std::map<std::string, std::uint64_t> usage_;
};

} // namespace sunfleck::gpu

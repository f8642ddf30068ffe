// A device buffer that the CPU writes now and then, through upload memory.
#pragma once

#include "engine/gpu/frame_graph.h"

#include <span>
#include <vector>

namespace sunfleck::gpu {

class UploadedBuffer {
public:
    // Makes room for `bytes`; content is lost when it grows (returns true then), and it grows by half more than asked
    // for, so that this is rare. `texel_format`: it is a texel buffer, too.
    Result<bool> reserve(Device& device, FrameResources& resources, const char* name, std::uint64_t bytes,
                         VkFormat texel_format = VK_FORMAT_UNDEFINED);
    // Queues a piece for the next add_pass, which must belong to the same frame.
    Status write(FrameResources& resources, std::uint64_t offset, std::span<const std::byte> bytes);
    // Adds a pass with the queued copies, if there are any.
    void add_pass(FrameGraph& graph);
    // Drops the queue of a frame that was given up before add_pass: its upload memory is about to be used again.
    void forget_pieces() { pieces_.clear(); }
    const Buffer& buffer() const { return buffer_; }

private:
    struct Piece {
        UploadSlice source;
        VkBufferCopy region;
    };
    Buffer buffer_;
    std::vector<Piece> pieces_;
};

} // namespace sunfleck::gpu

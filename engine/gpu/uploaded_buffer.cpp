#include "engine/gpu/uploaded_buffer.h"

#include "engine/gpu/texel_formats.h"

#include <algorithm>

namespace sunfleck::gpu {
namespace {

// Half more than `bytes`, but no more than one binding of this device can show.
std::uint64_t with_room_to_grow(const DeviceTraits& traits, std::uint64_t bytes, VkFormat texel_format) {
    std::uint64_t most = traits.max_storage_range;
    if (texel_format != VK_FORMAT_UNDEFINED)
        most = std::min(most, traits.max_texel_elements * texel_bytes(texel_format));
    return std::max(bytes, std::min(bytes + bytes / 2, most / 16 * 16));
}

} // namespace

Result<bool> UploadedBuffer::reserve(Device& device, FrameResources& resources, const char* name, std::uint64_t bytes,
                                     VkFormat texel_format) {
    if (buffer_ && buffer_.size() >= bytes)
        return false;
    pieces_.clear();
    BufferDescription description;
    description.name = name;
    description.size = buffer_ ? with_room_to_grow(device.traits(), bytes, texel_format) : bytes;
    description.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    description.texel_format = texel_format;
    if (texel_format != VK_FORMAT_UNDEFINED)
        description.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    if (buffer_)
        resources.retire(std::move(buffer_));
    SUNFLECK_ASSIGN(buffer_, Buffer::create(device, description));
    return true;
}

Status UploadedBuffer::write(FrameResources& resources, std::uint64_t offset, std::span<const std::byte> bytes) {
    if (bytes.empty())
        return {};
    SUNFLECK_ASSIGN(const UploadSlice source, resources.upload(bytes));
    pieces_.push_back({source, {source.offset, offset, bytes.size()}});
    return {};
}

void UploadedBuffer::add_pass(FrameGraph& graph) {
    if (pieces_.empty())
        return;
    graph.add_pass(buffer_.name() + " upload")
        .write(graph.import_buffer(buffer_), Usage::transfer_destination)
        .execute([this, pieces = std::exchange(pieces_, {})](PassContext& context) -> Status {
            for (const Piece& piece : pieces)
                context.device.vk.vkCmdCopyBuffer(context.commands, piece.source.buffer, buffer_.handle(), 1,
                                                  &piece.region);
            return {};
        });
}

} // namespace sunfleck::gpu

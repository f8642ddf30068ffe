// A frame as a list of passes that declare what they read and write. The graph removes passes that nothing needs,
// derives the barriers between the rest, batches them (one call before each pass), and runs the passes in the order in
// which they were added. It is built again each frame; images it creates are kept from frame to frame by their names.
//
// Without a device (a null pointer) everything but execution works, which is how it is tested.
#pragma once

#include "engine/gpu/barriers.h"
#include "engine/gpu/frame_resources.h"
#include "engine/gpu/pass_progress.h"
#include "engine/gpu/timers.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace sunfleck::gpu {

struct ResourceId {
    std::uint32_t index = 0xffffffffu;
    bool valid() const { return index != 0xffffffffu; }
    bool operator==(const ResourceId&) const = default;
};

// An image that the host owns, with the state it is in at entry and must be left in at exit.
struct ImportedImage {
    std::string name;
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    ImageDescription description;
    ResourceState entry;
    bool has_exit = false;
    Usage exit{};
    // With Usage::host: how it is used next.
    VkPipelineStageFlags2 exit_stages = 0;
    VkAccessFlags2 exit_access = 0;
    VkImageLayout exit_layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

class FrameGraph;

// Handed to a pass while it records.
struct PassContext {
    Device& device;
    VkCommandBuffer commands;
    FrameResources& resources;
    FrameGraph& graph;
};

struct CompiledPass {
    std::string name;
    std::vector<PassBarrier> barriers;
    std::uint32_t pass_index = 0;
};

class FrameGraph {
public:
    using Execute = std::function<Status(PassContext&)>;

    class PassBuilder {
    public:
        PassBuilder& read(ResourceId id, Usage usage);
        PassBuilder& write(ResourceId id, Usage usage);
        // The pass is kept even if nothing reads what it writes.
        PassBuilder& keep();
        PassBuilder& execute(Execute execute);

    private:
        friend class FrameGraph;
        PassBuilder(FrameGraph& graph, std::uint32_t index) : graph_(graph), index_(index) {}
        FrameGraph& graph_;
        std::uint32_t index_;
    };

    explicit FrameGraph(Device* device) : device_(device) {}

    // Starts a new frame: forgets passes, imports and callbacks, keeps created images for reuse.
    void reset();

    // Objects with their own memory of state; they must outlive execution. Their content is an output: passes that
    // write them are kept.
    ResourceId import_buffer(const Buffer& buffer);
    ResourceId import_image(const Image& image);
    ResourceId import_host_image(const ImportedImage& image);
    // A resource that only orders passes; for the null device's tests, and for upload memory.
    ResourceId create_virtual(const std::string& name);
    // Content is undefined at the frame's first use. Usage flags are gathered from the passes.
    ResourceId create_image(const std::string& name, VkFormat format, std::uint32_t width, std::uint32_t height,
                            std::uint32_t layers = 1, std::uint32_t samples = 1);
    // Two images by turns: `current` is written in this frame and is `previous` in the next. In the first frame (or
    // after a change of size) previous_valid is false.
    struct History {
        ResourceId current, previous;
        bool previous_valid = false;
    };
    History create_history(const std::string& name, VkFormat format, std::uint32_t width, std::uint32_t height);
    // Keeps the passes that `id` depends on.
    void mark_output(ResourceId id);

    PassBuilder add_pass(const std::string& name);
    // Passes added after this wait for all commands before it, and see what they wrote. For whoever recorded a frame
    // that was then not submitted: barriers are derived as if it had been.
    void add_full_barrier();
    // Called once at the end of execute(), if all passes were recorded without an error: for state on the CPU that
    // must not say that a frame's work was done when it was not.
    void when_executed(std::function<void()> callback);

    // Culls and derives barriers. Returns an error if a pass reads what nothing has written.
    Status compile();
    // Counts the passes that execute() records next; null: not. It must outlive their execution.
    void set_progress(PassProgress* progress) { progress_ = progress; }
    // Records all kept passes. compile() must have succeeded.
    Status execute(VkCommandBuffer commands, FrameResources& resources, Timers* timers);

    const std::vector<CompiledPass>& compiled() const { return compiled_; }
    std::vector<std::string> culled() const;
    // Passes with what they read and write, and their barriers, as text.
    std::string print() const;

    // Valid while executing.
    VkImageView view(ResourceId id) const;
    VkImage image(ResourceId id) const;
    // Of an image that the host owns, only the usages that it was imported for are known to be allowed.
    bool owned_by_host(ResourceId id) const { return resources_[id.index].host_image != VK_NULL_HANDLE; }
    const ImageDescription& description(ResourceId id) const { return resources_[id.index].description; }

private:
    struct Resource {
        std::string name;
        bool is_image = false;
        bool external = false; // imported: its content outlives the graph
        bool output = false;
        bool written = false; // by a pass of this graph, or before it
        ImageDescription description;
        const Buffer* buffer = nullptr;
        const Image* image = nullptr;
        VkImage host_image = VK_NULL_HANDLE;
        VkImageView host_view = VK_NULL_HANDLE;
        bool has_exit = false;
        ImportedImage host; // of images that the host owns
        bool created = false;
        std::string pool_key;
        ResourceState state;
    };
    struct Access {
        ResourceId id;
        Usage usage;
        bool write;
    };
    struct Pass {
        std::string name;
        std::vector<Access> accesses;
        bool kept = false;
        bool live = false;
        Execute execute;
    };
    struct HistoryEntry {
        std::uint32_t turn = 0;
        VkFormat format{};
        std::uint32_t width = 0, height = 0;
    };

    ResourceId add_resource(Resource resource);
    void cull();
    void restore_states();
    void derive_exit_barriers();
    Status record_pass(PassContext& context, const CompiledPass& compiled, Timers* timers);
    Status derive_barriers(const Pass& pass, CompiledPass& compiled);
    Status realise_images(FrameResources& resources);
    void record_barriers(VkCommandBuffer commands, const std::vector<PassBarrier>& barriers) const;
    void store_states();

    Device* device_;
    PassProgress* progress_ = nullptr;
    std::vector<Resource> resources_;
    std::vector<Pass> passes_;
    std::vector<CompiledPass> compiled_;
    std::map<std::string, Image> pool_;
    std::map<std::string, HistoryEntry> histories_;
    CompiledPass exit_;
    std::vector<std::function<void()>> when_executed_;
};

} // namespace sunfleck::gpu

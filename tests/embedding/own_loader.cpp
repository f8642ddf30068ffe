#include "own_loader.h"

#include "vulkan_program.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <sunfleck/host.h>
#include <unordered_map>
#include <utility>

namespace host = sunfleck::host;

namespace {

// What the driver has taken and not given back: its sizes, since a reallocation has to know them.
std::mutex mutex;
std::unordered_map<void*, std::size_t> taken;

VKAPI_ATTR void* VKAPI_CALL allocate(void*, std::size_t size, std::size_t alignment, VkSystemAllocationScope) {
    void* memory = nullptr;
    if (posix_memalign(&memory, std::max(alignment, sizeof(void*)), size) != 0)
        return nullptr;
    const std::scoped_lock lock(mutex);
    taken[memory] = size;
    return memory;
}
VKAPI_ATTR void VKAPI_CALL give_back(void*, void* memory) {
    const std::scoped_lock lock(mutex);
    taken.erase(memory);
    std::free(memory);
}
VKAPI_ATTR void* VKAPI_CALL reallocate(void* user, void* memory, std::size_t size, std::size_t alignment,
                                       VkSystemAllocationScope scope) {
    if (size == 0) {
        give_back(user, memory);
        return nullptr;
    }
    void* larger = allocate(user, size, alignment, scope);
    if (memory == nullptr || larger == nullptr)
        return larger;
    std::size_t before = 0;
    {
        const std::scoped_lock lock(mutex);
        before = taken.at(memory);
    }
    std::memcpy(larger, memory, std::min(before, size));
    give_back(user, memory);
    return larger;
}

std::atomic<int> asked_for{0};
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL own_functions(VkInstance instance, const char* name) {
    ++asked_for;
    return vkGetInstanceProcAddr(instance, name);
}

bool check(const sunfleck::Status& status) {
    if (!status)
        std::fprintf(stderr, "%s\n", status.error().message.c_str());
    return bool(status);
}

struct Scene {
    std::unique_ptr<host::Context> context;
    std::uint32_t room = 0;
};

sunfleck::Result<Scene> make_scene(const VulkanProgram& program) {
    Scene scene;
    host::VulkanHandles handles{program.instance, program.physical_device, program.device, program.queue, 0};
    handles.get_instance_proc_addr = own_functions;
    SUNFLECK_ASSIGN(scene.context, host::Context::create(handles));
    SUNFLECK_TRY(scene.context->set("lights", "20"));
    const std::vector<float> corners = cube_positions();
    SUNFLECK_ASSIGN(const std::uint32_t mesh, scene.context->add_mesh({corners, {}, cube_indices(true), {}}));
    const host::Matrix4 larger = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1};
    SUNFLECK_ASSIGN(scene.room, scene.context->add_instance({mesh, larger, host::Mobility::fixed, {0.7f, 0.6f, 0.5f}}));
    SUNFLECK_TRY(scene.context->add_light({host::LightKind::point, {5, 4, 3}, {1.5f, 2.7f, 1.5f}}));
    return scene;
}

bool draw(VulkanProgram& program, const Scene& scene) {
    const host::Camera camera{{1.0f, 1.2f, 2.9f}, {0.0f, -0.1f, -1.0f}, {0.0f, 1.0f, 0.0f}, 1.0f};
    constexpr std::uint32_t width = VulkanProgram::width, height = VulkanProgram::height;
    std::vector<Box> boxes = {{{0, 0, 0}, 3}};
    bool good = true;
    program.frame(
        boxes,
        [&] {
            good = check(scene.context->update({program.serial, program.completed}));
            boxes[0].surface = scene.context->surface_id(scene.room);
        },
        [&] { return host::view_projection(camera, width, height); },
        [&](VkCommandBuffer commands) {
            const host::ImageState after{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                         VK_ACCESS_2_MEMORY_READ_BIT};
            host::FrameImages images{width, height};
            const std::pair<host::HostImage*, TargetImage*> all[] = {{&images.depth, &program.depth},
                                                                     {&images.normals, &program.normals},
                                                                     {&images.surface, &program.surface},
                                                                     {&images.irradiance, &program.irradiance}};
            for (const auto& [to, from] : all)
                *to = {from->image, from->view, {from->now.layout, from->now.stages, from->now.access}, after};
            good = good && check(scene.context->record(commands, camera, images));
            for (const auto& [to, from] : all)
                from->now = {after.layout, after.stages, after.access};
        });
    return good;
}

bool draw_all(const VkAllocationCallbacks& callbacks) {
    VulkanProgram program(2, host::enable_features, {}, &callbacks);
    sunfleck::Result<Scene> scene = make_scene(program);
    if (!scene)
        return check(scene.error());
    bool good = true;
    for (int frame = 0; frame < 4 && good; ++frame)
        good = draw(program, *scene);
    program.wait();
    bool finite = false;
    const auto mean = program.mean_irradiance(finite);
    scene->context.reset();
    std::printf("callbacks and functions of its own: mean irradiance %.4f W/m2, %d functions asked for, %d validation "
                "messages\n",
                mean[0], asked_for.load(), program.messages);
    return good && finite && mean[0] > 0.2 && asked_for > 0 && program.messages == 0;
}

} // namespace

int run_own_loader() {
    const VkAllocationCallbacks callbacks{nullptr, allocate, reallocate, give_back, nullptr, nullptr};
    const bool good = draw_all(callbacks);
    const std::scoped_lock lock(mutex);
    if (!taken.empty())
        std::printf("%zu of the driver's allocations were not given back\n", taken.size());
    return good && taken.empty() ? 0 : 1;
}

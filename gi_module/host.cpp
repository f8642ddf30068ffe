// The plain interface for foreign hosts: a context, from the host's device to settings.
#include "gi_module/host_context.h"

namespace sunfleck::host {

std::vector<std::string> missing_features(VkPhysicalDevice physical_device) {
    return gpu::missing_features(physical_device);
}

void enable_features(VkPhysicalDeviceFeatures* features, VkPhysicalDeviceVulkan12Features* features12,
                     VkPhysicalDeviceVulkan13Features* features13) {
    const gpu::RequiredFeatures required;
    // Each struct is a header and then nothing but VkBool32.
    const auto enable = [](const void* from, void* to, std::size_t header, std::size_t size) {
        const auto* wanted = reinterpret_cast<const VkBool32*>(static_cast<const char*>(from) + header);
        auto* target = reinterpret_cast<VkBool32*>(static_cast<char*>(to) + header);
        for (std::size_t i = 0; i < (size - header) / sizeof(VkBool32); ++i)
            target[i] = target[i] != VK_FALSE || wanted[i] != VK_FALSE ? VK_TRUE : VK_FALSE;
    };
    if (features != nullptr)
        enable(&required.features.features, features, 0, sizeof *features);
    if (features12 != nullptr)
        enable(&required.features12, features12, offsetof(VkPhysicalDeviceVulkan12Features, samplerMirrorClampToEdge),
               offsetof(VkPhysicalDeviceVulkan12Features, subgroupBroadcastDynamicId) + sizeof(VkBool32));
    if (features13 != nullptr)
        enable(&required.features13, features13, offsetof(VkPhysicalDeviceVulkan13Features, robustImageAccess),
               offsetof(VkPhysicalDeviceVulkan13Features, maintenance4) + sizeof(VkBool32));
}

Context::Context() : implementation_(std::make_unique<Implementation>()) {}

Context::~Context() {
    // Passes of the last frame refer to the rest.
    implementation_->graph.reset();
}

Result<std::unique_ptr<Context>> Context::create(const VulkanHandles& handles) {
    if (handles.instance == VK_NULL_HANDLE || handles.physical_device == VK_NULL_HANDLE ||
        handles.device == VK_NULL_HANDLE || handles.queue == VK_NULL_HANDLE)
        return Error{"a context needs an instance, a physical device, a device and a queue"};
    std::unique_ptr<Context> context(new Context());
    Implementation& self = *context->implementation_;
    gpu::HostDevice host;
    host.instance = handles.instance;
    host.physical_device = handles.physical_device;
    host.device = handles.device;
    host.queue = handles.queue;
    host.queue_family = handles.queue_family;
    SUNFLECK_ASSIGN(self.device, gpu::Device::adopt(host));
    scene::register_components(self.registry);
    self.shaders.add(gi::shaders());
    self.pipelines = std::make_unique<gpu::PipelineStore>(*self.device, self.shaders);
    self.resources = std::make_unique<gpu::FrameResources>(*self.device);
    self.timers = std::make_unique<gpu::Timers>(*self.device);
    self.graph = std::make_unique<gpu::FrameGraph>(self.device.get());
    self.gpu_scene = std::make_unique<scene::GpuScene>(*self.device);
    SUNFLECK_ASSIGN(self.rays, raytrace::RayScene::create());
    SUNFLECK_ASSIGN(self.system, gi::System::create(*self.device, *self.pipelines));
    SUNFLECK_ASSIGN(self.conversion, gi::GBufferConversion::create(*self.device, *self.pipelines));
    return context;
}

Status Context::set(std::string_view name, std::string_view value) {
    Implementation& self = *implementation_;
    if (const Field* field = gi::SensorSettings::description().find(name))
        return self.set_for_sensors(*field, value);
    gi::Settings changed = self.settings;
    SUNFLECK_TRY(changed.set(name, value));
    SUNFLECK_TRY(self.system->set_settings(changed));
    self.settings = changed;
    return {};
}

} // namespace sunfleck::host

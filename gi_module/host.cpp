// The plain interface for foreign hosts: a context, from the host's device to settings.
#include "gi_module/host_context.h"

#include <thread>

namespace sunfleck::host {

namespace {

sunfleck::LogSink engine_sink(const LogSink& log) {
    if (!log)
        return {};
    return [&log](sunfleck::LogLevel level, std::string_view message) {
        log(level == sunfleck::LogLevel::error     ? LogLevel::error
            : level == sunfleck::LogLevel::warning ? LogLevel::warning
                                                   : LogLevel::information,
            message);
    };
}

Status check_handle(const void* handle, const char* name) {
    return handle != nullptr ? Status() : Status(wrong(std::string(name) + " is null"));
}

Status check_handles(const VulkanHandles& handles) {
    SUNFLECK_TRY(check_handle(handles.instance, "VulkanHandles::instance"));
    SUNFLECK_TRY(check_handle(handles.physical_device, "VulkanHandles::physical_device"));
    SUNFLECK_TRY(check_handle(handles.device, "VulkanHandles::device"));
    return check_handle(handles.queue, "VulkanHandles::queue");
}

} // namespace

Result<std::vector<std::string>> missing_features(VkInstance instance, VkPhysicalDevice physical_device,
                                                  PFN_vkGetInstanceProcAddr get_instance_proc_addr) {
    return guarded(
        {},
        [&]() -> Result<std::vector<std::string>> {
            SUNFLECK_TRY(check_handle(instance, "instance"));
            SUNFLECK_TRY(check_handle(physical_device, "physical_device"));
            if (get_instance_proc_addr == nullptr)
                get_instance_proc_addr = gpu::loader_functions();
            if (get_instance_proc_addr == nullptr)
                return Error{"the Vulkan loader (libvulkan.so.1) was not found", ErrorCode::unsupported};
            SUNFLECK_ASSIGN(const gpu::InstanceFunctions vk,
                            gpu::InstanceFunctions::load(instance, get_instance_proc_addr));
            return gpu::missing_features(vk, physical_device);
        },
        __func__);
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
    implementation_->let_go_if_wanted();
}

Context::Implementation::Turn::Turn(Implementation& of) : context(of), taken(!of.busy.exchange(true)) {
    if (!taken)
        return;
    while (context.readers > 0) // new ones find it busy
        std::this_thread::yield();
    context.let_go_if_wanted();
}

Context::Implementation::Turn::~Turn() {
    if (!taken)
        return;
    context.let_go_if_wanted();
    context.busy = false;
}

namespace {

bool begin_reading(const std::atomic<bool>& busy, std::atomic<int>& readers) {
    if (busy) // without being counted, so that whoever asks again and again keeps no call waiting
        return false;
    ++readers;
    if (!busy) // now either this sees the call under way, or that call sees the reader
        return true;
    --readers;
    return false;
}

} // namespace

Context::Implementation::Reading::Reading(const Implementation& of)
    : context(of), allowed(begin_reading(of.busy, of.readers)) {}

Context::Implementation::Reading::~Reading() {
    if (allowed)
        --context.readers;
}

void Context::Implementation::let_go_if_wanted() {
    if (!abandon_wanted || abandoned)
        return;
    abandoned = true;
    device->abandon();
}

void Context::abandon() {
    Implementation& self = *implementation_;
    self.abandon_wanted = true;
    const Implementation::Turn turn(self);
}

Result<std::unique_ptr<Context>> Context::create(const VulkanHandles& handles, LogSink log) {
    const sunfleck::LogSink engine_log = engine_sink(log);
    return guarded(
        engine_log,
        [&]() -> Result<std::unique_ptr<Context>> {
            SUNFLECK_TRY(check_handles(handles));
            std::unique_ptr<Context> context(new Context());
            Implementation& self = *context->implementation_;
            gpu::HostDevice host;
            host.instance = handles.instance;
            host.physical_device = handles.physical_device;
            host.device = handles.device;
            host.queue = handles.queue;
            host.queue_family = handles.queue_family;
            host.get_instance_proc_addr = handles.get_instance_proc_addr;
            host.enabled_features = handles.enabled_features;
            SUNFLECK_ASSIGN(self.device, gpu::Device::adopt(host));
            self.shaders.add(gi::shaders());
            self.pipelines = std::make_unique<gpu::PipelineStore>(*self.device, self.shaders);
            self.resources = std::make_unique<gpu::FrameResources>(*self.device);
            self.timers = std::make_unique<gpu::Timers>(*self.device);
            // Here, so that a device that will not do is found at once.
            SUNFLECK_ASSIGN(self.follower,
                            Follower::create(*self.device, *self.pipelines, self.description, self.settings));
            self.log = std::move(log);
            self.engine_log = engine_sink(self.log);
            return context;
        },
        __func__);
}

Status Context::Implementation::check_ready() const {
    if (!abandoned)
        return {};
    return Error{"the context was abandoned, because its device is gone", ErrorCode::device_lost};
}

Status Context::set(std::string_view name, std::string_view value) {
    Implementation& self = *implementation_;
    return self.run([&]() -> Status {
        SUNFLECK_TRY(self.check_ready());
        if (const Field* field = gi::SensorSettings::description().find(name))
            return self.set_for_sensors(*field, value);
        gi::Settings changed = self.settings;
        if (const Status status = changed.set(name, value); !status)
            return wrong(status.error().message);
        if (const Status status = changed.validate(); !status)
            return wrong(status.error().message);
        if (self.follower != nullptr && !self.damaged) {
            self.damaged = true; // should memory run out within
            const Status status = self.follower->system->set_settings(changed);
            self.damaged = false;
            if (!status)
                return wrong(status.error().message);
        }
        self.settings = std::move(changed);
        return {};
    });
}

} // namespace sunfleck::host

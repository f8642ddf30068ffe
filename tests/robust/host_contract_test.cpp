// Every call of sunfleck/host.h, in any order and with any value: right, or an error that names what was wrong and
// leaves all as it was.
#include "engine/core/log.h"
#include "engine/core/memory_limit.h"
#include "tests/support/host_program.h"

#include <thread>

namespace sunfleck::tests {
namespace {

using host::LightKind;
using host::Mobility;

class RobustHost : public GpuTest {};

TEST_F(RobustHost, MissingFeaturesNeedNoContext) {
    const auto missing = host::missing_features(device().instance(), device().physical_device());
    ASSERT_TRUE(missing) << missing.error().message;
    EXPECT_TRUE(missing->empty());
    expect_argument(without_value(host::missing_features(VK_NULL_HANDLE, device().physical_device())), "instance");
    expect_argument(without_value(host::missing_features(device().instance(), VK_NULL_HANDLE)), "physical_device");
}

// The loader's functions, but for a device that says that it knows another version, or lacks features.
std::uint32_t claimed_version = VK_API_VERSION_1_3;
VkBool32 VkPhysicalDeviceVulkan13Features::*claimed_missing = nullptr;
bool claims_no_feature = false;

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL claiming_functions(VkInstance instance, const char* name) {
    static const PFN_vkGetInstanceProcAddr real = gpu::loader_functions();
    static PFN_vkGetPhysicalDeviceProperties real_properties = nullptr;
    static PFN_vkGetPhysicalDeviceFeatures2 real_features = nullptr;
    const PFN_vkVoidFunction function = real(instance, name);
    if (std::string_view(name) == "vkGetPhysicalDeviceProperties") {
        real_properties = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(function);
        return reinterpret_cast<PFN_vkVoidFunction>(
            +[](VkPhysicalDevice device, VkPhysicalDeviceProperties* properties) {
                real_properties(device, properties);
                properties->apiVersion = claimed_version;
            });
    }
    if (std::string_view(name) == "vkGetPhysicalDeviceFeatures2") {
        real_features = reinterpret_cast<PFN_vkGetPhysicalDeviceFeatures2>(function);
        return reinterpret_cast<PFN_vkVoidFunction>(+[](VkPhysicalDevice device, VkPhysicalDeviceFeatures2* features) {
            auto* of12 = static_cast<VkPhysicalDeviceVulkan12Features*>(features->pNext);
            auto* of13 = static_cast<VkPhysicalDeviceVulkan13Features*>(of12->pNext);
            if (!claims_no_feature)
                real_features(device, features);
            if (claimed_missing != nullptr)
                of13->*claimed_missing = VK_FALSE;
        });
    }
    return function;
}

TEST_F(RobustHost, MissingFeaturesAreNamed) {
    using Names = std::vector<std::string>;
    const auto missing = [&] {
        return host::missing_features(device().instance(), device().physical_device(), claiming_functions).value();
    };
    for (const auto& [version, lacks] :
         {std::pair(VK_API_VERSION_1_2, Names{"Vulkan 1.3"}), std::pair(VK_API_VERSION_1_3, Names{}),
          std::pair(VK_MAKE_API_VERSION(0, 1, 4, 300), Names{})}) {
        claimed_version = version;
        EXPECT_EQ(missing(), lacks) << VK_API_VERSION_MINOR(version);
    }
    claimed_version = VK_API_VERSION_1_3;
    claimed_missing = &VkPhysicalDeviceVulkan13Features::synchronization2;
    EXPECT_EQ(missing(), Names{"synchronization2"});
    claimed_missing = nullptr;
    claims_no_feature = true;
    EXPECT_EQ(missing(), gpu::required_feature_names());
    claims_no_feature = false;
}

TEST_F(RobustHost, HandlesThatWillNotDoAreRefusedByName) {
    const HostProgram program(device());
    const host::VulkanHandles good = program.handles();
    const auto refused = [&](const auto& change, const char* word) {
        host::VulkanHandles handles = good;
        change(handles);
        expect_argument(without_value(host::Context::create(handles)), word);
    };
    refused([](auto& handles) { handles.instance = VK_NULL_HANDLE; }, "VulkanHandles::instance");
    refused([](auto& handles) { handles.physical_device = VK_NULL_HANDLE; }, "VulkanHandles::physical_device");
    refused([](auto& handles) { handles.device = VK_NULL_HANDLE; }, "VulkanHandles::device");
    refused([](auto& handles) { handles.queue = VK_NULL_HANDLE; }, "VulkanHandles::queue");
    refused([](auto& handles) { handles.queue_family = 77; }, "queue family 77");

    VkPhysicalDeviceVulkan13Features of13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features of12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &of13};
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &of12};
    host::enable_features(&features.features, &of12, &of13);
    host::VulkanHandles handles = good;
    handles.enabled_features = &features;
    EXPECT_TRUE(host::Context::create(handles));
    of13.synchronization2 = VK_FALSE;
    const auto lacking = host::Context::create(handles);
    ASSERT_FALSE(lacking);
    EXPECT_EQ(lacking.error().code, ErrorCode::unsupported);
    EXPECT_NE(lacking.error().message.find("synchronization2"), std::string::npos) << lacking.error().message;
}

// An instance of Vulkan 1.1 with a device of its own.
struct OldProgram {
    gpu::InstanceFunctions vk;
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;

    OldProgram() {
        const PFN_vkGetInstanceProcAddr get = gpu::loader_functions();
        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
        application.apiVersion = VK_API_VERSION_1_1;
        VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        info.pApplicationInfo = &application;
        const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"));
        EXPECT_EQ(create(&info, nullptr, &instance), VK_SUCCESS);
        vk = gpu::InstanceFunctions::load(instance, get).value();
        std::uint32_t one = 1;
        vk.vkEnumeratePhysicalDevices(instance, &one, &physical_device);
        const float priority = 1.0f;
        VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
        queues.queueCount = 1;
        queues.pQueuePriorities = &priority;
        VkDeviceCreateInfo description{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
        description.queueCreateInfoCount = 1;
        description.pQueueCreateInfos = &queues;
        EXPECT_EQ(vk.vkCreateDevice(physical_device, &description, nullptr, &device), VK_SUCCESS);
        reinterpret_cast<PFN_vkGetDeviceQueue>(vk.vkGetDeviceProcAddr(device, "vkGetDeviceQueue"))(device, 0, 0,
                                                                                                   &queue);
    }
    ~OldProgram() {
        reinterpret_cast<PFN_vkDestroyDevice>(vk.vkGetDeviceProcAddr(device, "vkDestroyDevice"))(device, nullptr);
        vk.vkDestroyInstance(instance, nullptr);
    }
};

TEST_F(RobustHost, InstancesOfOlderVulkanAreRefused) {
    const OldProgram program;
    const auto context =
        host::Context::create({program.instance, program.physical_device, program.device, program.queue, 0});
    ASSERT_FALSE(context);
    EXPECT_EQ(context.error().code, ErrorCode::unsupported);
    EXPECT_NE(context.error().message.find("1.3"), std::string::npos) << context.error().message;
}

TEST_F(RobustHost, MeshesAreRemovedAndTheirMemoryFreed) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    const HostPicture before = picture_of_room(program, *context);
    std::vector<float> positions;
    std::vector<std::uint32_t> indices(30000);
    for (std::uint32_t i = 0; i < 30000; ++i) {
        indices[i] = i;
        positions.insert(positions.end(), {0.01f * float(i % 97), 0.01f * float(i % 89), 0.01f * float(i % 83)});
    }
    const std::uint32_t large = context->add_mesh({positions, {}, indices, {}}).value();
    const std::uint32_t instance =
        context->add_instance({large, box_matrix(vec3(0, 1, 0), vec3(0.5f)), Mobility::moving}).value();
    ASSERT_TRUE(program.frame(*context, 0));
    const auto mesh_memory = [&] {
        double sum = 0;
        for (const host::Statistic& use : context->statistics().memory)
            if (use.name.find("mesh") != std::string::npos)
                sum += use.value;
        return sum;
    };
    const double with = mesh_memory();
    expect_argument(context->remove_mesh(large), "instance " + std::to_string(instance));
    ASSERT_TRUE(context->remove_instance(instance));
    ASSERT_TRUE(context->remove_mesh(large));
    expect_argument(context->remove_mesh(large), "there is no mesh");
    expect_argument(without_value(context->add_instance({large})), "there is no mesh");
    EXPECT_EQ(picture_of_room(program, *context), before);
    for (int i = 0; i < 3; ++i) // until no frame in flight can read it
        ASSERT_TRUE(program.frame(*context, 0));
    EXPECT_LT(mesh_memory(), 0.1 * with) << "MiB";
}

TEST_F(RobustHost, ClearedContextsAreLikeNewOnes) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    const HostPicture first = picture_of_room(program, *context);
    ASSERT_TRUE(context->add_light({LightKind::sky, {1, 1, 1}}));
    ASSERT_TRUE(program.settle(*context, 0));
    EXPECT_NE(program.picture(), first);
    ASSERT_TRUE(context->clear());
    EXPECT_EQ(context->surface_id(0), 0u);
    expect_argument(context->set_transform(0, host::identity), "there is no instance 0");
    ASSERT_TRUE(program.frame(*context, 0)) << "an empty scene";
    describe_room(*context);
    EXPECT_EQ(picture_of_room(program, *context), first);
}

TEST_F(RobustHost, AbandonedContextsCallNothingOfVulkan) {
    auto other = gpu::Device::create({}).value();
    std::unique_ptr<host::Context> context;
    {
        HostProgram program(*other);
        context = host::Context::create(program.handles()).value();
        describe_room(*context);
        ASSERT_TRUE(program.frame(*context, 0));
        program.wait();
    }
    context->abandon();
    other.reset(); // with everything that the context made on it; the driver frees it or leaks it
    const Status update = context->update({});
    ASSERT_FALSE(update);
    EXPECT_EQ(update.error().code, ErrorCode::device_lost);
    EXPECT_TRUE(context->statistics().memory.empty());
    context.reset();
}

// Contexts share nothing: frames of two threads are as those of one, on a device of their own or on the same one, whose
// queue has a lock.
TEST_F(RobustHost, TwoThreadsHaveContextsOfTheirOwn) {
    const auto light_a_story = [](gpu::Device& device, HostPicture& picture) {
        HostProgram program(device);
        const auto context = make_context(program);
        describe_room(*context);
        for (int i = 0; i < 10; ++i) {
            const float x = 0.1f * float(i);
            ASSERT_TRUE(context->set_transform(1, box_matrix(vec3(x, 0.6f, 0), vec3(0.6f))));
            ASSERT_TRUE(program.frame(*context, 0));
        }
        picture = picture_of_room(program, *context);
    };
    HostPicture alone;
    light_a_story(device(), alone);
    auto other_device = gpu::Device::create({}).value();
    for (gpu::Device* const of_other : {other_device.get(), &device()}) {
        HostPicture beside[2];
        std::thread other([&] { light_a_story(*of_other, beside[1]); });
        light_a_story(device(), beside[0]);
        other.join();
        EXPECT_EQ(beside[0], alone);
        EXPECT_EQ(beside[1], alone) << (of_other == &device() ? "on one device" : "on two");
    }
}

TEST_F(RobustHost, MemoryLimitsAreTheHosts) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    ASSERT_TRUE(context->set("shadow_map_resolution", "2048"));
    host::set_memory_limit(std::uint64_t(1) << 20);
    const Status refused = program.frame(*context, 0);
    host::set_memory_limit(0);
    if (device().traits().shares_memory) { // others have memory of their own
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::memory);
        EXPECT_NE(refused.error().message.find("set_memory_limit"), std::string::npos) << refused.error().message;
    }
    ASSERT_TRUE(context->set("shadow_map_resolution", "32"));
    EXPECT_TRUE(program.settle(*context, 0));
}

// What a context copies is counted before it is taken; nothing has changed then.
TEST_F(RobustHost, CopiesBeyondTheMemoryLimitAreRefused) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    const HostPicture expected = picture_of_room(program, *context);
    const std::vector<std::uint8_t> pixels(std::size_t(4096) * 4096 * 4, 200);
    host::MaterialData textured;
    textured.albedo_texture = {pixels, 4096, 4096};
    const std::vector<float> positions(3'000'000 * 3, 1.0f);
    const std::vector<std::uint32_t> indices = {0, 1, 2};
    const auto expect_refused = [](const Status& status, const char* what) {
        ASSERT_FALSE(status) << what;
        EXPECT_EQ(status.error().code, ErrorCode::memory) << status.error().message;
        EXPECT_NE(status.error().message.find(what), std::string::npos) << status.error().message;
    };
    host::set_memory_limit(memory_in_use() + (std::uint64_t(32) << 20));
    const auto material = context->add_material(textured);
    const auto mesh = context->add_mesh({positions, {}, indices, {}});
    host::set_memory_limit(0);
    expect_refused(without_value(material), "4096x4096 texels would take 64.0 MiB");
    expect_refused(without_value(mesh), "3000000 vertices would take 68.7 MiB");
    EXPECT_EQ(context->add_mesh(cube(true)).value(), 2u);
    EXPECT_EQ(picture_of_room(program, *context), expected);
}

TEST_F(RobustHost, SettingsThatNeverFitAreRefusedAtOnce) {
    HostProgram program(device());
    const auto context = make_context(program);
    ASSERT_TRUE(context->set("shadow_map_resolution", "2048"));
    expect_argument(context->set("shadow_memory", "1"), "shadow_map_resolution");
    describe_room(*context);
    EXPECT_TRUE(context->set("shadow_memory", "64"));
}

TEST_F(RobustHost, ExceptionsOfCallbacksEndTheUpdateAlone) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    host::Frame frame = program.next_frame();
    frame.progress = [](float) -> bool { throw 7; };
    const Status thrown = context->update(frame);
    ASSERT_FALSE(thrown);
    EXPECT_NE(thrown.error().message.find("exception"), std::string::npos) << thrown.error().message;
    frame.progress = [](float) { return false; };
    const Status stopped = context->update(frame);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::stopped) << stopped.error().message;
    program.submit_empty();
    const HostPicture picture = picture_of_room(program, *context);
    const auto fresh = make_context(program);
    describe_room(*fresh);
    EXPECT_EQ(picture_of_room(program, *fresh), picture);
}

// The second context has the same to say as the first, of a light by the same number.
TEST_F(RobustHost, EveryContextWarnsItsOwnHostOnce) {
    std::vector<std::string> said, to_all;
    set_log_sink([&](sunfleck::LogLevel, std::string_view text) { to_all.emplace_back(text); });
    for (int i = 0; i < 2; ++i) {
        HostProgram program(device());
        const auto context = make_context(program, [&](host::LogLevel level, std::string_view text) {
            EXPECT_EQ(level, host::LogLevel::warning) << text;
            said.emplace_back(text);
        });
        describe_room(*context);
        host::InstanceData lamp{1, box_matrix(vec3(0, 2, 0), vec3(1e-12f))};
        lamp.emission = {9, 9, 9};
        ASSERT_TRUE(context->add_instance(lamp));
        for (int frame = 0; frame < 3; ++frame)
            ASSERT_TRUE(program.frame(*context, 0));
    }
    set_log_sink({});
    ASSERT_EQ(said.size(), 2u);
    EXPECT_NE(said[0].find("no area"), std::string::npos) << said[0];
    EXPECT_EQ(said[0], said[1]);
    EXPECT_TRUE(to_all.empty()) << to_all.front();
}

} // namespace
} // namespace sunfleck::tests

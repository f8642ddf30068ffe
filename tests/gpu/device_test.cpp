// Device, memory, faults, determinism, shader replacement.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "engine/gpu/texel_formats.h"
#include "engine/shader_compiler/shader_compiler.h"
#include "test_places.h"

#include <bit>
#include <fstream>
#include <thread>
#include <vector>

namespace sunfleck::tests {
namespace {

class DeviceTest : public GpuTest {};

TEST_F(DeviceTest, UnknownDevicesAreNamedInOneMessage) {
    gpu::DeviceOptions options;
    options.device = "no such device";
    const auto device = gpu::Device::create(options);
    ASSERT_FALSE(device);
    EXPECT_NE(device.error().message.find("no such device"), std::string::npos);
    EXPECT_NE(device.error().message.find("0 '"), std::string::npos) << "it says which there are";
}

TEST_F(DeviceTest, TwoDevicesLiveSideBySide) {
    auto other = gpu::Device::create({}).value();
    gpu::HostDevice host{other->instance(), other->physical_device(), other->handle(),
                         other->queue(),    other->queue_family(),    nullptr};
    auto adopted = gpu::Device::adopt(host);
    ASSERT_TRUE(adopted) << adopted.error().message;
    auto renderer = viewer::SceneRenderer::create(**adopted);
    ASSERT_TRUE(renderer) << renderer.error().message;
    GpuWorld world(assets::make_cornell, "view");
    world.render();
}

// No message of validation's, and no memory taken.
TEST_F(DeviceTest, TexelsOverTheDevicesLimitAreRefused) {
    const std::uint64_t before = device().memory().total();
    for (const auto& [format, bytes] :
         {std::pair(VK_FORMAT_R16_UNORM, 2), std::pair(VK_FORMAT_R32_UINT, 4), std::pair(VK_FORMAT_R32G32_UINT, 8)}) {
        gpu::BufferDescription description;
        description.name = "many texels";
        description.size = (device().traits().max_texel_elements + 1) * std::uint64_t(bytes);
        description.usage = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
        description.texel_format = format;
        const auto buffer = gpu::Buffer::create(device(), description);
        ASSERT_FALSE(buffer) << bytes;
        EXPECT_EQ(buffer.error().code, ErrorCode::unsupported) << buffer.error().message;
        EXPECT_NE(buffer.error().message.find("'many texels'"), std::string::npos) << buffer.error().message;
    }
    EXPECT_EQ(device().memory().total(), before);
}

// Else some drivers would compile kernels again where a buffer has another size.
TEST_F(DeviceTest, SizesOfTexelBuffersAreOfOneKind) {
    std::vector<std::uint64_t> sizes{16, 240, 255, 256, 257, 65536 - 256, 65536, 3 * 65536 + 200, 1 << 20, 5 << 20};
    for (std::uint64_t size = 1; size <= std::uint64_t(1) << 33; size *= 2)
        sizes.insert(sizes.end(), {size, size + 4});
    for (const std::uint64_t size : sizes) {
        const std::uint64_t made = gpu::texel_buffer_bytes(size);
        EXPECT_GE(made, size);
        EXPECT_LE(made, size + 272);
        EXPECT_FALSE(std::has_single_bit(made)) << size;
        EXPECT_NE(made & 0xff00u, 0u) << size;
    }
    gpu::BufferDescription description{"texels", 65536, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT};
    description.texel_format = VK_FORMAT_R32_UINT;
    const gpu::Buffer buffer = gpu::Buffer::create(device(), description).value();
    EXPECT_EQ(buffer.size(), 65536u) << "whoever asked for so many sees no more";
    VkMemoryRequirements needs;
    device().vk.vkGetBufferMemoryRequirements(device().handle(), buffer.handle(), &needs);
    EXPECT_GE(needs.size, gpu::texel_buffer_bytes(65536));
}

TEST_F(DeviceTest, MemoryIsHandedOutWithoutOverlapAndGivenBack) {
    const std::uint64_t before = device().memory().total();
    RandomSequence random(SequenceKind::pseudo_random, 1, 1);
    std::vector<gpu::Buffer> buffers;
    std::vector<std::uint8_t> marks;
    for (int step = 0; step < 2000; ++step) {
        if (!buffers.empty() && random.next() < 0.45f) {
            const std::size_t victim = std::size_t(random.next() * float(buffers.size()));
            for (VkDeviceSize i = 0; i < buffers[victim].size(); ++i)
                ASSERT_EQ(std::uint8_t(buffers[victim].mapped()[i]), marks[victim]);
            buffers[victim] = std::move(buffers.back());
            marks[victim] = marks.back();
            buffers.pop_back();
            marks.pop_back();
            continue;
        }
        gpu::BufferDescription description;
        description.name = "test";
        description.size = 1 + VkDeviceSize(random.next() * 20000.0f);
        description.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        description.memory = gpu::MemoryUse::upload;
        buffers.push_back(gpu::Buffer::create(device(), description).value());
        marks.push_back(std::uint8_t(step));
        std::memset(buffers.back().mapped(), marks.back(), buffers.back().size());
    }
    EXPECT_GT(device().memory().usage().at("test"), 0u);
    buffers.clear();
    EXPECT_EQ(device().memory().total(), before);
}

// Function-table entries that fail on their n-th use.
int calls_until_failure = 0;
PFN_vkAllocateMemory true_allocate = nullptr;
PFN_vkQueueSubmit2 true_submit = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL failing_allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
    if (--calls_until_failure < 0)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return true_allocate(device, info, callbacks, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL failing_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits,
                                              VkFence fence) {
    if (--calls_until_failure < 0)
        return VK_ERROR_DEVICE_LOST;
    return true_submit(queue, count, submits, fence);
}

TEST_F(DeviceTest, RunningOutOfMemoryIsOneClearMessageWhereverItHappens) {
    int failures = 0;
    for (int allowed = 0; allowed < 12; ++allowed) {
        auto own = gpu::Device::create({}).value();
        true_allocate = own->vk.vkAllocateMemory;
        own->vk.vkAllocateMemory = failing_allocate;
        calls_until_failure = allowed;
        auto renderer = viewer::SceneRenderer::create(*own);
        Status status;
        if (!renderer) {
            status = renderer.error();
        } else {
            assets::SceneBuilder builder((*renderer)->registry(), (*renderer)->meshes());
            assets::make_cornell(builder);
            scene::update_world_transforms((*renderer)->registry());
            status = (*renderer)->upload_meshes();
            viewer::FrameRequest request;
            if (status)
                status = (*renderer)->render_and_wait(request);
        }
        if (status)
            continue;
        ++failures;
        EXPECT_NE(status.error().message.find("Not enough memory"), std::string::npos) << status.error().message;
        EXPECT_NE(status.error().message.find("MiB of GPU memory for '"), std::string::npos) << status.error().message;
    }
    EXPECT_GT(failures, 3);
}

// Blocks of memory that the driver has given and not got back.
int memory_blocks = 0;
PFN_vkFreeMemory true_free = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL counting_allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                 const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
    ++memory_blocks;
    return true_allocate(device, info, callbacks, memory);
}

VKAPI_ATTR void VKAPI_CALL counting_free(VkDevice device, VkDeviceMemory memory,
                                         const VkAllocationCallbacks* callbacks) {
    --memory_blocks;
    true_free(device, memory, callbacks);
}

// 64 MiB in pieces that share blocks: of those that are empty one is kept, and none at rest.
TEST_F(DeviceTest, EmptyBlocksOfMemoryGoBackToTheDriver) {
    auto own = gpu::Device::create({}).value();
    own->memory().free_spares();
    true_allocate = own->vk.vkAllocateMemory;
    true_free = own->vk.vkFreeMemory;
    own->vk.vkAllocateMemory = counting_allocate;
    own->vk.vkFreeMemory = counting_free;
    memory_blocks = 0;
    {
        std::vector<gpu::Buffer> buffers;
        buffers.reserve(256);
        for (int i = 0; i < 256; ++i)
            buffers.push_back(gpu::Buffer::create(*own, {"piece", 256 * 1024, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                         gpu::MemoryUse::device, VK_FORMAT_UNDEFINED})
                                  .value());
        EXPECT_GE(memory_blocks, 2);
        EXPECT_LT(memory_blocks, 256);
    }
    EXPECT_EQ(memory_blocks, 1);
    own->memory().free_spares();
    EXPECT_EQ(memory_blocks, 0);
}

TEST_F(DeviceTest, ALostDeviceIsOneClearMessage) {
    auto own = gpu::Device::create({}).value();
    auto renderer = viewer::SceneRenderer::create(*own).value();
    assets::SceneBuilder builder(renderer->registry(), renderer->meshes());
    assets::make_cornell(builder);
    scene::update_world_transforms(renderer->registry());
    ASSERT_TRUE(renderer->upload_meshes());
    true_submit = own->vk.vkQueueSubmit2;
    own->vk.vkQueueSubmit2 = failing_submit;
    calls_until_failure = 1;
    viewer::FrameRequest request;
    request.width = request.height = 16;
    ASSERT_TRUE(renderer->render_and_wait(request));
    const Status status = renderer->render_and_wait(request);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("GPU stopped answering"), std::string::npos) << status.error().message;
    own->vk.vkQueueSubmit2 = true_submit;
}

TEST_F(DeviceTest, TwoRunsAndOneAndTwoThreadsGiveTheSameBits) {
    const auto run = [](std::size_t threads) {
        const ThreadLimit limit(threads);
        GpuWorld world(assets::make_four_pillars, "bench_1");
        world.request.tone_map = false;
        world.request.view = shared::view_final;
        gi::Settings settings = plain_light();
        settings.lights = 200;
        settings.shadow_map_resolution = 128;
        world.set(settings);
        io::Picture picture;
        for (std::uint64_t step = 0; step < 4; ++step) {
            world.request.step = step;
            picture = world.picture();
        }
        return picture;
    };
    const io::Picture one = run(1), two = run(2), again = run(2);
    EXPECT_EQ(std::memcmp(one.pixels.data(), two.pixels.data(), one.pixels.size() * sizeof(vec4)), 0);
    EXPECT_EQ(std::memcmp(two.pixels.data(), again.pixels.data(), one.pixels.size() * sizeof(vec4)), 0);
}

// A level that loads on one thread while another shows pictures.
TEST_F(DeviceTest, ThreadsWithSubmissionsOfTheirOwnShareTheDevice) {
    const auto render = [] {
        GpuWorld world(assets::make_four_pillars, "bench_1");
        std::vector<io::Picture> pictures;
        for (std::uint64_t step = 0; step < 4; ++step) {
            world.request.step = step;
            pictures.push_back(world.picture());
        }
        return pictures;
    };
    const std::vector<io::Picture> alone = render();
    std::vector<io::Picture> first, second;
    std::thread other([&] { second = render(); });
    first = render();
    other.join();
    for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_EQ(first[i].pixels, alone[i].pixels) << "picture " << i;
        EXPECT_EQ(second[i].pixels, alone[i].pixels) << "picture " << i;
    }
}

TEST_F(DeviceTest, OddPictureSizes) {
    GpuWorld world(assets::make_cornell, "view");
    gi::Settings settings = plain_light();
    settings.lights = 8;
    settings.low_resolution = 4; // see ManyLightTest.PicturesTooLargeForTheDevicesBuffersAreRefusedByName
    settings.shadow_map_resolution = 32;
    world.set(settings);
    for (const auto& [width, height] :
         {std::pair(1u, 1u), std::pair(1u, 300u), std::pair(257u, 3u), std::pair(4096u, 4096u)}) {
        world.request.width = width;
        world.request.height = height;
        const io::Picture picture = world.picture();
        EXPECT_EQ(picture.pixels.size(), std::size_t(width) * height);
    }
    world.request.width = 1u << 20;
    const Status status = world.renderer->render_and_wait(world.request);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("limit"), std::string::npos);
}

TEST_F(DeviceTest, ACameraInsideAWallStillGivesAPicture) {
    GpuWorld world(assets::make_four_pillars);
    world.request.camera.position = vec3(1.7f, 1.0f, 1.7f); // in a pillar
    world.request.camera.target = vec3(0.0f, 1.0f, 0.0f);
    for (const vec4& pixel : world.picture().pixels)
        ASSERT_TRUE(is_finite(vec3(pixel)));
}

TEST_F(DeviceTest, ShadersAreReplacedAtRunTimeAndBrokenOnesKeepTheOld) {
    GpuWorld world(assets::make_cornell, "view");
    world.request.view = shared::view_albedo;
    const io::Picture before = world.picture();
    const std::string path = "engine/render/composition.comp";
    std::ifstream file(std::string(SUNFLECK_SOURCE_DIR) + "/" + path);
    std::string source((std::istreambuf_iterator<char>(file)), {});
    const std::string line = "imageStore(output_image, pixel, value);";
    source.replace(source.find(line), line.size(), "imageStore(output_image, pixel, value * 2.0);");
    const auto words = shader_compiler::compile(path, source, SUNFLECK_SOURCE_DIR);
    ASSERT_TRUE(words) << words.error().message;
    ASSERT_TRUE(world.renderer->replace_shader(path, *words));
    const io::Picture after = world.picture();
    int compared = 0;
    for (std::size_t i = 0; i < before.pixels.size(); ++i)
        if (before.pixels[i].w > 0.0f) {
            EXPECT_EQ(after.pixels[i], before.pixels[i] * 2.0f);
            ++compared;
        }
    EXPECT_GT(compared, 100);
    const auto broken = shader_compiler::compile(path, "#version 460\nvoid main() { nonsense }\n", SUNFLECK_SOURCE_DIR);
    ASSERT_FALSE(broken);
    EXPECT_NE(broken.error().message.find("composition.comp"), std::string::npos);
    EXPECT_NE(broken.error().message.find("nonsense"), std::string::npos);
    EXPECT_FALSE(world.renderer->replace_shader("no/such.comp", *words));
}

} // namespace
} // namespace sunfleck::tests

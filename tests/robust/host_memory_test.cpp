// Memory of a host whose frames go on and on: what is in use in the last half of them does not grow.
// The long size has 20,000 frames (SUNFLECK_FRAMES: another number).
#include "tests/robust/host_story.h"

#include <algorithm>
#include <fstream>
#include <malloc.h>
#include <unistd.h>

namespace sunfleck::tests {
namespace {

struct Memory {
    std::int64_t resident = 0, heap = 0, gpu = 0; // B
};

Memory memory_now(const host::Context& context) {
    Memory memory;
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages;
    memory.resident = pages * sysconf(_SC_PAGESIZE);
    const struct mallinfo2 heap = mallinfo2();
    memory.heap = std::int64_t(heap.uordblks + heap.hblkhd);
    for (const host::Statistic& part : context.statistics().memory)
        memory.gpu += std::int64_t(part.value * 1048576);
    return memory;
}

// From the middle to the end, each as the least of a tenth of all: what frames in flight hold comes and goes.
std::int64_t growth(const std::vector<Memory>& samples, std::int64_t Memory::*part) {
    const auto least = [&](std::size_t first) {
        std::int64_t value = samples[first].*part;
        for (std::size_t i = first; i < first + samples.size() / 10; ++i)
            value = std::min(value, samples[i].*part);
        return value;
    };
    return least(samples.size() - samples.size() / 10) - least(samples.size() / 2);
}

class RobustHostMemory : public GpuTest {};

TEST_F(RobustHostMemory, DoesNotGrowWithItsFrames) {
    const int count = int(number_from_environment("SUNFLECK_FRAMES", by_size(1000u, 20000u)));
    HostProgram program(device());
    auto created = host::Context::create(program.handles());
    ASSERT_TRUE(created) << created.error().message;
    host::Context& context = **created;
    ASSERT_TRUE(Story::begin(context));
    auto lamp = context.add_light({host::LightKind::point, {3, 3, 5}, {0, 1, 0}});
    ASSERT_TRUE(lamp) << lamp.error().message;
    std::vector<Memory> samples;
    samples.reserve(std::size_t(count));
    for (int frame = 0; frame < count; ++frame) {
        const float t = 0.1f * float(frame % 63); // all turns end within a tenth of the frames
        ASSERT_TRUE(context.set_transform(1, box_matrix(vec3(std::sin(t), 0.6f, std::cos(t)), vec3(0.6f))));
        ASSERT_TRUE(context.set_light(
            *lamp, {host::LightKind::point, {3, 3, 5}, {std::cos(2 * t), 1.5f + 0.5f * std::sin(3 * t), 0.5f}}));
        // Something comes, and what came a frame ago goes.
        const auto guest =
            context.add_instance({1, box_matrix(vec3(-0.8f, 0.4f, -0.8f), vec3(0.3f)), host::Mobility::moving});
        ASSERT_TRUE(guest) << guest.error().message;
        if (frame > 0) {
            ASSERT_TRUE(context.remove_instance(*guest - 1));
        }
        ASSERT_TRUE(program.frame(context, 0));
        samples.push_back(memory_now(context));
    }
    program.wait();
    const std::int64_t resident = growth(samples, &Memory::resident), heap = growth(samples, &Memory::heap),
                       gpu = growth(samples, &Memory::gpu);
    std::printf("| host | %d | | %.1f | %.0f | %.1f | %.0f |\n", count, double(samples.back().resident) / 1e6,
                double(resident) / 1e3, double(samples.back().heap) / 1e6, double(heap) / 1e3);
    EXPECT_LT(resident, 1 << 20);
    // None, but for what the least moment of a frame differs by. In shorter runs, the log of removals fills: of each
    // light that is set, up to 4,096.
    EXPECT_LT(heap, count >= 10000 ? 1 << 10 : 1 << 16);
    EXPECT_EQ(gpu, 0) << "B of memory that the device's allocations have";
}

} // namespace
} // namespace sunfleck::tests

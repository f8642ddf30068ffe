// A Vulkan layer that writes when each picture was handed to the window: a line for each vkQueuePresentKHR, in
// nanoseconds of CLOCK_MONOTONIC, to the file that SUNFLECK_PRESENT_TIMES names. It measures programs as they are,
// those of earlier commits, too.
#include "tests/support/vulkan_layer.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace sunfleck::layer {
namespace {

void write_time() {
    static std::FILE* file = [] {
        const char* path = std::getenv("SUNFLECK_PRESENT_TIMES");
        std::FILE* opened = path != nullptr ? std::fopen(path, "w") : nullptr;
        if (opened != nullptr)
            std::setvbuf(opened, nullptr, _IOLBF, 1 << 12);
        return opened;
    }();
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (file != nullptr)
        std::fprintf(file, "%lld\n", 1000000000LL * now.tv_sec + now.tv_nsec);
}

VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR* info) {
    const VkResult result = device_of(queue).function<PFN_vkQueuePresentKHR>("vkQueuePresentKHR")(queue, info);
    write_time();
    return result;
}

} // namespace

PFN_vkVoidFunction own_device_function(const char* name) {
    return std::strcmp(name, "vkQueuePresentKHR") == 0 ? untyped(present) : nullptr;
}

void device_made(VkDevice) {}

} // namespace sunfleck::layer

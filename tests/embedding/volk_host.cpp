// The same program with volk's global function pointers, which have the names of the loader's own functions, and for a
// version of Vulkan that is newer than what the module was written for.
#define VOLK_IMPLEMENTATION
#include "vulkan_program.h"

#include "own_loader.h"

#include <cstdio>

int main() {
    std::printf("volk host, Vulkan %u.%u: ", VK_API_VERSION_MAJOR(VulkanProgram::version),
                VK_API_VERSION_MINOR(VulkanProgram::version));
    return run_own_loader();
}

// Keeps the software driver and the validation layer in memory to the end, so that leak reports can tell their leaks
// from ours by module (tests/leak_suppressions.txt).
#pragma once

#include <dlfcn.h>
#include <initializer_list>

namespace sunfleck::tests {

inline void pin_driver() {
    for (const char* library : {"libvulkan_lvp.so", "libVkLayer_khronos_validation.so"})
        (void)dlopen(library, RTLD_NOW | RTLD_NODELETE);
}

} // namespace sunfleck::tests

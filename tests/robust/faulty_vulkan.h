// Vulkan as a host hands it over, in which any call can be made to fail: the n-th one that returns a VkResult, with any
// code. Counts what is made and given back.
#pragma once

#include "engine/gpu/functions.h"

#include <array>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sunfleck::tests {

namespace faulty {

#define SUNFLECK_NAME(name) #name,
inline constexpr std::array fallible_names = {SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(SUNFLECK_NAME)};
inline constexpr std::array destroying_names = {SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_NAME)};
#undef SUNFLECK_NAME

struct State {
    std::uint64_t calls = 0;   // of functions that can fail
    std::uint64_t fail_at = 0; // the call that fails, from 1; 0: none
    VkResult code = VK_ERROR_OUT_OF_HOST_MEMORY;
    std::string failed; // the function that failed
    std::int64_t live = 0;
    std::vector<std::uint8_t> sequence;                   // which function each call is
    std::set<std::pair<std::uint8_t, const void*>> sites; // functions, and where calls of them return to
    std::vector<std::uint64_t> first_of_sites;            // the first call at each of them, by number
    int within = 0;                                       // calls under way, on this thread
    bool names_fail = false;                              // of objects, for captures
    std::uint64_t names_failed = 0;
    std::array<void*, fallible_names.size()> real{};
    std::array<void*, destroying_names.size()> real_destroying{};
    PFN_vkGetDeviceProcAddr get_device = nullptr;
    PFN_vkGetInstanceProcAddr get_instance = nullptr;
};
// All calls are of the thread that uses the context.
inline State state;

inline bool makes_objects(std::string_view name) {
    return name.substr(0, 8) == "vkCreate" || name == "vkAllocateMemory";
}

template <std::size_t Index, typename... Arguments>
VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
    ++state.within;
    state.sequence.push_back(std::uint8_t(Index));
    ++state.calls;
    if (state.sites.emplace(std::uint8_t(Index), __builtin_return_address(0)).second)
        state.first_of_sites.push_back(state.calls);
    if (state.calls == state.fail_at) {
        state.failed = fallible_names[Index];
        --state.within;
        return state.code;
    }
    const VkResult result = reinterpret_cast<VkResult(VKAPI_PTR*)(Arguments...)>(state.real[Index])(arguments...);
    --state.within;
    if (result >= 0 && makes_objects(fallible_names[Index]))
        ++state.live;
    return result;
}

template <typename... Rest>
bool is_null(VkDevice, std::uint64_t handle, Rest...) {
    return handle == 0;
}
template <typename Handle, typename... Rest>
bool is_null(VkDevice, Handle* handle, Rest...) {
    return handle == nullptr;
}

template <std::size_t Index, typename... Arguments>
VKAPI_ATTR void VKAPI_CALL destroy(Arguments... arguments) {
    if (!is_null(arguments...))
        --state.live;
    ++state.within;
    reinterpret_cast<void(VKAPI_PTR*)(Arguments...)>(state.real_destroying[Index])(arguments...);
    --state.within;
}

template <std::size_t Index, typename... Arguments>
PFN_vkVoidFunction wrapper(VkResult(VKAPI_PTR*)(Arguments...)) {
    return reinterpret_cast<PFN_vkVoidFunction>(&call<Index, Arguments...>);
}
template <std::size_t Index, typename... Arguments>
PFN_vkVoidFunction wrapper(void(VKAPI_PTR*)(Arguments...)) {
    return reinterpret_cast<PFN_vkVoidFunction>(&destroy<Index, Arguments...>);
}

template <std::size_t N>
constexpr std::size_t place_of(const std::array<const char*, N>& names, std::string_view name) {
    for (std::size_t i = 0; i < N; ++i)
        if (names[i] == name)
            return i;
    return N;
}

inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device, const char* name) {
    const PFN_vkVoidFunction function = state.get_device(device, name);
    const std::string_view wanted = name;
#define SUNFLECK_WRAP(one)                                                                                             \
    if (constexpr std::size_t place = place_of(fallible_names, #one); wanted == #one) {                                \
        state.real[place] = reinterpret_cast<void*>(function);                                                         \
        return wrapper<place>(PFN_##one(nullptr));                                                                     \
    }
    SUNFLECK_FALLIBLE_DEVICE_FUNCTIONS(SUNFLECK_WRAP)
#undef SUNFLECK_WRAP
#define SUNFLECK_WRAP(one)                                                                                             \
    if (constexpr std::size_t place = place_of(destroying_names, #one); wanted == #one) {                              \
        state.real_destroying[place] = reinterpret_cast<void*>(function);                                              \
        return wrapper<place>(PFN_##one(nullptr));                                                                     \
    }
    SUNFLECK_DESTROYING_DEVICE_FUNCTIONS(SUNFLECK_WRAP)
#undef SUNFLECK_WRAP
    return function;
}

inline VKAPI_ATTR VkResult VKAPI_CALL fail_to_name(VkDevice, const VkDebugUtilsObjectNameInfoEXT*) {
    ++state.names_failed;
    return VK_ERROR_OUT_OF_HOST_MEMORY;
}

// For host::VulkanHandles.
inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance_proc_addr(VkInstance instance, const char* name) {
    state.get_instance = gpu::loader_functions();
    const PFN_vkVoidFunction function = state.get_instance(instance, name);
    if (state.names_fail && std::string_view(name) == "vkSetDebugUtilsObjectNameEXT")
        return reinterpret_cast<PFN_vkVoidFunction>(&fail_to_name);
    if (std::string_view(name) != "vkGetDeviceProcAddr")
        return function;
    state.get_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(function);
    return reinterpret_cast<PFN_vkVoidFunction>(&get_device_proc_addr);
}

// The errors that the Vulkan specification lists for a function (`errorcodes` of its registry vk.xml). Left out:
//   VK_ERROR_UNKNOWN, which any command may return: unknown_errors_test.cpp has a case for each place that calls one
//   VK_ERROR_INVALID_EXTERNAL_HANDLE: no memory is imported
//   VK_ERROR_INVALID_OPAQUE_CAPTURE_ADDRESS: no address of a capture is asked for
//   VK_ERROR_COMPRESSION_EXHAUSTED_EXT: no image asks for compression
//   VK_ERROR_VALIDATION_FAILED: of layers that may refuse calls, which a debug callback has to ask for
inline std::vector<VkResult> codes_of(std::string_view name) {
    std::vector<VkResult> codes = {VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY};
    if (name == "vkMapMemory")
        codes.push_back(VK_ERROR_MEMORY_MAP_FAILED);
    if (name == "vkAllocateMemory" || name == "vkCreateSampler")
        codes.push_back(VK_ERROR_TOO_MANY_OBJECTS);
    if (name == "vkAllocateDescriptorSets")
        codes.insert(codes.end(), {VK_ERROR_FRAGMENTED_POOL, VK_ERROR_OUT_OF_POOL_MEMORY});
    if (name == "vkCreateDescriptorPool")
        codes.push_back(VK_ERROR_FRAGMENTATION);
    if (name == "vkCreateShaderModule" || name == "vkCreateComputePipelines" || name == "vkCreateGraphicsPipelines")
        codes.push_back(VK_ERROR_INVALID_SHADER_NV);
    if (name == "vkGetQueryPoolResults" || name == "vkDeviceWaitIdle" || name == "vkQueueSubmit2" ||
        name == "vkWaitSemaphores" || name == "vkGetSemaphoreCounterValue")
        codes.push_back(VK_ERROR_DEVICE_LOST);
    return codes;
}

} // namespace faulty

} // namespace sunfleck::tests

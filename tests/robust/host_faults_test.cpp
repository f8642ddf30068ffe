// Whatever call of Vulkan's fails, and wherever memory runs out: the call of the host's returns an error that names the
// step, nothing leaks, and after errors of memory the next frames lead to the picture that they would have led to.
#include "tests/robust/faulty_vulkan.h"
#include "tests/robust/host_story.h"

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>
#include <set>
#include <tbb/task_scheduler_observer.h>
#include <thread>

// Where the program's own code begins and ends, from the linker.
extern "C" {
extern const char __executable_start, etext;
}

namespace sunfleck::tests {
namespace {

// Which allocation of this thread fails, from 1; 0: none.
thread_local std::uint64_t allocations = 0, failing_allocation = 0;
thread_local bool counting = false;
// The same of all other threads together, while they are counted: those that share the work of parallel loops.
std::atomic<std::uint64_t> others_allocations{0}, others_failing_allocation{0};
std::atomic<bool> counting_others{false};

// Of threads that share the work of parallel loops. The driver has threads, too.
thread_local bool shares_loops = false;

class WorkerObserver : public tbb::task_scheduler_observer {
public:
    WorkerObserver() { observe(true); }
    ~WorkerObserver() override { observe(false); }
    void on_scheduler_entry(bool is_worker) override { shares_loops = is_worker; }
};

// `caller`: who allocates. Only code of this program, which the module is linked into, while it is called as a host
// calls it: how the driver, the validation layer and Embree bear it is their own affair.
bool allocation_fails(const void* caller) noexcept {
    if (counting_others && shares_loops)
        return caller >= &__executable_start && caller < &etext && ++others_allocations == others_failing_allocation;
    if (!counting || host_calls == 0 || faulty::state.within > 0 || caller < &__executable_start || caller >= &etext)
        return false;
    return ++allocations == failing_allocation;
}

void* try_to_allocate(std::size_t size, const void* caller) noexcept {
    return allocation_fails(caller) ? nullptr : std::malloc(size > 0 ? size : 1);
}
void* allocate(std::size_t size, const void* caller) {
    if (void* memory = try_to_allocate(size, caller))
        return memory;
    throw std::bad_alloc();
}

} // namespace
} // namespace sunfleck::tests

// The program's own; libraries that it loads take them, too. All kinds but those that are aligned beyond malloc: what
// one of these hands out comes back to one of these, and the address sanitizer sees malloc and free beneath all of
// them.
[[gnu::noinline]] void* operator new(std::size_t size) {
    return sunfleck::tests::allocate(size, __builtin_return_address(0));
}
[[gnu::noinline]] void* operator new[](std::size_t size) {
    return sunfleck::tests::allocate(size, __builtin_return_address(0));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return sunfleck::tests::try_to_allocate(size, __builtin_return_address(0));
}
[[gnu::noinline]] void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
    return sunfleck::tests::try_to_allocate(size, __builtin_return_address(0));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}

namespace sunfleck::tests {
namespace {

class RobustHostFaults : public GpuTest {
protected:
    void SetUp() override {
        GpuTest::SetUp();
        faulty::state = {};
    }
};

struct Outcome {
    std::vector<Error> errors; // of the calls that failed
    bool lost = false;
    HostPicture picture;
};

// All of it, from create to the settled picture. After an error of memory the call is repeated.
Outcome play(HostProgram& program) {
    Outcome outcome;
    const auto failed = [&](const Status& status) {
        if (status)
            return false;
        outcome.errors.push_back(status.error());
        outcome.lost = status.error().code == ErrorCode::device_lost;
        return true;
    };
    host::VulkanHandles handles = program.handles();
    handles.get_instance_proc_addr = faulty::get_instance_proc_addr;
    auto context = [&] {
        const HostCall call;
        return host::Context::create(handles);
    }();
    if (!context) {
        failed(context.error());
        context = host::Context::create(handles);
    }
    EXPECT_TRUE(context) << context.error().message;
    if (failed(Story::begin(**context))) {
        EXPECT_TRUE((*context)->clear());
        EXPECT_TRUE(Story::begin(**context));
    }
    Story story;
    for (int frame = 0; frame < frames && !outcome.lost; ++frame) {
        if (failed(story.step(**context, frame))) {
            EXPECT_TRUE(story.step(**context, frame));
        }
        const HostOptions options = Story::show(program, frame);
        if (failed(program.frame(**context, 0, options)) && !outcome.lost) {
            EXPECT_TRUE(program.frame(**context, 0, options));
        }
    }
    program.resize(false);
    counting = false;
    // The frames until the picture has settled make calls, too.
    if (!outcome.lost && failed(program.settle(**context, 0)) && !outcome.lost) {
        EXPECT_TRUE(program.settle(**context, 0));
    }
    if (!outcome.lost)
        outcome.picture = program.picture();
    program.wait();
    context = Error{};
    return outcome;
}

// One of the project's names of steps, and the result's: "creating buffer 'x' failed: VK_ERROR_OUT_OF_DEVICE_MEMORY".
// For programs, the code says which kind it is.
void expect_named(const Error& error, VkResult result) {
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (memory || result == VK_ERROR_DEVICE_LOST) {
        EXPECT_EQ(error.code, memory ? ErrorCode::memory : ErrorCode::device_lost) << error.message;
    }
    EXPECT_NE(error.message.find("failed: VK_"), std::string::npos) << error.message;
    EXPECT_GT(error.message.find("failed"), 8u) << error.message;
}

// A frame without times is right, too, and another pool does as well as one that is used up.
bool may_be_ignored(const std::string& function, VkResult code) {
    return function == "vkCreateQueryPool" || (function == "vkGetQueryPoolResults" && code != VK_ERROR_DEVICE_LOST) ||
           (function == "vkAllocateDescriptorSets" &&
            (code == VK_ERROR_FRAGMENTED_POOL || code == VK_ERROR_OUT_OF_POOL_MEMORY));
}

struct FaultTally {
    std::uint64_t tried = 0, refused = 0, lost = 0, without_effect = 0;
};

// Call number `call` fails with `code`.
void try_fault(HostProgram& program, std::uint64_t call, VkResult code, const HostPicture& expected,
               FaultTally& tally) {
    faulty::state = {};
    faulty::state.fail_at = call;
    faulty::state.code = code;
    const Outcome outcome = play(program);
    SCOPED_TRACE("call " + std::to_string(call) + ", " + faulty::state.failed + ", result " + std::to_string(code));
    EXPECT_EQ(faulty::state.live, 0) << "objects of Vulkan's leak";
    EXPECT_LE(outcome.errors.size(), 1u);
    ++tally.tried;
    ++(outcome.lost ? tally.lost : outcome.errors.empty() ? tally.without_effect : tally.refused);
    if (outcome.errors.empty()) {
        EXPECT_TRUE(may_be_ignored(faulty::state.failed, code)) << "nobody noticed";
    } else {
        expect_named(outcome.errors.front(), code);
    }
    if (!outcome.lost) {
        EXPECT_EQ(outcome.picture, expected);
    }
}

// A share: each function once, at a place by the seed; under sanitizers, where a story takes two seconds, each third.
std::vector<std::uint64_t> some_calls(const std::vector<std::uint8_t>& sequence, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::vector<std::uint64_t>> places(faulty::fallible_names.size());
    for (std::size_t i = 0; i < sequence.size(); ++i)
        places[sequence[i]].push_back(i + 1);
    std::vector<std::uint64_t> calls;
    for (std::size_t i = 0, of = sanitized() && !long_size() ? 3 : 1; i < places.size(); ++i)
        if (const auto& list = places[i]; !list.empty() && i % of == 0)
            calls.push_back(list[random() % list.size()]);
    return calls;
}

TEST_F(RobustHostFaults, EveryCallOfVulkanMayFail) {
    HostProgram program(device());
    const HostPicture expected = play(program).picture;
    const std::vector<std::uint8_t> sequence = faulty::state.sequence;
    EXPECT_EQ(faulty::state.live, 0);
    EXPECT_EQ(play(program).picture, expected) << "the story is not deterministic";
    std::vector<std::uint64_t> calls = some_calls(sequence, 1);
    if (is_piece_of_bench()) {
        const std::uint64_t first = number_from_environment("SUNFLECK_FIRST_SEED", 1);
        const std::uint64_t last = number_from_environment("SUNFLECK_LAST_SEED", sequence.size());
        calls.clear();
        for (std::uint64_t call = first; call <= std::min<std::uint64_t>(last, sequence.size()); ++call)
            calls.push_back(call);
    }
    FaultTally tally;
    for (const std::uint64_t call : calls) {
        const auto codes = faulty::codes_of(faulty::fallible_names[sequence[call - 1]]);
        for (std::size_t i = 0; i < codes.size() && !HasFailure(); ++i)
            if (long_size() || i == call % codes.size())
                try_fault(program, call, codes[i], expected, tally);
    }
    const std::set<std::uint8_t> reached(sequence.begin(), sequence.end());
    using Number = unsigned long long;
    std::printf("%zu calls of %zu functions in %d frames; %llu cases: %llu refused, %llu lost, %llu without effect; "
                "functions not called:",
                sequence.size(), reached.size(), frames, Number(tally.tried), Number(tally.refused), Number(tally.lost),
                Number(tally.without_effect));
    for (std::size_t i = 0; i < faulty::fallible_names.size(); ++i)
        if (reached.count(std::uint8_t(i)) == 0)
            std::printf(" %s", faulty::fallible_names[i]);
    std::puts("");
}

TEST_F(RobustHostFaults, LossIsNoticedWhereTimesAreRead) {
    HostProgram program(device());
    const HostPicture expected = play(program).picture;
    const std::vector<std::uint8_t> sequence = faulty::state.sequence;
    for (std::size_t i = sequence.size(); i-- > 0;)
        if (faulty::fallible_names[sequence[i]] == std::string_view("vkGetQueryPoolResults")) {
            FaultTally tally;
            try_fault(program, i + 1, VK_ERROR_DEVICE_LOST, expected, tally);
            EXPECT_EQ(tally.lost, 1u);
            return;
        }
    ADD_FAILURE() << "no times are read";
}

// Nobody needs them.
TEST_F(RobustHostFaults, NamesOfObjectsMayFail) {
    HostProgram program(device());
    const HostPicture expected = play(program).picture;
    faulty::state = {};
    faulty::state.names_fail = true;
    const Outcome outcome = play(program);
    EXPECT_GT(faulty::state.names_failed, 100u);
    EXPECT_TRUE(outcome.errors.empty());
    EXPECT_EQ(outcome.picture, expected);
    EXPECT_EQ(faulty::state.live, 0);
}

// Allocation number `allocation` of the calling thread fails.
void try_allocation(HostProgram& program, std::uint64_t allocation, const HostPicture& expected) {
    faulty::state = {};
    allocations = 0;
    failing_allocation = allocation;
    counting = true;
    const Outcome outcome = play(program);
    counting = false;
    SCOPED_TRACE("allocation " + std::to_string(allocation));
    EXPECT_EQ(faulty::state.live, 0) << "objects of Vulkan's leak";
    for (const Error& error : outcome.errors) {
        EXPECT_EQ(error.code, ErrorCode::memory) << error.message;
        EXPECT_NE(error.message, "out of memory") << "the step is not named";
        EXPECT_FALSE(error.message.empty());
    }
    EXPECT_EQ(outcome.picture, expected);
}

TEST_F(RobustHostFaults, EveryAllocationMayFail) {
    HostProgram program(device());
    allocations = failing_allocation = 0;
    counting = true;
    const HostPicture expected = play(program).picture;
    counting = false;
    const std::uint64_t count = allocations;
    const std::uint64_t first = number_from_environment("SUNFLECK_FIRST_SEED", 1);
    const std::uint64_t last = number_from_environment("SUNFLECK_LAST_SEED", first + by_size(3u, 9u));
    for (std::uint64_t seed = first; seed <= last && !HasFailure(); ++seed) {
        std::mt19937 random{std::uint32_t(seed)};
        try_allocation(program, 1 + random() % count, expected);
    }
    const std::uint64_t cases = last - first + 1;
    std::printf("%llu allocations; %llu cases\n", static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(cases));
}

// Threads of parallel loops run out of memory: which work they get is chance, so that some seeds meet none.
TEST_F(RobustHostFaults, AllocationsOfOtherThreadsMayFail) {
    HostProgram program(device());
    const WorkerObserver observer;
    const auto play_counted = [&](std::uint64_t failing) {
        faulty::state = {};
        others_allocations = 0;
        others_failing_allocation = failing;
        counting_others = true;
        Outcome outcome = play(program);
        counting_others = false;
        return outcome;
    };
    const HostPicture expected = play_counted(0).picture;
    // On a machine in use they may get next to no work.
    std::uint64_t count = others_allocations;
    for (int again = 0; again < 20 && count == 0; ++again, count = others_allocations)
        play_counted(0);
    if (std::thread::hardware_concurrency() > 1) {
        EXPECT_GT(count, 0u);
    }
    const std::uint64_t first = number_from_environment("SUNFLECK_FIRST_SEED", 1);
    const std::uint64_t last = number_from_environment("SUNFLECK_LAST_SEED", first + by_size(3u, 199u));
    std::uint64_t refused = 0, cases = 0;
    for (std::uint64_t seed = first; seed <= last && count > 0 && !HasFailure(); ++seed) {
        std::mt19937 random{std::uint32_t(seed)};
        const Outcome outcome = play_counted(1 + random() % count);
        ++cases;
        SCOPED_TRACE("seed " + std::to_string(seed));
        EXPECT_EQ(faulty::state.live, 0) << "objects of Vulkan's leak";
        for (const Error& error : outcome.errors)
            EXPECT_EQ(error.code, ErrorCode::memory) << error.message;
        EXPECT_EQ(outcome.picture, expected);
        refused += !outcome.errors.empty();
    }
    if (cases > 50) {
        EXPECT_GT(refused, 0u) << "no allocation failed";
    }
    std::printf("some %llu allocations of other threads; %llu cases, %llu refused\n",
                static_cast<unsigned long long>(count), static_cast<unsigned long long>(cases),
                static_cast<unsigned long long>(refused));
}

} // namespace
} // namespace sunfleck::tests

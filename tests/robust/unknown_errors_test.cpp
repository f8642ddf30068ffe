// VK_ERROR_UNKNOWN, which any command of Vulkan's may return: once at each place of the sources that calls one. The
// call of the host's names it, nothing leaks, and repeating it goes on to the same picture.
#include "tests/robust/faulty_vulkan.h"
#include "tests/robust/host_story.h"

#include <algorithm>

namespace sunfleck::tests {
namespace {

class RobustUnknownErrors : public GpuTest {};

struct UnknownOutcome {
    std::vector<Error> errors;
    HostPicture picture;
};

// Whatever fails is noted and done once more.
UnknownOutcome play_on(HostProgram& program) {
    UnknownOutcome outcome;
    const auto twice = [&](const auto& step) {
        for (int times = 0; times < 2; ++times) {
            const Status status = step();
            if (status)
                return;
            outcome.errors.push_back(status.error());
        }
        ADD_FAILURE() << outcome.errors.back().message;
    };
    host::VulkanHandles handles = program.handles();
    handles.get_instance_proc_addr = faulty::get_instance_proc_addr;
    std::unique_ptr<host::Context> context;
    twice([&]() -> Status {
        SUNFLECK_ASSIGN(context, host::Context::create(handles));
        return {};
    });
    if (!context)
        return outcome;
    twice([&]() -> Status {
        SUNFLECK_TRY(context->clear());
        return Story::begin(*context);
    });
    Story story;
    for (int frame = 0; frame < frames; ++frame) {
        twice([&] { return story.step(*context, frame); });
        twice([&] { return program.frame(*context, 0, Story::show(program, frame)); });
    }
    program.resize(false);
    twice([&] { return program.settle(*context, 0); });
    outcome.picture = program.picture();
    program.wait();
    return outcome;
}

// Errors of which the host learns nothing: a frame without times is right, too.
bool is_passed_over(const std::string& function) {
    return function == "vkCreateQueryPool" || function == "vkGetQueryPoolResults";
}

TEST_F(RobustUnknownErrors, AtEachPlaceThatCallsVulkan) {
    HostProgram program(device());
    faulty::state = {};
    const HostPicture expected = play_on(program).picture;
    const std::vector<std::uint64_t> calls = faulty::state.first_of_sites;
    EXPECT_EQ(faulty::state.live, 0);
    EXPECT_GE(calls.size(), 25u) << "hosts come by more places than that (call_sites_test.cpp)";
    const std::uint64_t first = number_from_environment("SUNFLECK_FIRST_SEED", 1),
                        last = number_from_environment("SUNFLECK_LAST_SEED", calls.size()),
                        step = is_piece_of_bench() ? 1 : by_size(8u, 1u);
    std::size_t tried = 0, passed_over = 0;
    for (std::uint64_t site = first; site <= std::min<std::uint64_t>(last, calls.size()) && !HasFailure();
         site += step) {
        faulty::state = {};
        faulty::state.fail_at = calls[site - 1];
        faulty::state.code = VK_ERROR_UNKNOWN;
        const UnknownOutcome outcome = play_on(program);
        SCOPED_TRACE("call " + std::to_string(calls[site - 1]) + ", " + faulty::state.failed);
        ++tried;
        EXPECT_EQ(faulty::state.live, 0) << "objects of Vulkan's leak";
        EXPECT_EQ(outcome.picture, expected);
        if (is_passed_over(faulty::state.failed) && outcome.errors.empty()) {
            ++passed_over;
            continue;
        }
        ASSERT_EQ(outcome.errors.size(), 1u);
        const std::string& message = outcome.errors.front().message;
        EXPECT_NE(message.find("failed: VK_ERROR_UNKNOWN"), std::string::npos) << message;
        EXPECT_GT(message.find("failed"), 8u) << "names the step: " << message;
    }
    std::printf("%zu places; %zu tried, %zu of them without effect\n", calls.size(), tried, passed_over);
}

} // namespace
} // namespace sunfleck::tests

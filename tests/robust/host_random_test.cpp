// Random sequences of calls, half of them with a value that makes no sense: each is right or refused, and once all is
// cleared, a scene that is described again is lit as in a new context.
#include "tests/robust/host_sequence.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

class RobustHostCalls : public GpuTest {};

std::uint32_t seed_from_environment(const char* name, std::uint32_t otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr ? std::uint32_t(std::strtoul(text, nullptr, 10)) : otherwise;
}

host::LogSink calling(const LogHook& hook) {
    return [&hook](host::LogLevel, std::string_view) {
        if (hook)
            hook();
    };
}

// On a device of its own, which takes what was left on it along; the context goes before the device or after it.
void abandon_a_context(std::uint32_t seed, Tally& sum) {
    auto device = gpu::Device::create({}).value();
    auto program = std::make_unique<HostProgram>(*device);
    LogHook hook;
    // One that may outlive its device: without make_context's wait for that.
    std::unique_ptr<host::Context> context = host::Context::create(program->handles(), calling(hook)).value();
    ASSERT_TRUE(context->set("lights", "16"));
    Sequence sequence(seed, *program, *context, hook);
    for (std::uint32_t i = 0; i < 60 && !testing::Test::HasFailure(); ++i) {
        if (i == 20 + seed % 20)
            sequence.abandon();
        sequence.call();
    }
    if (seed % 2 == 0)
        context.reset();
    program.reset();
    device.reset();
    context.reset();
    sum.add(sequence.tally);
    if (testing::Test::HasFailure())
        ADD_FAILURE() << "seed " << seed << ":" << sequence.log;
}

// All that follows from the scene is made again after this.
void damage(HostProgram& program, host::Context& context) {
    host::Frame frame = program.next_frame();
    frame.progress = [](float) -> bool { throw 1; };
    const Status status = context.update(frame);
    EXPECT_TRUE(status || status.error().code == ErrorCode::other) << status.error().message;
    program.submit_empty();
}

// Refused calls have left nothing: the picture is that of a context which was told only what was accepted. To the bit,
// it depends on the order in which lamps lie in memory, which removals change, and light samples of lamps that move or
// have changed depend on their past, by design: all of it is made anew, with another seed, and everything counts as
// static.
// False: there is nothing to look at.
bool expect_picture_of_what_was_accepted(const Sequence& sequence, HostProgram& program, host::Context& context) {
    const std::optional<std::uint32_t> instance = sequence.an_instance();
    if (!instance)
        return false;
    const auto fresh = make_context(program);
    program.resize(false);
    const Status described = sequence.describe_again(*fresh);
    EXPECT_TRUE(described) << described.error().message;
    const auto settled = [&](host::Context& of) {
        for (const SettingValues& setting : host_settings)
            EXPECT_TRUE(of.set(setting.name, setting.values[0])) << setting.name;
        EXPECT_TRUE(of.set("seed", "77"));
        EXPECT_TRUE(of.set("movers", "static"));
        damage(program, of);
        const Status status = program.settle(of, *instance);
        EXPECT_TRUE(status) << status.error().message;
        return program.picture();
    };
    const HostPicture wanted = settled(*fresh);
    EXPECT_EQ(settled(context), wanted) << "a call that was refused has changed something";
    return true;
}

TEST_F(RobustHostCalls, AreRightOrRefused) {
    const std::uint32_t first = seed_from_environment("SUNFLECK_FIRST_SEED", 1);
    const std::uint32_t last =
        seed_from_environment("SUNFLECK_LAST_SEED", first + by_size(sanitized() ? 3u : 11u, 199u));
    HostProgram program(device());
    LogHook hook;
    auto context = make_context(program, calling(hook));
    auto fresh = make_context(program);
    describe_room(*fresh);
    const HostPicture expected = picture_of_room(program, *fresh);
    fresh.reset();
    ASSERT_EQ(forgotten_settings(), "");
    Tally sum;
    std::uint32_t compared = 0;
    for (std::uint32_t seed = first; seed <= last && !HasFailure(); ++seed) {
        Sequence sequence(seed, program, *context, hook);
        const std::uint32_t calls = 30 + seed * 7 % 71;
        for (std::uint32_t i = 0; i < calls && !HasFailure(); ++i)
            sequence.call();
        sum.add(sequence.tally);
        if (seed % 8 == 4)
            compared += expect_picture_of_what_was_accepted(sequence, program, *context) ? 1 : 0;
        // Contexts are used again. Every eighth one is judged by its picture, every twentieth replaced.
        ASSERT_TRUE(context->clear());
        if (seed % 20 == 0)
            context = make_context(program, calling(hook));
        program.resize(false);
        for (const SettingValues& setting : host_settings)
            ASSERT_TRUE(context->set(setting.name, setting.values[0])) << setting.name;
        if (seed % 8 == 0) {
            describe_room(*context);
            EXPECT_EQ(picture_of_room(program, *context), expected);
            ASSERT_TRUE(context->clear());
        }
        if (HasFailure())
            ADD_FAILURE() << "seed " << seed << ":" << sequence.log;
        else if (seed % 11 == 3) // so that the shortest share has one
            abandon_a_context(seed, sum);
    }
    EXPECT_TRUE(compared > 0 || last - first < 199) << "no sequence had a picture";
    std::printf("seeds %u to %u: %u pictures of what was accepted; tried %llu, refused %llu, right %llu, wrong %llu\n",
                first, last, compared, static_cast<unsigned long long>(sum.tried),
                static_cast<unsigned long long>(sum.refused), static_cast<unsigned long long>(sum.right),
                static_cast<unsigned long long>(sum.wrong));
    for (const auto& [call, times] : sum.calls)
        std::printf("| %s | %llu |\n", call.c_str(), static_cast<unsigned long long>(times));
}

} // namespace
} // namespace sunfleck::tests

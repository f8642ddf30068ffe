// Frames of a host's that do not go as usual: updates that are refused, pictures of another size, images and callbacks
// that will not do. What is refused leaves all as it was, and no call waits for the GPU.
#include "tests/robust/faulty_vulkan.h"
#include "tests/support/host_program.h"

#include <algorithm>

namespace sunfleck::tests {
namespace {

class RobustHostFrames : public GpuTest {};

host::View view_of(const HostProgram& program) {
    host::View view;
    view.view_to_clip = host::view_projection(program.camera(), program.width(), program.height());
    return view;
}

TEST_F(RobustHostFrames, RefusedUpdatesLeaveThePendingOne) {
    HostProgram program(device());
    const auto context = make_context(program);
    describe_room(*context);
    const HostPicture expected = picture_of_room(program, *context);
    const host::Frame frame = program.next_frame();
    ASSERT_TRUE(context->update(frame));
    host::Frame wrong = frame;
    wrong.serial = 0;
    expect_argument(context->update(wrong), "Frame::serial");
    wrong = frame;
    wrong.completed_serial = frame.serial;
    expect_argument(context->update(wrong), "Frame::completed_serial");
    program.draw(context->surface_id(0));
    const Status recorded = context->record(program.commands(), program.camera(), program.images());
    ASSERT_TRUE(recorded) << recorded.error().message;
    program.submit();
    EXPECT_EQ(program.picture(), expected);
}

// The first picture of each size, by a view, with normals that are converted, and light of several techniques that is
// added from images of their own.
TEST_F(RobustHostFrames, NoCallWaitsForTheGpu) {
    faulty::state = {};
    HostProgram program(device());
    host::VulkanHandles handles = program.handles();
    handles.get_instance_proc_addr = faulty::get_instance_proc_addr;
    auto created = host::Context::create(handles);
    ASSERT_TRUE(created) << created.error().message;
    const OwnedContext context(created.value().release(), WaitThenDestroy{&device()});
    describe_room(*context);
    ASSERT_TRUE(context->set("plan", "later_bounces=brute_force"));
    HostOptions options;
    options.shading_normals = true;
    for (int i = 0; i < 8; ++i) {
        program.resize(i % 4 >= 2);
        ASSERT_TRUE(context->update(program.next_frame()));
        program.draw(context->surface_id(0));
        const Status recorded = context->record(program.commands(), view_of(program), program.images(options));
        ASSERT_TRUE(recorded) << recorded.error().message;
        program.submit();
    }
    const auto waits = [](std::uint8_t function) {
        return std::string_view(faulty::fallible_names[function]).find("Wait") != std::string_view::npos;
    };
    const std::vector<std::uint8_t>& calls = faulty::state.sequence;
    EXPECT_GT(calls.size(), 100u);
    EXPECT_EQ(std::count_if(calls.begin(), calls.end(), waits), 0);
}

// Every call that a callback could make, on the context that it is of.
void call_everything(host::Context& context, HostProgram& program) {
    const char* const word = "within another call";
    expect_argument(context.set("lights", "8"), word);
    expect_argument(without_value(context.add_mesh(cube(true))), word);
    expect_argument(context.remove_mesh(0), word);
    expect_argument(without_value(context.add_material({})), word);
    expect_argument(context.set_material(0, {}), word);
    expect_argument(without_value(context.add_instance({0})), word);
    expect_argument(context.set_transform(0, host::identity), word);
    expect_argument(context.set_surface(0, {0, 0, 0}, {0, 0, 0}), word);
    expect_argument(context.remove_instance(0), word);
    expect_argument(without_value(context.add_light({})), word);
    expect_argument(context.set_light(0, {}), word);
    expect_argument(context.remove_light(0), word);
    expect_argument(without_value(context.add_sensor({})), word);
    expect_argument(context.set_sensor(0, {}), word);
    expect_argument(context.remove_sensor(0), word);
    expect_argument(context.step_sensors(), word);
    expect_argument(context.clear(), word);
    expect_argument(context.update({}), word);
    expect_argument(context.record(program.commands(), program.camera(), program.images()), word);
    expect_argument(context.record(program.commands(), view_of(program), program.images()), word);
    EXPECT_TRUE(context.statistics().counters.empty());
    EXPECT_EQ(context.surface_id(0), 0u);
    EXPECT_EQ(context.read_sensor(0).share, 0.0f);
}

TEST_F(RobustHostFrames, CallsFromCallbacksAreRefused) {
    HostProgram program(device());
    const auto undisturbed = make_context(program);
    describe_room(*undisturbed);
    const HostPicture expected = picture_of_room(program, *undisturbed);
    host::Context* of_log = nullptr;
    int logged = 0, shared = 0;
    const auto context = make_context(program, [&](host::LogLevel, std::string_view) {
        ++logged;
        call_everything(*of_log, program);
    });
    of_log = context.get();
    describe_room(*context);
    host::Frame frame = program.next_frame();
    frame.progress = [&](float) {
        ++shared;
        call_everything(*context, program);
        return true;
    };
    ASSERT_TRUE(context->update(frame));
    EXPECT_GT(shared, 0);
    program.draw(context->surface_id(0));
    ASSERT_TRUE(context->record(program.commands(), program.camera(), program.images()));
    program.submit();
    EXPECT_EQ(picture_of_room(program, *context), expected);
    // A light that is left out, which is said.
    host::InstanceData lamp{1, box_matrix(vec3(0, 2, 0), vec3(1e-12f))};
    lamp.emission = {9, 9, 9};
    const std::uint32_t small = context->add_instance(lamp).value();
    ASSERT_TRUE(program.frame(*context, 0));
    EXPECT_GT(logged, 0);
    ASSERT_TRUE(context->remove_instance(small));
    EXPECT_EQ(picture_of_room(program, *context), expected);
}

// What a callback abandons is abandoned once the call has ended.
TEST_F(RobustHostFrames, CallbacksMayAbandon) {
    auto other = gpu::Device::create({}).value();
    auto program = std::make_unique<HostProgram>(*other);
    auto context = host::Context::create(program->handles()).value();
    describe_room(*context);
    host::Frame frame = program->next_frame();
    frame.progress = [&](float) {
        context->abandon();
        return true;
    };
    EXPECT_TRUE(context->update(frame));
    program->submit_empty();
    program.reset();
    other.reset();
    const Status update = context->update({});
    ASSERT_FALSE(update);
    EXPECT_EQ(update.error().code, ErrorCode::device_lost);
}

// Updates that were never recorded may have had any serial: what they held is given back all the same.
TEST_F(RobustHostFrames, SerialsOfFramesThatWereNeverRecordedHoldNothing) {
    HostProgram program(device());
    faulty::state = {};
    host::VulkanHandles handles = program.handles();
    handles.get_instance_proc_addr = faulty::get_instance_proc_addr;
    auto created = host::Context::create(handles);
    ASSERT_TRUE(created) << created.error().message;
    const OwnedContext context(created.value().release(), WaitThenDestroy{&device()});
    describe_room(*context);
    const HostPicture expected = picture_of_room(program, *context);
    const auto jump_and_go_on = [&](int rounds) {
        for (int round = 0; round < rounds; ++round) {
            host::Frame far = program.next_frame();
            far.serial += std::uint64_t(1) << (20 + round);
            ASSERT_TRUE(context->update(far));
            program.submit_empty();
            // Maps and what follows from them are made again, and the old ones kept until frames are finished.
            ASSERT_TRUE(context->set("shadow_map_resolution", round % 2 == 0 ? "64" : "32"));
            for (int frame = 0; frame < 4; ++frame)
                ASSERT_TRUE(program.frame(*context, 0));
        }
    };
    jump_and_go_on(4);
    const std::int64_t live = faulty::state.live;
    jump_and_go_on(20);
    EXPECT_LE(faulty::state.live, live) << "objects of Vulkan's";
    EXPECT_EQ(picture_of_room(program, *context), expected);
}

} // namespace
} // namespace sunfleck::tests

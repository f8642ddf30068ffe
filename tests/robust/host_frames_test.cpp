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

} // namespace
} // namespace sunfleck::tests

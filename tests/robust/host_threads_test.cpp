// Two hosts' contexts on one device, each used by a thread of its own at the same time, with the locks that host.h asks
// for and no more: a host's own for its queue, none for the contexts. Also in the builds with the thread sanitizer.
#include "tests/support/host_program.h"

#include <thread>

namespace sunfleck::tests {
namespace {

class RobustHostThreads : public GpuTest {};

// The life of a context, from create to its end, in a room with its box somewhere else. HostProgram submits under the
// lock of the device's queue.
HostPicture life_of_a_context(float place) {
    HostProgram program(device());
    const OwnedContext context = make_context(program);
    describe_room(*context);
    for (int frame = 0; frame < 6; ++frame) {
        const vec3 centre(place, 0.6f, 0.2f - 0.05f * float(frame));
        const Status moved = context->set_transform(1, box_matrix(centre, vec3(0.6f)));
        EXPECT_TRUE(moved) << moved.error().message;
        if (frame == 3) {
            EXPECT_TRUE(context->set("shadow_map_resolution", "64"));
        }
        const Status drawn = program.frame(*context, 0);
        EXPECT_TRUE(drawn) << drawn.error().message;
        EXPECT_FALSE(context->statistics().counters.empty());
    }
    return picture_of_room(program, *context);
}

TEST_F(RobustHostThreads, ContextsOnOneDeviceShareNothing) {
    const float places[] = {-0.8f, 0.7f};
    const HostPicture alone[] = {life_of_a_context(places[0]), life_of_a_context(places[1])};
    EXPECT_FALSE(alone[0] == alone[1]);
    HostPicture together[2];
    std::thread first([&] { together[0] = life_of_a_context(places[0]); });
    std::thread second([&] { together[1] = life_of_a_context(places[1]); });
    first.join();
    second.join();
    EXPECT_EQ(together[0], alone[0]);
    EXPECT_EQ(together[1], alone[1]);
}

} // namespace
} // namespace sunfleck::tests

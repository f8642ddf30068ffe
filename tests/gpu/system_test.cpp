// gi::System as a whole: several on one registry, frames that never reach the GPU, and updates that a host ends.
#include "tests/support/host_program.h"
#include "tests/support/system_frames.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sunfleck::tests {
namespace {

class Systems : public GpuTest {};

gi::Settings settings_for(std::string_view technique, std::uint32_t lights = 60) {
    gi::Settings settings = gi::Settings().all_light_by(technique);
    settings.lights = lights;
    settings.mover_share = 0.2f; // what the box reflects has a past
    settings.baked_samples = 40; // which takes some frames
    settings.shadow_map_resolution = 64;
    settings.map_budget = 65536;
    return settings;
}

int different_pixels(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    int different = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        different += std::memcmp(&a[i], &b[i], sizeof(vec4)) != 0;
    return different;
}

double largest_difference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, double(glm::length(a[i] - b[i]) / (0.1f + glm::length(b[i]))));
    return largest;
}

// The picture after these steps, by one system alone.
std::vector<vec4> picture_alone(const gi::Settings& settings, std::span<const std::uint64_t> steps) {
    SystemFrames frames(assets::make_four_pillars);
    frames.add(settings);
    for (const std::uint64_t step : steps)
        frames.settle(step);
    return frames.picture();
}

// Two systems with other samples, maps and techniques light the same registry in the same frames.
TEST_F(Systems, TwoLightOneRegistry) {
    const std::uint64_t steps[] = {0, 30, 31};
    const std::vector<std::string_view> names = techniques_for_all_light();
    const gi::Settings first = settings_for(names.front()), second = settings_for(names.back(), 45);
    SystemFrames both(assets::make_four_pillars);
    both.add(first);
    both.add(second);
    for (const std::uint64_t step : steps)
        both.settle(step);
    const std::vector<vec4> alone[] = {picture_alone(first, steps), picture_alone(second, steps)};
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(different_pixels(both.picture(i), alone[i]), 0)
            << "system " << i << ", largest difference " << largest_difference(both.picture(i), alone[i]);
    EXPECT_NE(different_pixels(alone[0], alone[1]), 0);
}

// Where in the course of frames one is lost: the first one, one of those in which light is baked, one in which the box
// moved, and two in a row.
struct Loss {
    const char* name;
    std::vector<std::uint64_t> lost; // frames, by their number
};
const Loss losses[] = {{"the first frame", {0}},
                       {"the second frame", {1}},
                       {"a frame in motion", {42}},
                       {"two frames in motion", {42, 43}},
                       {"first and in motion", {0, 1, 42}}};
constexpr std::uint64_t first_move = 40, frame_count = 46;

// The box rests until light is baked, then moves on each frame. A lost frame is drawn again at the same step, as a host
// would; so the frames that reach the GPU are the same ones.
std::vector<vec4> run(const gi::Settings& settings, const std::vector<std::uint64_t>& lost, Fate fate) {
    SystemFrames frames(make_moving_box_room);
    frames.add(settings);
    for (std::uint64_t i = 0; i < frame_count; ++i) {
        const std::uint64_t step = i < first_move ? 0 : 12 * (i - first_move + 1);
        if (std::find(lost.begin(), lost.end(), i) != lost.end())
            frames.frame(step, fate);
        frames.frame(step);
    }
    EXPECT_EQ(frames.system().counters()["baked_light_waiting"], 0.0);
    EXPECT_EQ(frames.system().counters()["shadow_maps_stale"], 0.0);
    return frames.picture();
}

class LostFrames : public Systems, public testing::WithParamInterface<Fate> {};

TEST_P(LostFrames, LeaveNoTrace) {
    for (const std::string_view technique : techniques_for_all_light()) {
        const gi::Settings settings = settings_for(technique, long_size() ? 60 : 16);
        const std::vector<vec4> undisturbed = run(settings, {}, GetParam());
        for (const Loss& loss : losses) {
            const std::vector<vec4> picture = run(settings, loss.lost, GetParam());
            EXPECT_EQ(different_pixels(picture, undisturbed), 0)
                << technique << ", lost: " << loss.name << "; largest difference "
                << largest_difference(picture, undisturbed);
        }
    }
}

// A mover's step that only the lost frame had seen: the box stops there.
TEST_P(LostFrames, TheLastMoveWasLost) {
    for (const std::string_view technique : techniques_for_all_light()) {
        std::vector<vec4> pictures[2];
        for (const bool loses : {false, true}) {
            SystemFrames frames(make_moving_box_room);
            frames.add(settings_for(technique));
            frames.settle(0);
            if (loses)
                frames.frame(50, GetParam());
            frames.frame(50);
            pictures[loses] = frames.picture();
        }
        EXPECT_EQ(different_pixels(pictures[0], pictures[1]), 0)
            << technique << ", largest difference " << largest_difference(pictures[1], pictures[0]);
    }
}

// Other samples, and more of them, that only an unfinished frame has seen.
TEST_P(LostFrames, NewSamplesAreNotForgotten) {
    for (const std::string_view technique : techniques_for_all_light()) {
        std::vector<vec4> pictures[2];
        for (const bool loses : {false, true}) {
            SystemFrames frames(make_moving_box_room);
            frames.add(settings_for(technique, 30));
            frames.settle(0);
            ASSERT_TRUE(frames.system().set_settings(settings_for(technique, 80)));
            if (loses)
                frames.frame(0, GetParam());
            frames.settle(0);
            pictures[loses] = frames.picture();
        }
        EXPECT_EQ(different_pixels(pictures[0], pictures[1]), 0)
            << technique << ", largest difference " << largest_difference(pictures[1], pictures[0]);
    }
}

std::string fate_name(const testing::TestParamInfo<Fate>& fate) {
    const char* names[] = {"drawn", "stopped", "not_declared", "not_executed", "not_submitted"};
    return names[std::size_t(fate.param)];
}

INSTANTIATE_TEST_SUITE_P(Fates, LostFrames,
                         testing::Values(Fate::stopped, Fate::not_declared, Fate::not_executed, Fate::not_submitted),
                         fate_name);

// Below the room: many fixed cubes, and a mover of many triangles.
void describe_much(host::Context& context) {
    describe_room(context);
    constexpr std::uint32_t cubes = 2500, side = 270;
    for (std::uint32_t i = 0; i < cubes; ++i)
        ASSERT_TRUE(
            context.add_instance({1, box_matrix(vec3(float(i % 50) - 25, -20, float(i) / 50 - 25), vec3(0.5f))}));
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j) {
            const float x = 8.0f * float(i) / side, z = 8.0f * float(j) / side;
            positions.insert(positions.end(), {x, -10.0f + 0.1f * std::sin(3 * x) * std::sin(2 * z), z});
            const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
            if (i < side && j < side)
                indices.insert(indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    const auto field = context.add_mesh({positions, {}, indices, {}});
    ASSERT_TRUE(field);
    ASSERT_TRUE(context.add_instance({*field, host::identity, host::Mobility::moving}));
}

TEST_F(Systems, HostsSeeAndEndWhatComesBeforeTheLight) {
    HostProgram program(device());
    const auto fresh = make_context(program), stopped = make_context(program);
    describe_much(*fresh);
    describe_much(*stopped);
    // Without a visibility database, all that takes long comes before the light.
    for (const char* name : {"direct", "indirect"})
        for (host::Context* context : {fresh.get(), stopped.get()}) {
            ASSERT_TRUE(context->set(name, "brute_force"));
            ASSERT_TRUE(context->set("kept_maps", "off"));
        }
    std::vector<float> shares;
    const auto update = [&](host::Context& context, float until) {
        shares.clear();
        host::Frame frame = program.next_frame();
        frame.progress = [&](float share) {
            shares.push_back(share);
            return share < until;
        };
        const Status status = context.update(frame);
        program.submit_empty();
        return status;
    };
    ASSERT_TRUE(update(*fresh, 2.0f));
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    const auto between = [&](float begin, float end) {
        return std::count_if(shares.begin(), shares.end(), [&](float share) { return share >= begin && share < end; });
    };
    EXPECT_GT(between(0.0f, 0.03f), 1) << "vertices";
    EXPECT_GT(between(0.03f, 0.1f), 1) << "Embree's trees";
    EXPECT_GT(between(0.1f, 0.2f), 0) << "levels of detail";
    ASSERT_TRUE(update(*fresh, 2.0f));
    EXPECT_TRUE(shares.empty()) << "nothing to build";
    // All light, so that patches and visibility come, too.
    for (host::Context* context : {fresh.get(), stopped.get()})
        for (const char* name : {"direct", "indirect"})
            ASSERT_TRUE(context->set(name, "light_samples"));
    // Up to 0.2 geometry is prepared; once that is there, light takes all of the share: samples up to 0.1, patches up
    // to 0.19.
    for (const float until : {0.0f, 0.02f, 0.05f, 0.09f, 0.1f, 0.15f, 0.2f, 0.02f, 0.08f, 0.12f, 0.15f, 0.18f, 0.0f}) {
        const Status status = update(*stopped, until);
        ASSERT_FALSE(status) << until;
        EXPECT_EQ(status.error().code, ErrorCode::stopped) << status.error().message;
        EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << until;
        EXPECT_GE(shares.back(), until);
        EXPECT_LT(shares.back(), until + 0.2f) << "it goes on for long";
    }
    const HostPicture expected = picture_of_room(program, *fresh);
    EXPECT_EQ(picture_of_room(program, *stopped), expected);
    // Of something that comes and goes.
    const std::uint32_t guest = stopped->add_instance({1, box_matrix(vec3(0, 0.3f, 0.6f), vec3(0.5f))}).value();
    ASSERT_FALSE(update(*stopped, 0.0f));
    ASSERT_TRUE(stopped->remove_instance(guest));
    EXPECT_EQ(picture_of_room(program, *stopped), expected);
}

} // namespace
} // namespace sunfleck::tests

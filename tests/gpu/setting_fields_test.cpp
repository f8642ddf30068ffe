// Every described setting does what its flag says: those that need new samples change the samples, all others leave
// them alone. Nothing is listed here: fields, values and flags come from the descriptions.
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"

#include <cmath>
#include <set>

namespace sunfleck::tests {
namespace {

// A lamp that stays, one that moves, a point light and a door: all that samples depend on.
void make_room(assets::SceneBuilder& scene) {
    const vec3 white(0.7f), red(0.7f, 0.3f, 0.3f);
    scene.room(vec3(-2, 0, -2), vec3(2, 2.5f, 2), white, white, {red, white, white, white},
               {{"lamp", vec2(0.5f, 0.3f), 0.6f, 0.6f, vec3(9.0f)}});
    scene::Material glowing = assets::diffuse(vec3(0.0f));
    glowing.emission = vec3(8.0f, 7.0f, 5.0f);
    const ecs::Entity torch = scene.box("torch", vec3(-0.1f), vec3(0.1f), glowing);
    scene.registry().patch<scene::Transform>(torch,
                                             [](scene::Transform& place) { place.position = vec3(1.2f, 1.1f, 0.0f); });
    scene.point_light("bulb", vec3(-1.0f, 2.0f, 1.0f), vec3(1.0f));
    scene::Mover circle;
    circle.path = scene::MoverPath::circle;
    circle.centre = vec3(0.0f, 1.1f, 0.0f);
    scene.mover(torch, circle);
    const ecs::Entity door =
        scene.box("door", vec3(-2.0f, 0.0f, -0.5f), vec3(-0.5f, 2.2f, -0.45f), assets::diffuse(white));
    scene::Mover hinge;
    hinge.path = scene::MoverPath::hinge;
    hinge.centre = vec3(-2.0f, 0.0f, -0.5f);
    scene.mover(door, hinge);
    scene.camera("view", vec3(1.8f, 1.5f, 1.8f), vec3(-1, 1, -1), 60.0f);
}

// Numbers that would only make the test slow or large.
double bounded(const Field& field, double value) {
    static const std::map<std::string_view, double> limits = {
        {"lights", 400}, {"candidates", by_size(64, 1024)}, {"shadow_map_resolution", by_size(256, 2048)}};
    const auto limit = limits.find(field.name);
    return limit == limits.end() ? value : std::min(value, limit->second);
}

std::string text_of(const Field& field, double value) {
    if (field.kind == FieldKind::real)
        return std::to_string(value);
    const double step = field.multiple_of;
    return std::to_string(std::int64_t(std::ceil(bounded(field, value) / step) * step));
}

// Lowest, highest, allowed and some values between; all choices.
std::vector<std::string> values_of(const Field& field) {
    std::vector<std::string> values;
    switch (field.kind) {
    case FieldKind::boolean:
        return {"off", "on"};
    case FieldKind::choice:
        for (const std::string_view choice : field.choices)
            values.emplace_back(choice);
        return values;
    case FieldKind::text:
        return {"", "direct=none", "indirect=none", "dynamic=none", "later_bounces.fixed=none"};
    default:
        break;
    }
    for (const double value : field.allowed)
        values.push_back(text_of(field, value));
    if (!field.allowed.empty())
        return values;
    for (const double value : {field.minimum, field.minimum + 0.25 * (field.maximum - field.minimum), field.maximum})
        values.push_back(text_of(field, value));
    return values;
}

// The flux of what the door reflects follows all other light as it is lit with. `door`: that reflects, null for none.
bool same_samples(std::span<const gi::LightSample> a, std::span<const gi::LightSample> b, ecs::Entity door) {
    const auto same = [&](const gi::LightSample& s, const gi::LightSample& t) {
        const bool same_flux = s.flux == t.flux || (s.dynamic && s.emitter == door);
        return s.kind == t.kind && s.position == t.position && s.normal == t.normal && same_flux &&
               s.bounce == t.bounce && s.radius == t.radius && s.emitter == t.emitter && s.dynamic == t.dynamic &&
               s.punctual == t.punctual;
    };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

class SettingFields : public GpuTest {
protected:
    void SetUp() override {
        GpuTest::SetUp();
        world = std::make_unique<GpuWorld>(make_room, "view");
        base.lights = 60;
        base.shadow_map_resolution = 32;
        base.candidates = 4;
        base.seed = 7;
    }
    // The CPU's part of a frame is all that samples need.
    void update(const gi::Settings& settings) {
        world->set(settings);
        const Status status = world->renderer->update(world->request);
        ASSERT_TRUE(status) << status.error().message;
    }
    ecs::Entity door() { return scene::find_by_name(world->renderer->registry(), "door"); }
    const gi::SampleSet& samples() { return world->renderer->lighting().sample_set(); }

    // Of the frame, and those by which light is refined.
    std::vector<gi::LightSample> all_samples() {
        std::vector<gi::LightSample> all(samples().samples().begin(), samples().samples().end());
        all.insert(all.end(), samples().refining_samples().begin(), samples().refining_samples().end());
        return all;
    }

    // Whether some value of the field gives other samples; a new set of the same samples counts as none.
    bool changes_samples(const gi::Settings& settings, const Field& field) {
        bool changed = false;
        for (const std::string& value : values_of(field)) {
            gi::Settings with = settings;
            const Status status = with.set(field.name, value);
            EXPECT_TRUE(status) << field.name << "=" << value << ": " << status.error().message;
            if (!with.validate())
                continue; // a plan that this base does not allow
            update(settings);
            const std::uint64_t generation = samples().generation();
            const std::vector<gi::LightSample> before = all_samples();
            update(with);
            const bool same = same_samples(before, all_samples(), door());
            changed = changed || !same;
            if ((field.flags & gi::needs_new_samples) == 0) {
                EXPECT_EQ(samples().generation(), generation) << field.name << "=" << value << " made new samples";
                EXPECT_TRUE(same) << field.name << "=" << value << " changed the samples";
            }
            if (!same) {
                EXPECT_NE(samples().generation(), generation) << field.name << "=" << value;
            }
        }
        return changed;
    }

    std::unique_ptr<GpuWorld> world;
    gi::Settings base;
};

TEST_F(SettingFields, ThoseFlaggedChangeTheSamplesAndNoOthersDo) {
    gi::Settings direct_only = base;
    direct_only.with("indirect", "none"); // where it matters which light is sampled
    gi::Settings indirect_only = base;
    indirect_only.with("direct", "none");
    update(base);
    gi::Report report;
    samples().report(report);
    EXPECT_GT(report["light_samples_dynamic"], 0.0);
    int flagged = 0, unflagged = 0;
    for (const std::string_view name : gi::Settings::names()) {
        const Field& field = *gi::Settings::find(name);
        const bool needs = (field.flags & gi::needs_new_samples) != 0;
        ++(needs ? flagged : unflagged);
        const bool changed = changes_samples(base, field) ||
                             (needs && (changes_samples(direct_only, field) || changes_samples(indirect_only, field)));
        const bool has_one_value = field.kind == FieldKind::choice && field.choices.size() == 1;
        EXPECT_EQ(changed, needs && !has_one_value) << name;
    }
    EXPECT_GE(flagged, 12);
    EXPECT_GE(unflagged, 20);
}

// What is not a field at all: another technique's turn at the same light needs no new samples either.
TEST_F(SettingFields, TechniquesShareOneSetOfSamples) {
    std::set<std::uint64_t> generations;
    for (const std::string_view direct : gi::Settings::find("direct")->choices) {
        if (direct == "none")
            continue;
        gi::Settings settings = base;
        update(settings.with("direct", direct));
        generations.insert(samples().generation());
    }
    EXPECT_EQ(generations.size(), 1u);
}

// Samples follow from settings and scene alone: back at the old value, the old samples are back.
TEST_F(SettingFields, OldValuesGiveTheOldSamples) {
    update(base);
    const std::vector<gi::LightSample> before(samples().samples().begin(), samples().samples().end());
    gi::Settings other = base;
    other.seed = 8;
    update(other);
    EXPECT_FALSE(same_samples(before, samples().samples(), {}));
    update(base);
    EXPECT_TRUE(same_samples(before, samples().samples(), {}));
}

} // namespace
} // namespace sunfleck::tests

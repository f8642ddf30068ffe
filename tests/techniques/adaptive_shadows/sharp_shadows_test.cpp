// Shadows of suns, point lights and spots against rays, pixel by pixel.
#include "tests/support/scaled_scene.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_light.h"

#include "engine/scene/procedural.h"

namespace sunfleck::tests {
namespace {

class AnywhereSharpShadows : public GpuTest {};

void add_sun(assets::SceneBuilder& builder, vec3 direction) {
    const ecs::Entity sun = builder.registry().create();
    scene::Transform transform;
    transform.rotation = assets::facing(-glm::normalize(direction)); // shines along its -Z
    builder.registry().emplace<scene::Transform>(sun, transform);
    builder.registry().emplace<scene::DirectionalLight>(sun, {vec3(8.0f)});
}

void add_floor(assets::SceneBuilder& builder, float half) {
    builder.quad("floor", vec3(-half, 0.0f, -half), vec3(0.0f, 0.0f, 2.0f * half), vec3(2.0f * half, 0.0f, 0.0f),
                 assets::diffuse(vec3(0.6f)));
}

void make_chair(assets::SceneBuilder& builder) {
    const scene::Material wood = assets::diffuse(vec3(0.5f, 0.3f, 0.15f));
    add_floor(builder, 5.0f);
    for (const float x : {-0.2f, 0.2f})
        for (const float z : {-0.2f, 0.2f})
            builder.box("leg", vec3(x - 0.02f, 0.0f, z - 0.02f), vec3(x + 0.02f, z < 0.0f ? 0.9f : 0.45f, z + 0.02f),
                        wood);
    builder.box("seat", vec3(-0.22f, 0.45f, -0.22f), vec3(0.22f, 0.48f, 0.22f), wood);
    for (int i = 0; i < 4; ++i)
        builder.box("slat", vec3(-0.18f, 0.55f + 0.09f * float(i), -0.21f),
                    vec3(0.18f, 0.58f + 0.09f * float(i), -0.19f), wood);
    add_sun(builder, vec3(-0.5f, -1.0f, 0.35f));
    builder.camera("view", vec3(1.3f, 1.3f, 2.0f), vec3(-0.1f, 0.3f, 0.1f), 40.0f);
}

// A pole of 2 cm under a point light.
void make_pole(assets::SceneBuilder& builder) {
    add_floor(builder, 4.0f);
    builder.add("pole", scene::make_cylinder(0.01f, 1.5f, 16), assets::diffuse(vec3(0.3f)),
                {.position = vec3(0.0f, 0.75f, 0.0f)});
    builder.point_light("lamp", vec3(-1.0f, 2.2f, 0.6f), vec3(10.0f));
    builder.camera("view", vec3(0.8f, 1.4f, 2.2f), vec3(0.6f, 0.1f, -0.3f), 45.0f);
}

void make_spot(assets::SceneBuilder& builder) {
    add_floor(builder, 4.0f);
    for (int i = 0; i < 5; ++i)
        builder.box("post", vec3(-0.6f + 0.3f * float(i), 0.0f, -0.02f), vec3(-0.57f + 0.3f * float(i), 0.8f, 0.01f),
                    assets::diffuse(vec3(0.4f)));
    scene::Transform transform;
    transform.position = vec3(0.3f, 2.5f, 1.5f);
    transform.rotation = assets::facing(glm::normalize(vec3(0.1f, 1.0f, 0.6f))); // shines along its -Z
    builder.spot_light("spot", transform, {vec3(60.0f), 0.4f, 0.5f});
    builder.camera("view", vec3(0.0f, 1.2f, 2.6f), vec3(0.0f, 0.1f, -0.3f), 45.0f);
}

// 200 m long, with a fence of rods of 2 cm along it.
void make_street(assets::SceneBuilder& builder) {
    const scene::Material wall = assets::diffuse(vec3(0.6f, 0.55f, 0.5f)), iron = assets::diffuse(vec3(0.1f));
    builder.quad("ground", vec3(-100.0f, 0.0f, -20.0f), vec3(0.0f, 0.0f, 40.0f), vec3(200.0f, 0.0f, 0.0f),
                 assets::diffuse(vec3(0.4f)));
    for (int i = 0; i < 10; ++i)
        builder.box("house", vec3(-98.0f + 20.0f * float(i), 0.0f, -18.0f),
                    vec3(-84.0f + 20.0f * float(i), 6.0f + float(i % 3), -8.0f), wall);
    const std::uint32_t rod = builder.mesh("rod", scene::make_box(vec3(0.02f, 1.2f, 0.02f)));
    for (int i = 0; i < 1600; ++i)
        builder.instance("rod", rod, iron, {.position = vec3(-99.0f + 0.12f * float(i), 0.6f, 2.0f)});
    builder.box("rail", vec3(-99.0f, 1.15f, 1.99f), vec3(93.0f, 1.18f, 2.01f), iron);
    add_sun(builder, vec3(0.4f, -1.0f, 0.7f));
    builder.camera("view", vec3(-4.0f, 1.7f, 6.0f), vec3(6.0f, 0.4f, 2.5f), 50.0f);
}

struct Mistakes {
    int shadow = 0, lit_in_shadow = 0, dark_in_light = 0;
};

// More than a pixel from the traced edge, on the wrong side of half of the light.
Mistakes compare(GpuWorld& world, gi::Settings settings) {
    world.set(settings);
    const io::Picture picture = world.picture();
    settings.shadows = false;
    world.set(settings);
    const io::Picture unshadowed = world.picture();
    const TracedLight traced(world, 1, true);
    Mistakes mistakes;
    for (std::size_t i = 0; i < traced.pixels().size(); ++i) {
        const TracedPixel& pixel = traced.pixels()[i];
        if (!pixel.surface || pixel.unshadowed <= 0.0 || unshadowed.pixels[i].g <= 0.0f)
            continue;
        const bool lit = picture.pixels[i].g > 0.5f * unshadowed.pixels[i].g;
        mistakes.shadow += pixel.exact == 0.0;
        mistakes.lit_in_shadow += lit && pixel.most == 0.0;
        mistakes.dark_in_light += !lit && pixel.least > 0.0;
    }
    return mistakes;
}

gi::Settings punctual_only() {
    gi::Settings settings;
    settings.with("punctual", "adaptive_shadows").with("direct", "none").with("indirect", "none");
    return settings;
}

struct Case {
    const char* name;
    void (*make)(assets::SceneBuilder&);
};
constexpr Case cases[] = {{"chair", make_chair},       {"pole", make_pole},
                          {"spot", make_spot},         {"street", make_street},
                          {"hall", assets::make_hall}, {"lantern_house", assets::make_lantern_house}};

class AnywhereSharpShadowsOf : public AnywhereSharpShadows, public testing::WithParamInterface<std::size_t> {};

// Of the shadow's pixels at 1280x720, at most 1 % are on the wrong side of its edge by more than a pixel.
TEST_P(AnywhereSharpShadowsOf, AgreeWithRays) {
    GpuWorld world(cases[GetParam()].make, "view");
    world.request.width = 1280;
    world.request.height = 720;
    const Mistakes mistakes = compare(world, punctual_only());
    std::printf("%s: %d pixels in shadow, %d of them lit, %d outside dark\n", cases[GetParam()].name, mistakes.shadow,
                mistakes.lit_in_shadow, mistakes.dark_in_light);
    EXPECT_GT(mistakes.shadow, 2000);
    EXPECT_LE(mistakes.lit_in_shadow + mistakes.dark_in_light, mistakes.shadow / 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnywhereSharpShadowsOf, testing::Range(std::size_t(0), std::size(cases)),
                         [](const auto& instance) { return std::string(cases[instance.param].name); });

// Nothing is drawn and no bit changes while camera and world stand still; and a camera that has been elsewhere finds
// the picture as it was, whatever tiles it left in memory.
TEST_F(AnywhereSharpShadows, StandStillWithCameraAndWorld) {
    GpuWorld world(make_chair, "view");
    world.request.width = 320;
    world.request.height = 180;
    world.set(punctual_only());
    const io::Picture first = world.picture();
    const auto& counters = world.renderer->lighting().counters();
    EXPECT_GT(counters["shadow_tile_updates"], 0.0);
    const auto same = [&](const io::Picture& other) {
        return std::equal(first.pixels.begin(), first.pixels.end(), other.pixels.begin(), other.pixels.end());
    };
    EXPECT_TRUE(same(world.picture()));
    EXPECT_EQ(world.renderer->lighting().counters()["shadow_tile_updates"], 0.0);
    const scene::CameraView view = world.request.camera;
    for (int i = 1; i <= 5; ++i) {
        world.request.camera.position = view.position + vec3(0.4f * float(i), 0.0f, -0.3f * float(i));
        world.render();
    }
    world.request.camera = view;
    EXPECT_TRUE(same(world.picture()));
}

// A room with none of these lights has no pass, no tile and no memory of theirs.
TEST_F(AnywhereSharpShadows, CostNothingWithoutSuchLights) {
    GpuWorld world(assets::make_cornell, "view");
    world.set({});
    world.render();
    EXPECT_EQ(world.renderer->lighting().counters()["punctual_lights"], 0.0);
    EXPECT_EQ(world.renderer->lighting().counters()["shadow_tile_maps"], 0.0);
    EXPECT_EQ(world.renderer->statistics().gpu_ms.count("punctual light"), 0u);
}

// The scene's one point light, made a mover.
class CarriedLamp {
public:
    explicit CarriedLamp(GpuWorld& world) : registry_(world.renderer->registry()) {
        registry_.view<scene::PointLight>().each([&](ecs::Entity entity, const scene::PointLight&) { lamp_ = entity; });
        registry_.emplace<scene::Mover>(lamp_, {});
    }
    // Along x, in m.
    void move(float by) const {
        scene::Transform place = *registry_.try_get<scene::Transform>(lamp_);
        place.position.x += by;
        registry_.update<scene::Transform>(lamp_, place);
        scene::update_world_transforms(registry_);
    }

private:
    ecs::Registry& registry_;
    ecs::Entity lamp_;
};

// A lamp that is carried lights with the shadows of where it is, in every frame; once it rests, with all detail.
TEST_F(AnywhereSharpShadows, FollowALampThatIsCarried) {
    GpuWorld world(make_pole, "view");
    world.request.width = 640;
    world.request.height = 360;
    const CarriedLamp lamp(world);
    for (int step = 0; step < 4; ++step) {
        lamp.move(0.1f);
        const Mistakes moving = compare(world, punctual_only());
        EXPECT_GT(moving.shadow, 500);
        EXPECT_LE(moving.lit_in_shadow + moving.dark_in_light, moving.shadow / 4) << "step " << step;
    }
    world.render();
    const Mistakes rested = compare(world, punctual_only());
    EXPECT_LE(rested.lit_in_shadow + rested.dark_in_light, rested.shadow / 100);
}

// A wall with a door frame that stands out of it by less than a texel of the map of a lamp that moves.
void make_door_frame(assets::SceneBuilder& builder) {
    const scene::Material plaster = assets::diffuse(vec3(0.7f)), wood = assets::diffuse(vec3(0.4f, 0.25f, 0.1f));
    builder.quad("wall", vec3(-2.0f, 0.0f, 0.0f), vec3(4.0f, 0.0f, 0.0f), vec3(0.0f, 3.0f, 0.0f), plaster);
    builder.box("left", vec3(-0.55f, 0.0f, 0.0f), vec3(-0.45f, 2.1f, 0.015f), wood);
    builder.box("right", vec3(0.45f, 0.0f, 0.0f), vec3(0.55f, 2.1f, 0.015f), wood);
    builder.box("lintel", vec3(-0.55f, 2.1f, 0.0f), vec3(0.55f, 2.2f, 0.015f), wood);
    builder.point_light("lamp", vec3(-0.2f, 1.25f, 1.6f), vec3(10.0f));
    builder.camera("view", vec3(0.1f, 1.6f, 2.1f), vec3(-0.2f, 1.7f, 0.0f), 60.0f);
}

// Texels that are coarser than what stands out of a wall show it here and there, and would draw it as blots on the wall
// beside it. What rays find lit keeps its light, at the half of the wall's edge pixels that lie beside the frame, too.
TEST_F(AnywhereSharpShadows, ACarriedLampDrawsNoBlotsBesideAFrame) {
    GpuWorld world(make_door_frame, "view");
    world.request.width = 640;
    world.request.height = 360;
    const CarriedLamp lamp(world);
    gi::Settings settings = punctual_only();
    settings.with("moving_light_tiles", "1");
    for (int step = 0; step < 3; ++step) {
        lamp.move(0.07f);
        settings.shadows = true;
        world.set(settings);
        const io::Picture picture = world.picture();
        settings.shadows = false;
        world.set(settings);
        const io::Picture unshadowed = world.picture();
        const TracedLight traced(world, 1, true);
        int blots = 0;
        for (std::size_t i = 0; i < traced.pixels().size(); ++i) {
            const TracedPixel& pixel = traced.pixels()[i];
            if (pixel.surface && pixel.least > 0.0 && unshadowed.pixels[i].g > 0.0f)
                blots += picture.pixels[i].g < 0.9f * unshadowed.pixels[i].g;
        }
        std::printf("step %d: %d pixels lost more than a tenth\n", step, blots);
        EXPECT_LE(blots, 60);
    }
}

// In centimetres or kilometres as in metres.
TEST_F(AnywhereSharpShadows, InAnyUnit) {
    for (const float scale : {0.01f, 1000.0f}) {
        ScaledWorld world(make_pole, scale);
        world.request.width = 1280;
        world.request.height = 720;
        const Mistakes mistakes = compare(world, punctual_only());
        EXPECT_GT(mistakes.shadow, 3000);
        EXPECT_LE(mistakes.lit_in_shadow + mistakes.dark_in_light, mistakes.shadow / 100) << scale;
    }
}

} // namespace
} // namespace sunfleck::tests

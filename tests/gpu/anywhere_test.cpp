// Right in any unit and anywhere: what is drawn does not depend on how long a metre is, or where the scene lies.
#include "tests/support/scaled_scene.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

class Anywhere : public GpuTest {};

gi::Settings few_lights(std::string_view technique) {
    gi::Settings settings = gi::Settings().all_light_by(technique);
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    settings.map_budget = 65536;
    return settings;
}

// The last of some steps of motion.
io::Picture draw(GpuWorld& world, const gi::Settings& settings) {
    world.set(settings);
    io::Picture picture;
    for (world.request.step = 0; world.request.step < 3; ++world.request.step)
        picture = world.picture();
    return picture;
}

double mean(const io::Picture& picture) {
    double sum = 0.0;
    for (const vec4& pixel : picture.pixels)
        sum += double(pixel.x + pixel.y + pixel.z);
    return sum / (3.0 * double(picture.pixels.size()));
}

// Squared differences over the square of the mean.
double difference(const io::Picture& picture, const io::Picture& of) {
    double sum = 0.0;
    for (std::size_t i = 0; i < of.pixels.size(); ++i) {
        const vec3 d = vec3(picture.pixels[i]) - vec3(of.pixels[i]);
        sum += double(glm::dot(d, d));
    }
    return sum / (3.0 * double(of.pixels.size())) / std::pow(mean(of), 2.0);
}

const std::vector<std::pair<const char*, void (*)(assets::SceneBuilder&)>> scenes = {
    {"cornell", assets::make_cornell}, {"arena", assets::make_arena}, {"four_pillars", assets::make_four_pillars}};

// Powers of two round alike, so any absolute length would show.
TEST_F(Anywhere, InAnotherUnitEveryBitIsTheSame) {
    for (const auto& [name, make] : scenes)
        for (const std::string_view technique : techniques_for_all_light()) {
            ScaledWorld unscaled(make, 1.0f);
            const io::Picture expected = draw(unscaled, few_lights(technique));
            EXPECT_GT(mean(expected), 0.01);
            for (const float scale : tests::by_size(std::vector{0x1p-7f}, {0x1p-7f, 0x1p-3f, 0x1p3f, 0x1p10f})) {
                ScaledWorld world(make, scale);
                const io::Picture picture = draw(world, few_lights(technique));
                EXPECT_LE(difference(picture, expected), 1e-6) << name << ", " << technique << " at " << scale;
            }
            if (!long_size() && make != assets::make_arena) // the one with a lamp that moves: all techniques
                break;
        }
}

// Other factors, and places, round otherwise: samples fall elsewhere. With so many of them the mean of two seeds
// differs by some 0.5 %, which no error of scale would stay below: without a space, walls ten times as large lost a
// third.
TEST_F(Anywhere, AnyScaleAndPlaceHasTheSameLight) {
    for (const auto& [name, make] : scenes) {
        gi::Settings settings = few_lights(techniques_for_all_light().front());
        settings.lights = 1000;
        ScaledWorld unscaled(make, 1.0f);
        const double expected = mean(draw(unscaled, settings));
        // The short size scales and moves at once.
        const vec3 place = long_size() ? vec3(0.0f) : vec3(7.0f, 1.0f, -6.0f);
        for (const float scale : tests::by_size(std::vector{0.01f}, {0.01f, 0.1f, 10.0f, 100.0f, 1000.0f})) {
            ScaledWorld world(make, scale, place);
            EXPECT_NEAR(mean(draw(world, settings)) / expected, 1.0, 0.003) << name << " at " << scale;
        }
        if (!long_size())
            break;
        ScaledWorld moved(make, 1.0f, vec3(700.0f, 100.0f, -600.0f));
        EXPECT_NEAR(mean(draw(moved, settings)) / expected, 1.0, 0.003) << name << ", moved";
    }
}

} // namespace
} // namespace sunfleck::tests

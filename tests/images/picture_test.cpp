// The displayed picture: measures of stairs and stains on made-up pictures, and anti-aliasing against supersampling.
#include "editor/command_line/picture_measures.h"
#include "engine/core/random.h"
#include "engine/render/stipple.h"
#include "engine/render/tone_map.h"
#include "tests/support/gpu_world.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

using namespace command_line;

// A picture of `size` x `size` pixels of a function of places in pixels, 0 to `size`.
template <typename Value>
io::Picture drawn(std::uint32_t size, const Value& value) {
    io::Picture picture{size, size, {}};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
            picture.pixels.emplace_back(vec3(value(float(x) + 0.5f, float(y) + 0.5f)), 1.0f);
    return picture;
}

// Black above a slanted line, grey below it.
float half_plane(float x, float y) {
    return y > 20.3f + 0.13f * x ? 0.6f : 0.1f;
}

TEST(PictureMeasures, StairsAreEdgeErrorsAndBrightnessIsNot) {
    const io::Picture stairs = drawn(64, half_plane);
    const io::Picture smooth =
        box_filtered(drawn(512, [](float x, float y) { return half_plane(x / 8.0f, y / 8.0f); }), 8);
    ASSERT_EQ(smooth.pixels.size(), stairs.pixels.size());
    EXPECT_GT(edge_error(stairs, smooth), 0.01);
    EXPECT_NEAR(edge_error(smooth, smooth), 0.0, 1e-7);
    io::Picture brighter = smooth;
    for (vec4& pixel : brighter.pixels)
        pixel += vec4(0.1f, 0.1f, 0.1f, 0.0f);
    EXPECT_NEAR(edge_error(brighter, smooth), 0.0, 1e-6);
}

TEST(PictureMeasures, StainsAreSteepWhereTheReferenceIsFlat) {
    const io::Picture flat = drawn(64, [](float, float) { return 0.5f; });
    io::Picture stained = flat;
    for (std::size_t x = 0; x < 64; ++x) // one line: it is steep on itself and on both sides
        stained.pixels[32 * 64 + x] -= vec4(4.0f / 255.0f, 4.0f / 255.0f, 4.0f / 255.0f, 0.0f);
    EXPECT_EQ(stain_share(flat, flat), 0.0);
    EXPECT_NEAR(stain_share(stained, flat), 3.0 / 64.0, 1e-9);
    EXPECT_EQ(stain_share(stained, stained), 0.0); // where the reference has it, it is none
}

TEST(PictureMeasures, CrawlIsWhatChangesDoNotFollow) {
    const auto line_at = [](float place) {
        return drawn(32, [=](float x, float) { return std::abs(x - place) < 1.0f ? 1.0f : 0.0f; });
    };
    const io::Picture frames[] = {line_at(8.0f), line_at(9.0f)}, still[] = {line_at(8.0f), line_at(8.0f)};
    EXPECT_NEAR(crawl(frames, frames), 0.0, 1e-9);
    EXPECT_NEAR(crawl(still, frames), 1.0, 1e-6);
}

class Stippled : public GpuTest {};

// A sheet that lets half of the light through, in front of a wall; both show their own colours, whatever the light.
void make_sheet(assets::SceneBuilder& scene) {
    scene::Material sheet = assets::diffuse(vec3(1.0f)), wall = assets::diffuse(vec3(0.25f));
    sheet.unlit = wall.unlit = true;
    sheet.alpha_mode = scene::AlphaMode::blend;
    sheet.alpha = 0.5f;
    scene.quad("wall", vec3(-4, -4, -1), vec3(8, 0, 0), vec3(0, 8, 0), wall);
    scene.quad("sheet", vec3(-1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), sheet);
    scene.point_light("lamp", vec3(0, 0, 3), vec3(1.0f));
    scene.camera("view", vec3(0, 0, 4), vec3(0.0f), 60.0f);
}

// Its pixels are all alike, and as bright as half of each: 0.625 of linear light is 0.812 on the display, and the mean
// of squares of display values is within 0.02 of that. The wall beside it is untouched.
TEST_F(Stippled, SurfacesAreBlendedInThePicture) {
    GpuWorld world(make_sheet, "view");
    gi::Settings settings;
    settings.lights = 4;
    settings.shadow_map_resolution = 32;
    world.set(settings);
    world.request.view = shared::view_final;
    world.request.tone_map = true;
    const io::Picture picture = world.picture();
    const auto at = [&](int x, int y) { return picture.pixels[std::size_t(y) * picture.width + std::size_t(x)].x; };
    const int width = int(picture.width), height = int(picture.height);
    for (int y = height / 2 - 4; y < height / 2 + 4; ++y)
        for (int x = width / 2 - 4; x < width / 2 + 4; ++x) {
            EXPECT_NEAR(at(x, y), 0.812f, 0.02f);
            EXPECT_NEAR(at(x, y), at(width / 2, height / 2), 1.01f / 255.0f) << x << ", " << y;
        }
    EXPECT_NEAR(at(2, 2), shared::srgb_from_linear(0.25f), 1.5f / 255.0f);
}

// The picture of the sheet as `camera` sees it, with the rectangle of what may be blended in it.
struct BlendedPicture {
    io::Picture picture;
    render::PixelRectangle rectangle;
};

BlendedPicture blended_picture(GpuWorld& world, const scene::CameraView& camera) {
    world.request.camera = camera;
    world.request.width = 160;
    world.request.height = 90;
    BlendedPicture result{world.picture(), {}};
    const shared::CameraRow row =
        scene::make_camera_row(world.renderer->space().view(camera), world.request.width, world.request.height);
    result.rectangle = render::stippled_rectangle(world.renderer->gpu_scene(), row);
    return result;
}

// Dots of the sheet itself would be white. Cameras look at it from all sides, along it, and from within its box.
TEST_F(Stippled, NothingIsLeftInDotsFromAnywhere) {
    GpuWorld world(make_sheet, "view");
    gi::Settings settings;
    settings.lights = 4;
    settings.shadow_map_resolution = 32;
    world.set(settings);
    world.request.view = shared::view_final;
    world.request.tone_map = true;
    std::uint32_t drawn_numbers = 0;
    const auto random = [&] { return to_unit_float(hash_combine(20, drawn_numbers++)); };
    std::size_t blended = 0, outside = 0;
    for (int i = 0; i < 24; ++i) {
        scene::CameraView camera;
        const float range = i % 3 == 0 ? 0.3f : 2.0f;
        camera.position = range * vec3(random() - 0.5f, random() - 0.5f, 0.02f + random());
        camera.target = vec3(2.0f * random() - 1.0f, 2.0f * random() - 1.0f, -0.5f);
        const BlendedPicture shown = blended_picture(world, camera);
        for (std::uint32_t y = 0; y < shown.picture.height; ++y)
            for (std::uint32_t x = 0; x < shown.picture.width; ++x) {
                const float value = shown.picture.pixels[y * shown.picture.width + x].x;
                EXPECT_LT(value, 0.95f) << "camera " << i << ", " << x << ", " << y;
                const bool inside = x - std::uint32_t(shown.rectangle.x) < shown.rectangle.width &&
                                    y - std::uint32_t(shown.rectangle.y) < shown.rectangle.height;
                const bool differs = std::abs(value - shared::srgb_from_linear(0.25f)) > 1.5f / 255.0f && value > 0.0f;
                blended += differs;
                outside += differs && !inside;
            }
    }
    EXPECT_GT(blended, 24u * 160u * 90u / 20u);
    EXPECT_EQ(outside, 0u);
}

// The sheet's edges are 1 m from the middle of what is 4 tan(30 degrees) = 2.31 m to each side at its distance.
TEST_F(Stippled, OnlyTheirPartOfThePictureIsLookedAt) {
    GpuWorld world(make_sheet, "view");
    gi::Settings settings;
    settings.lights = 4;
    world.set(settings);
    const scene::CameraView ahead = world.request.camera;
    const render::PixelRectangle rectangle = blended_picture(world, ahead).rectangle;
    const float half = 45.0f / (4.0f * std::tan(glm::radians(30.0f)));
    EXPECT_NEAR(float(rectangle.x), 80.0f - half, 4.0f);
    EXPECT_NEAR(float(rectangle.y), 45.0f - half, 4.0f);
    EXPECT_NEAR(float(rectangle.width), 2.0f * half, 8.0f);
    EXPECT_NEAR(float(rectangle.height), 2.0f * half, 8.0f);
    scene::CameraView away = ahead;
    away.target = ahead.position + (ahead.position - ahead.target);
    EXPECT_EQ(blended_picture(world, away).rectangle.width, 0u);
}

class Antialiasing : public GpuTest {};

struct SmoothedScene {
    SmoothedScene() : world(assets::make_four_pillars, "view") {
        gi::Settings settings;
        settings.lights = 24;
        settings.shadow_map_resolution = 64;
        settings.low_resolution = 1;
        world.set(settings);
        world.request.view = shared::view_final;
        world.request.tone_map = true;
    }
    io::Picture at(std::uint32_t width, std::uint32_t height, bool antialiasing) {
        world.request.width = width;
        world.request.height = height;
        world.request.antialiasing = antialiasing;
        return world.picture();
    }
    GpuWorld world;
};

TEST_F(Antialiasing, EdgesComeNearerToASupersampledPicture) {
    SmoothedScene scene;
    const io::Picture truth = box_filtered(scene.at(1280, 720, false), 4);
    const io::Picture stairs = scene.at(320, 180, false), smooth = scene.at(320, 180, true);
    // 0.65 here; without following the stairs to their ends it would be above 0.8.
    EXPECT_LT(edge_error(smooth, truth), 0.72 * edge_error(stairs, truth));
    // Nothing is left of the frames before.
    EXPECT_EQ(scene.at(320, 180, true).pixels, smooth.pixels);
}

// How far the edge between a bright left and a darker right side strays from the truth's, in pixels; what is darker
// than both counts as the right side.
double wavering(const io::Picture& picture, const io::Picture& truth) {
    const float left = truth.pixels.front().x, right = truth.pixels.back().x;
    const auto share = [&](float value) { return double(std::clamp((value - right) / (left - right), 0.0f, 1.0f)); };
    double sum = 0.0, squares = 0.0;
    for (std::size_t y = 0; y < truth.height; ++y) {
        double row = 0.0;
        for (std::size_t x = 0; x < truth.width; ++x)
            row += share(picture.pixels[y * truth.width + x].x) - share(truth.pixels[y * truth.width + x].x);
        sum += row / truth.height;
        squares += row * row / truth.height;
    }
    return std::sqrt(squares - sum * sum);
}

// The edge of a plate before a wall, seen at a slant: between both lies the plate's dark side, a fraction of a pixel
// wide, so that it shows once in each of the stairs. The line between these pixels must not stay a stair, to either
// side.
TEST_F(Antialiasing, AThinSideFaceLeavesTheEdgeStraight) {
    GpuWorld world(
        [](assets::SceneBuilder& s) {
            const auto shown = [](float brightness) {
                scene::Material material;
                material.base_colour = vec3(brightness);
                material.unlit = true;
                return material;
            };
            s.quad("wall", vec3(-2, -2, 0), vec3(4, 0, 0), vec3(0, 4, 0), shown(0.6f));
            s.quad("plate", vec3(0, -2, 0.006f), vec3(2, 0, 0), vec3(0, 4, 0), shown(0.3f));
            s.quad("side", vec3(0, -2, 0), vec3(0, 0, 0.006f), vec3(0, 4, 0), shown(0.01f));
            s.camera("view", vec3(-0.35f, 0.0f, 2.0f), vec3(0.0f, 0.06f, 0.0f), 50.0f);
        },
        "view");
    world.request.view = shared::view_final;
    world.request.tone_map = true;
    world.request.camera.up = glm::normalize(vec3(0.05f, 1.0f, 0.0f));
    const auto at = [&](std::uint32_t width, bool antialiasing) {
        world.request.width = width;
        world.request.height = width * 9 / 16;
        world.request.antialiasing = antialiasing;
        return world.picture();
    };
    const io::Picture truth = box_filtered(at(1280, false), 4), stairs = at(320, false), smooth = at(320, true);
    const double before = wavering(stairs, truth), after = wavering(smooth, truth);
    std::printf("wavers by %.3f pixels, smooth by %.3f\n", before, after);
    EXPECT_GT(before, 0.25);        // evenly spread over a pixel: 0.29
    EXPECT_LT(after, 0.7 * before); // 0.59 here; 0.97 where dashes end the line towards the darker side
}

// By how much a row's sum strays from the truth's, from row to row, over the contrast of a line with its surroundings.
double unevenness(const io::Picture& picture, const io::Picture& truth, float contrast) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t y = 0; y < truth.height; ++y) {
        double row = 0.0;
        for (std::size_t x = 0; x < truth.width; ++x)
            row += double(picture.pixels[y * truth.width + x].x - truth.pixels[y * truth.width + x].x) / contrast;
        sum += row / truth.height;
        squares += row * row / truth.height;
    }
    return std::sqrt(squares - sum * sum);
}

// A line so many pixels wide, between bright and less bright, which moves by a pixel in so many rows.
struct ThinLine {
    float width, rows;
};

struct Unevenness {
    double before = 0.0, after = 0.0;
};

Unevenness unevenness_of(const ThinLine& line) {
    constexpr float pixel = 2.0f * 2.0f * 0.46630766f / 180.0f; // tan(25 degrees)
    GpuWorld world;
    assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
    const auto sheet = [&](const char* name, float from, float to, float brightness) {
        scene::Material material;
        material.base_colour = vec3(brightness);
        material.unlit = true;
        builder.quad(name, vec3(from, -2, 0), vec3(to - from, 0, 0), vec3(0, 4, 0), material);
    };
    sheet("wall", -2.0f, 0.0f, 0.6f);
    sheet("line", 0.0f, line.width * pixel, 0.01f);
    sheet("plate", line.width * pixel, 2.0f, 0.3f);
    builder.camera("view", vec3(0.003f, 0, 2), vec3(0.003f, 0, 0), 50.0f);
    world.finish();
    world.request.view = shared::view_final;
    world.request.tone_map = true;
    world.request.camera.up = glm::normalize(vec3(1.0f / line.rows, 1.0f, 0.0f));
    const auto at = [&](std::uint32_t width, bool antialiasing) {
        world.request.width = width;
        world.request.height = width * 9 / 16;
        world.request.antialiasing = antialiasing;
        return world.picture();
    };
    const io::Picture truth = box_filtered(at(1280, false), 4);
    const float contrast = 0.5f * (truth.pixels.front().x + truth.pixels.back().x) - shared::srgb_from_linear(0.01f);
    const Unevenness result{unevenness(at(320, false), truth, contrast), unevenness(at(320, true), truth, contrast)};
    std::printf("%.2f pixels wide, a pixel in %.0f rows: uneven by %.3f, smooth by %.3f\n", double(line.width),
                double(line.rows), result.before, result.after);
    return result;
}

// It shows in dashes, of width * rows pixels, where it meets the middle of pixels: two of these have dashes of 12.
TEST_F(Antialiasing, LinesThinnerThanAPixelAreEven) {
    for (const ThinLine& line : {ThinLine{0.1f, 20.0f}, ThinLine{0.3f, 20.0f}, ThinLine{0.6f, 20.0f},
                                 ThinLine{0.3f, 40.0f}, ThinLine{0.5f, 8.0f}}) {
        const Unevenness of_line = unevenness_of(line);
        // 0.26 to 0.34 here; 0.40 to 0.62 where dashes are only made fainter, the short ones, and gaps stay.
        EXPECT_LT(of_line.after, 0.37 * of_line.before);
    }
}

TEST_F(Antialiasing, LeavesWhatHasNoContrastAsItIs) {
    SmoothedScene scene;
    const io::Picture before = scene.at(160, 90, false), after = scene.at(160, 90, true);
    std::size_t flat = 0;
    for (std::size_t y = 1; y + 1 < 90; ++y)
        for (std::size_t x = 1; x + 1 < 160; ++x) {
            const std::size_t i = y * 160 + x;
            vec3 low(before.pixels[i]), high = low;
            for (const std::size_t k : {i - 1, i + 1, i - 160, i + 160}) {
                low = glm::min(low, vec3(before.pixels[k]));
                high = glm::max(high, vec3(before.pixels[k]));
            }
            if (glm::any(glm::greaterThan(high - low, vec3(1.0f / 32.0f))))
                continue;
            ++flat;
            EXPECT_EQ(before.pixels[i], after.pixels[i]) << x << " " << y;
        }
    EXPECT_GT(flat, 160u * 90u / 3u);
}

TEST_F(Antialiasing, IsEnlargedWithThePicture) {
    SmoothedScene scene;
    scene.world.request.screen_width = 320;
    scene.world.request.screen_height = 180;
    const io::Picture stairs = scene.at(160, 90, false), smooth = scene.at(160, 90, true);
    ASSERT_EQ(smooth.width, 320u);
    scene.world.request.screen_width = 0;
    const io::Picture truth = box_filtered(scene.at(1280, 720, false), 4);
    EXPECT_LT(edge_error(smooth, truth), 0.8 * edge_error(stairs, truth));
}

// A lamp before black: what glare takes from it is found around it, less and less farther away.
TEST_F(Antialiasing, GlareSpreadsLightAndKeepsItsEnergy) {
    const auto make = [](assets::SceneBuilder& s) {
        scene::Material lamp;
        lamp.base_colour = vec3(0.0f);
        lamp.emission = vec3(1.0f);
        s.box("lamp", vec3(-0.1f), vec3(0.1f), lamp);
        s.camera("view", vec3(0.0f, 0.0f, 2.0f), vec3(0.0f), 40.0f);
    };
    GpuWorld world(make, "view");
    world.request.view = shared::view_final;
    world.request.tone_map = true;
    world.request.width = world.request.height = 512;
    world.request.ev100 = 10.0f; // the lamp is well within the tone curve
    const auto linear = [](float shown) {
        return shown <= 0.04045f ? shown / 12.92f : std::pow((shown + 0.055f) / 1.055f, 2.4f);
    };
    const auto radiance = [&](const io::Picture& picture, std::size_t x, std::size_t y) {
        const vec4& pixel = picture.pixels[y * 512 + x];
        return double(shared::radiance_from_display(vec3(linear(pixel.x)), shared::exposure_factor(10.0f)).x);
    };
    const auto sum = [&](const io::Picture& picture) {
        double result = 0.0;
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            result += radiance(picture, i % 512, i / 512);
        return result;
    };
    const io::Picture sharp = world.picture();
    world.request.glare = 0.4f;
    const io::Picture scattered = world.picture();
    EXPECT_NEAR(sum(scattered) / sum(sharp), 1.0, 0.04); // steps of 8 bits; what leaves the picture
    EXPECT_NEAR(radiance(sharp, 256, 256), 1.0, 0.02);
    EXPECT_LT(radiance(scattered, 256, 256), 0.95);
    EXPECT_EQ(radiance(sharp, 256, 320), 0.0);
    double last = 1.0;
    for (const std::size_t away : {50u, 80u, 120u}) {
        const double here = radiance(scattered, 256 + away, 256);
        EXPECT_LT(here, last) << away;
        EXPECT_NEAR(here, radiance(scattered, 255, 256 + away), 0.15 * here + 1e-3) << away;
        last = here;
    }
    EXPECT_GT(last, 0.0);
}

} // namespace
} // namespace sunfleck::tests

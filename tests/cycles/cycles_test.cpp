// The path tracer against a second renderer, Blender's Cycles, whose pictures are stored (README.md here).
#include "editor/command_line/metrics.h"
#include "engine/core/file.h"
#include "engine/scene/camera_view.h"
#include "test_places.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

namespace sunfleck::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path here = SUNFLECK_SOURCE_DIR "/tests/cycles";

// A scene of scenes.json.
struct Case {
    std::string name, file, camera, size;
    unsigned bounces = 0;
    unsigned samples = 0; // a pixel, of `sunfleck reference`
    bool in_short = false;
};

std::vector<Case> cases() {
    std::vector<Case> result;
    const auto text = read_file(here / "scenes.json");
    const json file = text ? json::parse(*text) : json::object({{"scenes", json::array()}});
    for (const json& scene : file["scenes"])
        result.push_back({scene["name"], scene["file"], scene["camera"], file["settings"]["size"], scene["bounces"],
                          scene["reference_samples"], scene.value("short", false)});
    return result;
}

Case find_case(const std::string& name) {
    for (const Case& found : cases())
        if (found.name == name)
            return found;
    ADD_FAILURE() << "scenes.json has no " << name;
    return {};
}

// As the tool takes it; empty where its package or folder is not here.
std::string locate(const std::string& file) {
    const std::size_t colon = file.find(':');
    const std::string place = file.substr(0, colon), path = file.substr(colon + 1);
    if (place == "built_in")
        return path;
    const fs::path folder = place == "own"      ? here
                            : place == "assimp" ? fs::path("/usr/share/assimp/models/glTF2")
                                                : fs::path(SUNFLECK_SOURCE_DIR "/../shared/assets");
    return fs::exists(folder / path) ? (folder / path).string() : "";
}

struct Folder {
    fs::path path = fs::path(testing::TempDir()) / ("sunfleck_cycles_" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

io::Picture read(const fs::path& path) {
    auto picture = io::read_picture(path);
    EXPECT_TRUE(picture) << (picture ? "" : picture.error().message);
    return picture ? std::move(*picture) : io::Picture{};
}

// What the tool's path tracer makes of the case: irradiance, each pixel the mean over its square.
io::Picture trace(const Case& scene, const std::string& size, unsigned samples) {
    const Folder folder;
    const fs::path output = folder.path / "reference.exr";
    const Outcome outcome =
        shell(SUNFLECK_TOOL " reference '" + locate(scene.file) + "' -o " + output.string() +
              " --view irradiance --lambertian --antialiasing --motion off --camera=" + scene.camera + " --size " +
              size + " --bounces " + std::to_string(scene.bounces) + " --spp " + std::to_string(samples));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return outcome.status == 0 ? read(output) : io::Picture{};
}

io::Picture stored(const std::string& name) {
    return read(here / "pictures" / (name + ".exr"));
}

double brightness(const vec4& pixel) {
    return double(pixel.x + pixel.y + pixel.z) / 3.0;
}

struct Agreement {
    double ratio = 0.0;    // of the means, ours over Cycles'
    double noise = 0.0;    // standard error of that ratio, if all differences of pixels are noise
    double relative = 0.0; // relative MSE, both pictures' noise included
    int dark_blocks = 0;   // of 2x2 pixels, 0 in one picture and lit in the other
};

bool all_in_block(const io::Picture& picture, std::size_t first, const std::function<bool(double)>& holds) {
    const std::size_t w = picture.width;
    return holds(brightness(picture.pixels[first])) && holds(brightness(picture.pixels[first + 1])) &&
           holds(brightness(picture.pixels[first + w])) && holds(brightness(picture.pixels[first + w + 1]));
}

int count_dark_blocks(const io::Picture& picture, const io::Picture& other, double mean) {
    const auto dark = [](double value) { return value == 0.0; };
    const auto lit = [&](double value) { return value > 0.01 * mean; };
    int count = 0;
    for (std::size_t y = 0; y + 1 < picture.height; ++y)
        for (std::size_t x = 0; x + 1 < picture.width; ++x) {
            const std::size_t first = y * picture.width + x;
            count += all_in_block(picture, first, dark) && all_in_block(other, first, lit);
        }
    return count;
}

Agreement compare(const io::Picture& ours, const io::Picture& cycles) {
    Agreement result;
    EXPECT_EQ(ours.pixels.size(), cycles.pixels.size());
    if (ours.pixels.size() != cycles.pixels.size() || ours.pixels.empty())
        return result;
    io::Picture opaque = ours; // alpha says which pixels are lamps; they count, as 0
    for (vec4& pixel : opaque.pixels)
        pixel.w = 1.0f;
    const command_line::Metrics metrics = command_line::compare_pictures(opaque, cycles, true);
    double squares = 0.0;
    for (std::size_t i = 0; i < ours.pixels.size(); ++i)
        squares += std::pow(brightness(ours.pixels[i]) - brightness(cycles.pixels[i]), 2.0);
    result.ratio = metrics.mean_a / metrics.mean_b;
    result.noise = std::sqrt(squares) / double(ours.pixels.size()) / metrics.mean_b;
    result.relative = metrics.relative_mean_square_error;
    result.dark_blocks =
        count_dark_blocks(ours, cycles, metrics.mean_b) + count_dark_blocks(cycles, ours, metrics.mean_b);
    return result;
}

void print_row(const std::string& name, const Agreement& found, unsigned samples, unsigned samples_of_cycles) {
    std::printf("| %s | %.4f | %.4f | %.5f | %u | %u |\n", name.c_str(), found.ratio, found.noise, found.relative,
                samples, samples_of_cycles);
}

class AnywhereCyclesOf : public testing::TestWithParam<Case> {};

// The mean within 1 %, of which the noise of both pictures is the smaller part: three standard errors stay below it.
// The short size has fewer scenes, with a quarter of the samples.
TEST_P(AnywhereCyclesOf, AgreesWithThePathTracer) {
    const Case& scene = GetParam();
    if (!long_size() && !scene.in_short)
        GTEST_SKIP() << "at the long size";
    if (locate(scene.file).empty())
        GTEST_SKIP() << scene.file << " is not here";
    const unsigned samples = by_size(scene.samples / 4, scene.samples);
    const json made = json::parse(read_file(here / "pictures" / (scene.name + ".json")).value());
    for (const char* key : {"file", "camera", "size"})
        EXPECT_EQ(made[key], key == std::string("file")     ? scene.file
                             : key == std::string("camera") ? scene.camera
                                                            : scene.size);
    EXPECT_EQ(made["bounces"], scene.bounces);
    const Agreement found = compare(trace(scene, scene.size, samples), stored(scene.name));
    print_row(scene.name, found, samples, made["samples"]);
    EXPECT_NEAR(found.ratio, 1.0, 0.01);
    EXPECT_LT(3.0 * found.noise, 0.01);
    EXPECT_EQ(found.dark_blocks, 0);
}
INSTANTIATE_TEST_SUITE_P(Scenes, AnywhereCyclesOf, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& scene) { return scene.param.name; });

// Irradiance of the plane y = 0 by the three lamps of floor.gltf, as KHR_lights_punctual defines them; nothing casts a
// shadow.
glm::dvec3 irradiance_of_floor(glm::dvec3 place) {
    const auto towards = [&](glm::dvec3 lamp, double& cosine) {
        const glm::dvec3 way = lamp - place;
        const double squared = glm::dot(way, way);
        cosine = way.y / std::sqrt(squared);
        return cosine / squared;
    };
    double cosine = 0.0;
    const glm::dvec3 point = 2.0 * glm::dvec3(1.0, 0.8, 0.5) * towards({1.0, 1.0, 0.5}, cosine);
    const double spot_lends = towards({-1.2, 2.0, -0.5}, cosine); // it shines straight down: the angles are equal
    const double falloff = std::clamp((cosine - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6)), 0.0, 1.0);
    const glm::dvec3 spot = 4.0 * glm::dvec3(0.5, 0.7, 1.0) * spot_lends * falloff * falloff;
    const glm::dvec3 sun = 1.5 * glm::dvec3(1.0, 1.0, 0.9) * std::sin(double(pi) / 3.0); // 60 degrees above the horizon
    return point + spot + sun;
}

// Mean over each pixel's square, of the closed form.
io::Picture picture_of_floor(std::uint32_t width, std::uint32_t height) {
    scene::CameraView camera;
    camera.position = {0.0f, 4.0f, 3.5f};
    camera.target = {0.0f, 0.0f, 0.0f};
    camera.vertical_field_of_view = glm::radians(60.0f);
    const shared::CameraRow row = scene::make_camera_row(camera, width, height);
    constexpr std::uint32_t side = 8;
    io::Picture picture{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) {
        glm::dvec3 sum(0.0);
        for (std::uint32_t k = 0; k < side * side; ++k) {
            const vec2 at = vec2(float(i % width), float(i / width)) +
                            (vec2(float(k % side), float(k / side)) + 0.5f) / float(side);
            const glm::dvec3 direction(shared::camera_ray(row, at));
            const glm::dvec3 place = glm::dvec3(camera.position) - double(camera.position.y) / direction.y * direction;
            if (direction.y < 0.0 && std::abs(place.x) < 3.0 && std::abs(place.z) < 3.0)
                sum += irradiance_of_floor(place);
        }
        picture.pixels.emplace_back(vec3(sum / double(side * side)), 1.0f);
    }
    return picture;
}

// Units of all lamps, and the camera: both renderers against the closed form, not against each other.
TEST(AnywhereCycles, AFloorUnderThreeLampsHasItsClosedForm) {
    const Case scene = find_case("floor");
    const io::Picture exact = picture_of_floor(96, 72);
    for (const io::Picture& picture : {trace(scene, "96x72", 256), stored("floor")}) {
        const Agreement found = compare(picture, exact);
        EXPECT_NEAR(found.ratio, 1.0, 0.001);
        EXPECT_LT(found.relative, 1e-3); // pixels at the floor's edge have noise
        EXPECT_EQ(found.dark_blocks, 0);
    }
}

// A closed box whose walls emit and reflect: the sum of a geometric series, at every pixel.
TEST(AnywhereCycles, AFurnaceHasItsClosedForm) {
    const Case scene = find_case("furnace");
    double sum = 0.0;
    for (unsigned bounce = 0; bounce <= scene.bounces; ++bounce)
        sum += std::pow(0.5, bounce);
    const io::Picture exact{96, 72, std::vector<vec4>(96 * 72, vec4(vec3(float(double(pi) * sum)), 1.0f))};
    for (const io::Picture& picture : {trace(scene, "96x72", 64), stored("furnace")})
        EXPECT_NEAR(compare(picture, exact).ratio, 1.0, 0.001);
}

// Irradiance at a place with that normal by a Lambertian polygon that it sees whole: J. H. Lambert's formula.
double irradiance_of_polygon(glm::dvec3 place, glm::dvec3 normal, const std::vector<glm::dvec3>& corners,
                             double radiance) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - place);
        const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()] - place);
        const glm::dvec3 across = glm::cross(a, b);
        sum += std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
    }
    return std::abs(0.5 * radiance * sum);
}

// The back wall of `cornell` above the blocks, up to where its lamp is seen at a grazing angle. There Cycles lost up to
// 6 % of large triangles' light, and so was not the judge (docs/reference.md).
TEST(AnywhereCycles, AWallUnderALampHasItsClosedForm) {
    Case scene = find_case("cornell");
    scene.bounces = 0;
    const io::Picture picture = trace(scene, "96x72", 256);
    ASSERT_EQ(picture.pixels.size(), 96u * 72u);
    scene::CameraView camera;
    camera.position = {2.78f, 2.73f, 13.3f};
    camera.target = {2.78f, 2.73f, 11.3f};
    camera.vertical_field_of_view = glm::radians(39.3f);
    const shared::CameraRow row = scene::make_camera_row(camera, 96, 72);
    const std::vector<glm::dvec3> lamp = {
        {2.13, 5.488, 2.27}, {3.43, 5.488, 2.27}, {3.43, 5.488, 3.32}, {2.13, 5.488, 3.32}};
    struct Sums {
        double traced = 0.0, exact = 0.0;
        int pixels = 0;
    } whole, top;
    for (std::uint32_t i = 0; i < 96 * 72; ++i) {
        const glm::dvec3 direction(shared::camera_ray(row, vec2(float(i % 96), float(i / 96)) + 0.5f));
        const glm::dvec3 place = glm::dvec3(camera.position) + direction * (double(camera.position.z) / -direction.z);
        if (place.x < 0.2 || place.x > 5.3 || place.y < 3.6 || place.y > 5.35)
            continue;
        const double exact = irradiance_of_polygon(place, {0.0, 0.0, 1.0}, lamp, 17.0);
        for (Sums* sums : {&whole, &top})
            if (sums == &whole || place.y > 5.1) {
                sums->traced += double(picture.pixels[i].x);
                sums->exact += exact;
                ++sums->pixels;
            }
    }
    EXPECT_GT(top.pixels, 50);
    EXPECT_NEAR(whole.traced / whole.exact, 1.0, 0.002);
    EXPECT_NEAR(top.traced / top.exact, 1.0, 0.01);
}

// The script still makes what is stored. Three standard errors of so few samples are 2 %.
TEST(AnywhereCycles, ANewPictureAgreesToo) {
    if (shell("command -v blender").status != 0)
        GTEST_SKIP() << "Debian's package 'blender' is not installed";
    const Folder folder;
    const Outcome outcome =
        shell("blender --background --factory-startup --python-exit-code 1 --python " + (here / "render.py").string() +
              " -- --output " + folder.path.string() + " --size 32x24 --samples 256 lamps");
    if (outcome.status == 77)
        GTEST_SKIP() << outcome.output;
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const Agreement found = compare(trace(find_case("lamps"), "32x24", 512), read(folder.path / "lamps.exr"));
    EXPECT_NEAR(found.ratio, 1.0, 0.02);
    EXPECT_LT(3.0 * found.noise, 0.02);
    EXPECT_EQ(found.dark_blocks, 0);
}

} // namespace
} // namespace sunfleck::tests

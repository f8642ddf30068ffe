// Edges of a picture that is enlarged, against pictures with sixteen samples a pixel; and which faces a picture needs.
#include "editor/command_line/picture_measures.h"
#include "engine/scene/mesh_detail.h"
#include "engine/scene/procedural.h"
#include "tests/support/gpu_world.h"

namespace sunfleck::tests {
namespace {

using command_line::box_filtered;
using command_line::edge_error;

class SubpixelEdges : public GpuTest {};

scene::Material shown_as(float brightness) {
    scene::Material material;
    material.base_colour = vec3(brightness);
    material.unlit = true;
    return material;
}

scene::Material lamp_of(float radiance) {
    scene::Material material;
    material.base_colour = vec3(0.0f);
    material.emission = vec3(radiance);
    return material;
}

// Eight by eight tiles of two colours.
scene::Texture tiles_texture() {
    scene::Texture texture;
    texture.name = "tiles";
    texture.width = texture.height = 64;
    for (std::uint32_t i = 0; i < 64 * 64; ++i) {
        const std::uint8_t value = (i / 8 + i / 512) % 2 == 0 ? 230 : 40;
        texture.pixels.insert(texture.pixels.end(), {value, std::uint8_t(value / 2), 20, 255});
    }
    return texture;
}

// Of 256x144 pixels, made of fewer.
struct EnlargedScene : GpuWorld {
    explicit EnlargedScene(void (*make)(assets::SceneBuilder&)) {
        renderer->textures().add(tiles_texture());
        assets::SceneBuilder builder(renderer->registry(), renderer->meshes());
        make(builder);
        finish("view");
        request.view = shared::view_final;
        request.tone_map = true;
        request.camera.up = glm::normalize(vec3(0.07f, 1.0f, 0.03f)); // nothing runs along rows or columns
    }
    io::Picture at(std::uint32_t width, bool antialiasing, std::uint32_t screen_width = 256) {
        request.width = width;
        request.height = width * 9 / 16;
        request.screen_width = screen_width;
        request.screen_height = screen_width * 9 / 16;
        request.antialiasing = antialiasing;
        return picture();
    }
    io::Picture truth() { return box_filtered(at(1024, false, 1024), 4); }
};

// A plate before a wall.
void make_silhouette(assets::SceneBuilder& s) {
    s.quad("wall", vec3(-4, -4, 0), vec3(8, 0, 0), vec3(0, 8, 0), shown_as(0.6f));
    s.quad("plate", vec3(-0.4f, -0.3f, 0.5f), vec3(0.8f, 0, 0), vec3(0, 0.6f, 0), shown_as(0.2f));
    s.camera("view", vec3(0.1f, 0.05f, 2.5f), vec3(0), 40.0f);
}

// Two walls and a floor that meet, all of one mesh.
void make_corner(assets::SceneBuilder& s) {
    s.quad("floor", vec3(-2, -0.5f, -1), vec3(0, 0, 4), vec3(4, 0, 0), shown_as(0.2f));
    s.quad("left", vec3(-2, -0.5f, -1), vec3(2.2f, 0, 0), vec3(0, 3, 0), shown_as(0.5f));
    s.quad("right", vec3(0.2f, -0.5f, -1), vec3(1.5f, 0, 1.5f), vec3(0, 3, 0), shown_as(0.8f));
    s.camera("view", vec3(0, 0.3f, 2.5f), vec3(0), 40.0f);
}

// Lamps almost in a wall's plane, which is nearer than a tenth of a pixel; two of them side by side.
void make_flush_lamps(assets::SceneBuilder& s) {
    s.quad("wall", vec3(-4, -4, 0), vec3(8, 0, 0), vec3(0, 8, 0), shown_as(0.3f));
    s.quad("lamp", vec3(-0.5f, -0.3f, 2e-4f), vec3(0.5f, 0, 0), vec3(0, 0.6f, 0), lamp_of(2.0f));
    s.quad("dim lamp", vec3(0.0f, -0.3f, 2e-4f), vec3(0.5f, 0, 0), vec3(0, 0.6f, 0), lamp_of(0.5f));
    s.camera("view", vec3(0.1f, 0.05f, 2.5f), vec3(0), 40.0f);
}

// A ball before nothing, whose silhouette no plane explains.
void make_ball(assets::SceneBuilder& s) {
    s.add("ball", scene::make_sphere(0.5f, 48, 24), shown_as(0.6f));
    s.camera("view", vec3(0.1f, 0.05f, 2.5f), vec3(0), 40.0f);
}

// The truth has sixteen samples a pixel, and the picture four, at other places. 0.04 to 0.19 of the error of an
// enlargement that knows no edges here; 0.26 for the ball.
TEST_F(SubpixelEdges, AreWhereSurfacesAre) {
    const std::pair<const char*, void (*)(assets::SceneBuilder&)> scenes[] = {{"silhouette", make_silhouette},
                                                                              {"corner", make_corner},
                                                                              {"flush lamps", make_flush_lamps},
                                                                              {"ball", make_ball}};
    for (const auto& [name, make] : scenes)
        for (const std::uint32_t width : {128u, 160u, 208u}) { // doubled, and not
            EnlargedScene scene(make);
            const io::Picture truth = scene.truth();
            const double without = edge_error(scene.at(width, false), truth);
            const double with = edge_error(scene.at(width, true), truth);
            std::printf("%s, from %u pixels: %.4f, without %.4f\n", name, width, with, without);
            EXPECT_LT(with, 0.3 * without) << name << " from " << width;
        }
}

// A surface that no pixel showed in the frame before is drawn as if it always had been seen.
TEST_F(SubpixelEdges, NothingIsLeftOfTheFramesBefore) {
    EnlargedScene scene(make_silhouette), fresh(make_silhouette);
    static_cast<void>(scene.at(128, true));
    const scene::CameraView camera = scene.request.camera;
    scene.request.camera.target = camera.position + (camera.position - camera.target);
    const io::Picture away = scene.at(128, true);
    EXPECT_EQ(away.pixels, std::vector<vec4>(away.pixels.size(), away.pixels.front()));
    scene.request.camera = camera;
    EXPECT_EQ(scene.at(128, true).pixels, fresh.at(128, true).pixels);
}

TEST_F(SubpixelEdges, WhatHasNoContrastIsAsWithoutThem) {
    EnlargedScene scene(make_corner);
    const io::Picture with = scene.at(128, true), without = scene.at(128, false);
    ASSERT_EQ(with.pixels.size(), without.pixels.size());
    std::size_t same = 0;
    for (std::size_t i = 0; i < with.pixels.size(); ++i)
        same += with.pixels[i] == without.pixels[i];
    EXPECT_GT(same, with.pixels.size() * 9 / 10); // all but the corner's lines
    EXPECT_LT(same, with.pixels.size());
}

// Floors that a lamp lights, seen flatly.
ecs::Entity make_floor(assets::SceneBuilder& s, const scene::Material& material, bool has_coordinates = false) {
    s.point_light("lamp", vec3(0.3f, 1.5f, -0.5f), vec3(8.0f));
    s.camera("view", vec3(0.1f, 0.7f, 2.0f), vec3(0, 0, -0.4f), 50.0f);
    scene::Mesh floor;
    floor.positions = {vec3(-8, 0, 6), vec3(8, 0, 6), vec3(8, 0, -14), vec3(-8, 0, -14)};
    floor.normals.assign(4, vec3(0, 1, 0));
    floor.indices = {0, 1, 2, 0, 2, 3};
    for (const vec3 position : has_coordinates ? floor.positions : std::vector<vec3>()) // which leave no pattern
        floor.texture_coordinates.emplace_back(position.x, position.z, 0, 0);
    return s.add("floor", floor, material);
}
void make_checkers(assets::SceneBuilder& s) {
    const scene::SurfacePattern pattern{scene::PatternKind::checker, vec3(0.05f, 0.1f, 0.2f), 0.12f};
    s.registry().emplace<scene::SurfacePattern>(make_floor(s, assets::diffuse(vec3(0.7f, 0.5f, 0.3f))), pattern);
}
void make_bricks(assets::SceneBuilder& s) {
    const scene::SurfacePattern pattern{scene::PatternKind::bricks, vec3(0.5f), 0.12f};
    s.registry().emplace<scene::SurfacePattern>(make_floor(s, assets::diffuse(vec3(0.5f, 0.2f, 0.1f))), pattern);
}
scene::Material polished(vec3 colour) {
    scene::Material material = assets::diffuse(colour);
    material.specular = true;
    material.roughness = 0.3f;
    return material;
}
void make_polished_planks(assets::SceneBuilder& s) {
    const scene::SurfacePattern pattern{scene::PatternKind::planks, vec3(0.05f, 0.1f, 0.2f), 0.12f};
    s.registry().emplace<scene::SurfacePattern>(make_floor(s, polished(vec3(0.4f))), pattern);
}
void make_tiles(assets::SceneBuilder& s) {
    scene::MaterialTextures textures;
    textures.base_colour.texture = 0;
    s.registry().emplace<scene::MaterialTextures>(make_floor(s, assets::diffuse(vec3(0.9f)), true), textures);
}

// Textures and patterns are as sharp as in a picture of the screen's size, against one of sixteen times the pixels.
TEST_F(SubpixelEdges, TexturesHaveTheScreensSize) {
    const std::pair<const char*, void (*)(assets::SceneBuilder&)> scenes[] = {{"checkers", make_checkers},
                                                                              {"bricks", make_bricks},
                                                                              {"polished planks", make_polished_planks},
                                                                              {"tiles", make_tiles}};
    for (const auto& [name, make] : scenes) {
        EnlargedScene scene(make);
        scene.request.ev100 = 8.0f;
        const io::Picture truth = scene.truth();
        const double whole = edge_error(scene.at(256, false), truth);
        for (const std::uint32_t width : {128u, 160u, 208u}) {
            const double without = edge_error(scene.at(width, false), truth);
            const double with = edge_error(scene.at(width, true), truth);
            std::printf("%s, from %u pixels: %.4f, without %.4f, at the screen's size %.4f\n", name, width, with,
                        without, whole);
            EXPECT_LT(with, 1.05 * whole) << name << " from " << width;
            EXPECT_LT(whole, 0.7 * without) << name << " from " << width;
        }
    }
}

// Where the picture is as bright as can be, what is darker than its surroundings is not found by taking away more than
// it shows.
TEST_F(SubpixelEdges, TexturesThatAreTooBrightHaveNoBlackPixels) {
    for (const float ev100 : {2.0f, 4.0f, 6.0f}) {
        EnlargedScene scene(make_checkers);
        scene.request.ev100 = ev100;
        const io::Picture whole = scene.at(256, false);
        for (const std::uint32_t width : {128u, 160u}) {
            const io::Picture picture = scene.at(width, true);
            std::size_t bright = 0, black = 0;
            for (std::size_t i = 0; i < whole.pixels.size(); ++i)
                if (luminance(whole.pixels[i]) > 0.5f) {
                    ++bright;
                    black += luminance(picture.pixels[i]) < 0.1f;
                }
            EXPECT_GT(bright, whole.pixels.size() / 4);
            EXPECT_EQ(black, 0u) << "EV " << ev100 << " from " << width;
        }
    }
}

scene::Mesh turned_inside_out(scene::Mesh mesh) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        std::swap(mesh.indices[i], mesh.indices[i + 1]);
    return mesh;
}

// A box whose triangles face inwards hides what is behind it as any other does.
TEST_F(SubpixelEdges, BoxesOfEitherSideShowTheirNearFaces) {
    const auto depths = [](bool inside_out, vec3 position) {
        GpuWorld world;
        assets::SceneBuilder builder(world.renderer->registry(), world.renderer->meshes());
        const scene::Mesh box = scene::make_box(vec3(1.0f));
        builder.add("box", inside_out ? turned_inside_out(box) : box, shown_as(0.5f));
        builder.camera("view", position, vec3(0.1f, 0.0f, 0.0f), 50.0f);
        world.finish("view");
        world.request.view = shared::view_depth;
        return world.picture().pixels;
    };
    for (const vec3 position : {vec3(1.0f, 0.8f, 2.0f), vec3(0.2f, 0.1f, 0.3f)}) { // outside and inside
        const std::vector<vec4> usual = depths(false, position), other = depths(true, position);
        ASSERT_EQ(usual.size(), other.size());
        for (std::size_t i = 0; i < usual.size(); ++i) // vertices in another order are rounded differently
            ASSERT_NEAR(usual[i].x, other[i].x, 1e-5f * usual[i].x) << "pixel " << i;
    }
}

TEST(SolidMeshes, HaveAllTheirFacesOutside) {
    const auto is_solid = [](const scene::Mesh& mesh) {
        return scene::is_solid(scene::make_mesh_details(mesh).front().indices, mesh.positions);
    };
    const auto with = [](scene::Mesh mesh, const scene::Mesh& other, vec3 offset) {
        const std::uint32_t first = std::uint32_t(mesh.positions.size());
        for (const vec3 position : other.positions)
            mesh.positions.push_back(position + offset);
        mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
        for (const std::uint32_t index : other.indices)
            mesh.indices.push_back(first + index);
        return mesh;
    };
    const scene::Mesh box = scene::make_box(vec3(1.0f)), inverse = turned_inside_out(box);
    EXPECT_TRUE(is_solid(box));
    EXPECT_FALSE(is_solid(inverse));
    EXPECT_TRUE(is_solid(with(box, box, vec3(300.0f, 0.0f, 0.0f))));
    EXPECT_FALSE(is_solid(with(box, inverse, vec3(3.0f, 0.0f, 0.0f)))); // though the volumes' sum is not negative
    EXPECT_FALSE(is_solid(with(inverse, scene::make_box(vec3(2.0f)), vec3(3.0f, 0.0f, 0.0f))));
    scene::Mesh open = box;
    open.indices.resize(open.indices.size() - 3);
    EXPECT_FALSE(is_solid(open));
}

} // namespace
} // namespace sunfleck::tests

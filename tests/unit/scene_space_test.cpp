// The space that a scene is lit in.
#include "assets/scene_builder.h"
#include "engine/scene/scene_changes.h"

#include <gtest/gtest.h>

namespace sunfleck::scene {
namespace {

mat4 placed(vec3 at, vec3 size) {
    mat4 matrix(1.0f);
    for (int c = 0; c < 3; ++c)
        matrix[c][c] = size[c];
    matrix[3] = vec4(at, 1.0f);
    return matrix;
}

// A cube of side 1 about the origin.
struct Cube {
    MeshStore meshes;
    Cube() {
        Mesh mesh;
        for (int i = 0; i < 8; ++i)
            mesh.positions.push_back(vec3(i & 1, i >> 1 & 1, i >> 2) - 0.5f);
        mesh.normals.assign(8, vec3(0, 1, 0));
        mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
        meshes.add(std::move(mesh));
    }
    SceneSpace of(vec3 at, vec3 size) const {
        const PlacedMesh geometry[] = {{0, placed(at, size)}};
        return space_of(geometry, meshes);
    }
};

TEST(SceneSpace, RoomsAreAFewUnitsLarge) {
    const Cube cube;
    EXPECT_EQ(cube.of(vec3(0.0f), vec3(6.0f)).unit, 1.0f); // its mean chord is 4 m
    EXPECT_EQ(cube.of(vec3(0.0f), vec3(600.0f)).unit, 128.0f);
    EXPECT_EQ(cube.of(vec3(0.0f), vec3(0.06f)).unit, 0x1p-7f);
    for (const float scale : {0x1p-9f, 0x1p-1f, 0x1p4f})
        EXPECT_EQ(cube.of(vec3(0.0f), vec3(5.0f, 3.0f, 7.0f) * scale).unit,
                  cube.of(vec3(0.0f), vec3(5.0f, 3.0f, 7.0f)).unit * scale);
}

TEST(SceneSpace, SheetsAndNothingHaveAUnit) {
    const Cube cube;
    const float sheet = cube.of(vec3(0.0f), vec3(10.0f, 0.0f, 10.0f)).unit;
    EXPECT_GT(sheet, 0.2f);
    EXPECT_LT(sheet, 10.0f);
    EXPECT_EQ(space_of({}, cube.meshes), SceneSpace());
    EXPECT_EQ(cube.of(vec3(0.0f), vec3(0.0f)), SceneSpace());
    EXPECT_EQ(cube.of(vec3(1e30f), vec3(1e30f)), SceneSpace()); // areas overflow
}

TEST(SceneSpace, OnlyFarAwayScenesGetAnOriginOfTheirOwn) {
    const Cube cube;
    EXPECT_EQ(cube.of(vec3(20.0f, 0.0f, -15.0f), vec3(4.0f)).origin, vec3(0.0f));
    const vec3 far(5000.0f, 300.0f, -2000.0f);
    const SceneSpace space = cube.of(far, vec3(4.0f));
    EXPECT_NE(space.origin, vec3(0.0f));
    EXPECT_LT(glm::length(space.point(far)), 16.0f * 4.0f);
    EXPECT_EQ(cube.of(far + vec3(0.5f), vec3(4.0f)), space); // a step away nothing changes
}

TEST(SceneSpace, PointsCamerasAndMatricesAgree) {
    const SceneSpace space{8.0f, vec3(1024.0f, 0.0f, -2048.0f)};
    const vec3 world(1030.0f, 4.0f, -2000.0f);
    EXPECT_EQ(space.point(world) * space.unit + space.origin, world);
    const mat4 matrix = placed(world, vec3(2.0f, 3.0f, 4.0f));
    const vec3 corner(0.5f, -0.5f, 0.5f);
    EXPECT_EQ(vec3(space.place(matrix) * vec4(corner, 1.0f)), space.point(vec3(matrix * vec4(corner, 1.0f))));
    CameraView view;
    view.position = world;
    view.target = world + vec3(3.0f, -1.0f, 5.0f);
    const glm::dmat4 clip(make_camera_row(view, 64, 48).view_projection);
    const glm::dvec4 expected = clip * glm::dvec4(glm::dvec3(world + vec3(2.0f, 0.0f, 3.0f)), 1.0);
    const glm::dvec4 found =
        space.to_clip(clip) * glm::dvec4(glm::dvec3(space.point(world + vec3(2.0f, 0.0f, 3.0f))), 1.0);
    EXPECT_LT(glm::length(found - expected), 1e-6 * glm::length(expected));
    const vec4 own = make_camera_row(space.view(view), 64, 48).view_projection *
                     vec4(space.point(world + vec3(2.0f, 0.0f, 3.0f)), 1.0f);
    EXPECT_NEAR(own.x / own.w, float(expected.x / expected.w), 1e-3f);
    EXPECT_NEAR(own.y / own.w, float(expected.y / expected.w), 1e-3f);
}

// Whoever follows the changes must see all of them again when the space is another.
TEST(SceneSpace, AnotherSpaceChangesEverything) {
    ecs::Registry registry;
    register_components(registry);
    MeshStore meshes = Cube().meshes;
    const auto add = [&](vec3 at, vec3 size) {
        const ecs::Entity entity = registry.create();
        registry.emplace<MeshInstance>(entity, MeshInstance{0});
        registry.emplace<WorldTransform>(entity, WorldTransform{placed(at, size)});
        return entity;
    };
    add(vec3(0.0f), vec3(6.0f));
    const ecs::Entity mover = add(vec3(0.0f), vec3(0.5f));
    registry.emplace<Mover>(mover, Mover{});
    ChangeTracker tracker(ChangeTracker::Space::of_scene), world;
    EXPECT_EQ(tracker.collect(registry, meshes).space, SceneSpace());
    EXPECT_EQ(world.collect(registry, meshes).all.size(), 2u);
    registry.update<WorldTransform>(mover, {placed(vec3(90.0f), vec3(60.0f))});
    EXPECT_FALSE(tracker.collect(registry, meshes).everything); // movers do not count
    const ecs::Entity hall = add(vec3(0.0f), vec3(30.0f));
    const SceneChanges& changes = tracker.collect(registry, meshes);
    EXPECT_TRUE(changes.everything);
    EXPECT_EQ(changes.drawables.size(), 3u);
    EXPECT_GT(changes.space.unit, 1.0f);
    for (const Drawable* drawable : changes.all) {
        if (drawable->entity != hall)
            continue;
        EXPECT_EQ(drawable->bounds.extent(), vec3(30.0f / changes.space.unit));
    }
    EXPECT_FALSE(tracker.collect(registry, meshes).everything);
    EXPECT_FALSE(world.collect(registry, meshes).everything);
    EXPECT_EQ(world.collect(registry, meshes).space, SceneSpace());
    // Another scene, without static geometry: the space of the one before is not its own.
    ecs::Registry other;
    register_components(other);
    const ecs::Entity alone = other.create();
    other.emplace<MeshInstance>(alone, MeshInstance{0});
    other.emplace<WorldTransform>(alone, WorldTransform{});
    other.emplace<Mover>(alone, Mover{});
    EXPECT_EQ(tracker.collect(other, meshes).space, SceneSpace());
}

} // namespace
} // namespace sunfleck::scene

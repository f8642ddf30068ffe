#include "engine/raytrace/ray_scene.h"
#include "engine/scene/mesh_detail.h"
#include "engine/scene/scene_changes.h"
#include "tests/support/scene_editor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace sunfleck::scene {
namespace {

using tests::SceneEditor;

using Values = std::vector<float>;
using Snapshot = std::map<ecs::Entity, Values>;

void add(Values& values, vec3 v) {
    values.insert(values.end(), {v.x, v.y, v.z});
}

void add(Values& values, const mat4& matrix) {
    for (int i = 0; i < 16; ++i)
        values.push_back(matrix[i / 4][i % 4]);
}

// Every value of every drawable, read by brute force; empty where the entity is none.
Values drawable_values(ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity) {
    Values values;
    const MeshInstance* instance = registry.try_get<MeshInstance>(entity);
    const WorldTransform* world = registry.try_get<WorldTransform>(entity);
    if (instance == nullptr || world == nullptr || instance->mesh >= meshes.size())
        return values;
    values = {float(instance->mesh), float(meshes.revision(instance->mesh)), float(is_static(registry, entity))};
    add(values, world->matrix);
    const Material material = registry.has<Material>(entity) ? registry.get<Material>(entity) : Material{};
    add(values, material.base_colour);
    add(values, material.emission);
    values.push_back(float(material.alpha_mode));
    const auto* textures = registry.try_get<MaterialTextures>(entity);
    values.push_back(textures == nullptr ? -2.0f : float(textures->base_colour.texture));
    const auto* pattern = registry.try_get<SurfacePattern>(entity);
    values.push_back(pattern == nullptr ? -1.0f : pattern->scale);
    values.push_back(float(registry.has<AreaLight>(entity)));
    const auto* casting = registry.try_get<ShadowCasting>(entity);
    values.push_back(is_static(registry, entity) || casting == nullptr || casting->casts ? 1.0f : 0.0f);
    return values;
}

bool emits(ecs::Registry& registry, ecs::Entity entity) {
    const Material* material = registry.try_get<Material>(entity);
    return registry.has<PointLight>(entity) || registry.has<AreaLight>(entity) ||
           (material != nullptr && material->emission != vec3(0.0f));
}

Values emitter_values(ecs::Registry& registry, const MeshStore& meshes, ecs::Entity entity) {
    Values values;
    const PointLight* point = registry.try_get<PointLight>(entity);
    add(values, point == nullptr ? vec3(-1.0f) : point->intensity);
    const AreaLight* area = registry.try_get<AreaLight>(entity);
    add(values, area == nullptr ? vec3(-1.0f) : area->radiance);
    const Material* material = registry.try_get<Material>(entity);
    add(values, material == nullptr ? vec3(0.0f) : material->emission);
    const WorldTransform* world = registry.try_get<WorldTransform>(entity);
    add(values, world == nullptr ? mat4(0.0f) : world->matrix);
    const MeshInstance* instance = registry.try_get<MeshInstance>(entity);
    const bool has_mesh = instance != nullptr && instance->mesh < meshes.size();
    values.push_back(has_mesh ? float(instance->mesh) : -1.0f);
    values.push_back(has_mesh ? float(meshes.revision(instance->mesh)) : -1.0f);
    values.push_back(float(is_static(registry, entity)));
    return values;
}

// A tracker beside copies of everything.
struct Follower {
    ChangeTracker tracker;
    Snapshot drawables, emitters;
    std::size_t changes = 0, emitter_changes = 0;

    void check(ecs::Registry& registry, const MeshStore& meshes) {
        Snapshot drawables_now, emitters_now;
        for (const ecs::Entity entity : registry.entities()) {
            if (Values values = drawable_values(registry, meshes, entity); !values.empty())
                drawables_now[entity] = std::move(values);
            // Whatever emitted once is known for as long as it has a material.
            if (emits(registry, entity) || (emitters.count(entity) && registry.has<Material>(entity)))
                emitters_now[entity] = emitter_values(registry, meshes, entity);
        }
        const SceneChanges& found = tracker.collect(registry, meshes);
        EXPECT_EQ(keys(found.drawables), difference(drawables, drawables_now));
        EXPECT_EQ(std::vector<ecs::Entity>(found.emitters.begin(), found.emitters.end()),
                  difference(emitters, emitters_now));
        check_values(found, drawables_now);
        check_order(registry, meshes, found);
        changes += found.drawables.size();
        emitter_changes += found.emitters.size();
        drawables = std::move(drawables_now);
        emitters = std::move(emitters_now);
    }

    static std::vector<ecs::Entity> keys(std::span<const DrawableChange> list) {
        std::vector<ecs::Entity> result;
        for (const DrawableChange& change : list)
            result.push_back(change.entity);
        return result;
    }
    static std::vector<ecs::Entity> difference(const Snapshot& before, const Snapshot& now) {
        std::vector<ecs::Entity> result;
        for (const auto& [entity, values] : before)
            if (const auto found = now.find(entity); found == now.end() || found->second != values)
                result.push_back(entity);
        for (const auto& [entity, values] : now)
            if (before.count(entity) == 0)
                result.push_back(entity);
        std::sort(result.begin(), result.end());
        return result;
    }
    void check_values(const SceneChanges& found, const Snapshot& now) const {
        bool static_geometry = false;
        for (const DrawableChange& change : found.drawables) {
            const auto before = drawables.find(change.entity), after = now.find(change.entity);
            ASSERT_EQ(change.added(), before == drawables.end());
            ASSERT_EQ(change.removed(), after == now.end());
            // The first values are the mesh, its revision, whether it is static, and its place.
            const auto shape = [](const Values& v) { return Values(v.begin(), v.begin() + 19); };
            const bool reshaped = change.added() || change.removed() || shape(before->second) != shape(after->second);
            const bool was_static = !change.added() && before->second[2] > 0.0f;
            const bool is_static = !change.removed() && after->second[2] > 0.0f;
            const bool alpha = !change.added() && !change.removed() && before->second[25] != after->second[25];
            static_geometry = static_geometry || ((was_static || is_static) && (reshaped || alpha));
            if (!change.removed()) {
                EXPECT_EQ(change.now->matrix[3].x, after->second[3 + 12]);
            }
        }
        EXPECT_LE(found.static_geometry, static_geometry || holes_changed(found));
        EXPECT_GE(found.static_geometry, static_geometry);
    }
    static bool holes_changed(const SceneChanges& found) {
        return std::any_of(found.drawables.begin(), found.drawables.end(), [](const DrawableChange& change) {
            return change.is_static() && change.now != nullptr &&
                   change.now->material.alpha_mode != AlphaMode::opaque && change.surface_changed();
        });
    }
    static void check_order(ecs::Registry& registry, const MeshStore& meshes, const SceneChanges& found) {
        std::vector<ecs::Entity> expected, listed;
        registry.view<MeshInstance, WorldTransform>().each(
            [&](ecs::Entity entity, const MeshInstance& instance, const WorldTransform&) {
                if (instance.mesh < meshes.size())
                    expected.push_back(entity);
            });
        for (const Drawable* drawable : found.all)
            listed.push_back(drawable->entity);
        EXPECT_EQ(listed, expected);
    }
};

TEST(SceneChanges, TrackersAgreeWithComparingEverythingWhateverTheirRates) {
    SceneEditor editor;
    Follower often, seldom;
    std::mt19937 random(3);
    std::uint32_t wait = 0;
    for (int step = 0; step < 2000 && !testing::Test::HasFailure(); ++step) {
        editor.edit();
        often.check(editor.registry, editor.meshes);
        if (wait-- == 0) {
            seldom.check(editor.registry, editor.meshes);
            wait = std::uint32_t(random() % 40);
        }
    }
    EXPECT_GT(often.changes, 1000u);
    EXPECT_GT(often.emitter_changes, 300u);
    EXPECT_GT(seldom.changes, 300u);
}

TEST(SceneChanges, AFrameWithoutStampsLooksAtNothing) {
    SceneEditor editor;
    for (int i = 0; i < 500; ++i)
        editor.edit();
    ChangeTracker tracker;
    EXPECT_TRUE(tracker.collect(editor.registry, editor.meshes).everything);
    for (int frame = 0; frame < 3; ++frame) {
        update_world_transforms(editor.registry);
        const SceneChanges& changes = tracker.collect(editor.registry, editor.meshes);
        EXPECT_EQ(changes.examined, 0u);
        EXPECT_TRUE(changes.drawables.empty() && changes.emitters.empty() && changes.meshes.empty());
        EXPECT_FALSE(changes.everything || changes.order_changed || changes.static_geometry);
        EXPECT_FALSE(changes.all.empty());
    }
    const ecs::Entity one = tracker.collect(editor.registry, editor.meshes).all.front()->entity;
    editor.registry.patch<WorldTransform>(one, [](WorldTransform&) {});
    const SceneChanges& changes = tracker.collect(editor.registry, editor.meshes);
    EXPECT_EQ(changes.examined, 1u);
    EXPECT_TRUE(changes.drawables.empty());
}

// The registry's log of removals is bounded; who comes too late for it compares everything, and finds the same.
TEST(SceneChanges, FollowsThroughMoreRemovalsThanAreLogged) {
    ecs::Registry registry;
    MeshStore meshes;
    meshes.add(tests::triangle(1.0f));
    const auto make = [&] {
        const ecs::Entity entity = registry.create();
        registry.emplace<MeshInstance>(entity);
        registry.emplace<WorldTransform>(entity);
        registry.emplace<PointLight>(entity);
        return entity;
    };
    std::vector<ecs::Entity> first;
    for (int i = 0; i < 5; ++i)
        first.push_back(make());
    ChangeTracker slow, quick;
    slow.collect(registry, meshes);
    quick.collect(registry, meshes);
    registry.destroy(first[1]);
    for (std::size_t i = 0; i < 2 * ecs::PoolBase::removals_kept; ++i) {
        registry.destroy(make());
        quick.collect(registry, meshes);
    }
    EXPECT_FALSE(registry.knows_removals_since<MeshInstance>(1));
    const SceneChanges& changes = slow.collect(registry, meshes);
    EXPECT_FALSE(changes.everything);
    ASSERT_EQ(changes.drawables.size(), 1u);
    EXPECT_EQ(changes.drawables[0].entity, first[1]);
    EXPECT_TRUE(changes.drawables[0].removed());
    ASSERT_EQ(changes.emitters.size(), 1u);
    EXPECT_EQ(changes.emitters[0], first[1]);
    EXPECT_EQ(changes.all.size(), 4u);
}

TEST(SceneChanges, AnotherRegistryOrAForcedCollectIsEverything) {
    SceneEditor first, second;
    for (int i = 0; i < 50; ++i)
        first.edit();
    for (int i = 0; i < 90; ++i)
        second.edit();
    ChangeTracker tracker;
    ChangeCursor cursor;
    const auto collect = [&](SceneEditor& editor) {
        const SceneChanges& changes = tracker.collect(editor.registry, editor.meshes);
        const bool follows = cursor.follows(changes);
        EXPECT_NE(follows, changes.everything);
        EXPECT_TRUE(follows || changes.drawables.size() == changes.all.size());
        cursor.saw(changes);
        return follows;
    };
    EXPECT_FALSE(collect(first));
    EXPECT_TRUE(collect(first));
    EXPECT_FALSE(collect(second));
    EXPECT_TRUE(collect(second));
    tracker.force_everything();
    EXPECT_FALSE(collect(second));
    EXPECT_TRUE(collect(second));
    tracker.collect(second.registry, second.meshes); // missed
    EXPECT_FALSE(cursor.follows(tracker.collect(second.registry, second.meshes)));
}

// Whatever the edits, rays meet what they meet in a scene built from scratch, and nothing is built where nothing
// changed.
TEST(SceneChanges, ARaySceneThatFollowsEqualsOneFromScratch) {
    SceneEditor editor;
    ChangeTracker tracker;
    auto followed = raytrace::RayScene::create().value();
    std::mt19937 random(5);
    const auto number = [&] { return float(random() >> 8) * 0x1p-24f; };
    std::size_t hits = 0;
    for (int step = 0; step < 600; ++step) {
        editor.edit();
        ASSERT_TRUE(followed->update(tracker.collect(editor.registry, editor.meshes), editor.meshes));
        const std::uint64_t generation = followed->generation(), builds = followed->static_builds();
        ASSERT_TRUE(followed->update(tracker.collect(editor.registry, editor.meshes), editor.meshes));
        ASSERT_EQ(followed->generation(), generation);
        ASSERT_EQ(followed->static_builds(), builds);
        if (step % 20 != 19)
            continue;
        auto fresh = raytrace::RayScene::create().value();
        ASSERT_TRUE(fresh->update(editor.registry, editor.meshes));
        EXPECT_FLOAT_EQ(fresh->static_area(), followed->static_area());
        for (int i = 0; i < 200; ++i) {
            const raytrace::Ray ray{vec3(8.0f * number(), 8.0f * number(), 5.0f), vec3(0.0f, 0.0f, -1.0f)};
            for (const auto scope : {raytrace::Scope::everything, raytrace::Scope::static_only}) {
                const auto a = followed->closest_hit(ray, scope), b = fresh->closest_hit(ray, scope);
                ASSERT_EQ(a.has_value(), b.has_value());
                hits += a.has_value();
            }
        }
    }
    EXPECT_GT(hits, 500u);
}

// A height field of 320,000 triangles: its levels of detail are made one by one, and whoever watches can stop after
// each.
TEST(MeshDetail, ALargeMeshSaysHowFarItsLevelsAre) {
    constexpr std::uint32_t side = 401;
    scene::Mesh mesh;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x)
            mesh.positions.emplace_back(float(x), std::sin(0.05f * float(x)) * std::cos(0.07f * float(y)), float(y));
    for (std::uint32_t y = 0; y + 1 < side; ++y)
        for (std::uint32_t x = 0; x + 1 < side; ++x) {
            const std::uint32_t i = y * side + x;
            for (const std::uint32_t corner : {i, i + side, i + 1, i + 1, i + side, i + side + 1})
                mesh.indices.push_back(corner);
        }
    std::vector<float> shares;
    const auto note_until = [&](std::size_t calls) {
        shares.clear();
        return scene::make_mesh_details(mesh, [&shares, calls](float share) {
            shares.push_back(share);
            return shares.size() < calls;
        });
    };
    const std::size_t levels = note_until(1000).size();
    ASSERT_GT(levels, 4u);
    EXPECT_EQ(shares.front(), 0.0f);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_GT(shares.back(), 0.9f);
    EXPECT_LT(shares.back(), 1.0f);
    EXPECT_EQ(note_until(3).size(), 3u);
}

} // namespace
} // namespace sunfleck::scene

// What GpuScene holds after following changes, against its contract entity by entity and against one from scratch.
#include "tests/support/gpu_world.h"
#include "tests/support/scene_editor.h"

#include <cstring>

namespace sunfleck::tests {
namespace {

class GpuSceneTest : public GpuTest {};

struct Known {
    mat4 matrix{1.0f};
    Bounds bounds;
    std::uint32_t mesh = 0, revision = 0;
};

shared::InstanceRow row_of(const scene::GpuScene& scene, const scene::DrawItem& item) {
    shared::InstanceRow row;
    std::memcpy(&row, scene.rows().data + item.row * sizeof row, sizeof row);
    return row;
}

bool same(const Bounds& a, const Bounds& b) {
    return a.minimum == b.minimum && a.maximum == b.maximum;
}

// Whether each item says where it was in the last update, and whether it moved since.
void check_motion(SceneEditor& editor, const scene::GpuScene& scene, std::map<ecs::Entity, Known>& known) {
    std::map<ecs::Entity, Known> now;
    for (const scene::DrawItem& item : scene.draws()) {
        const Known is{editor.registry.get<scene::WorldTransform>(item.entity).matrix, item.bounds, item.mesh,
                       item.revision};
        now[item.entity] = is;
        const auto found = known.find(item.entity);
        const bool fresh = found == known.end();
        const Known& was = fresh ? is : found->second;
        EXPECT_EQ(item.moved, fresh || was.matrix != is.matrix || was.mesh != is.mesh || was.revision != is.revision);
        EXPECT_TRUE(same(item.previous_bounds, fresh ? Bounds{} : was.bounds));
        EXPECT_EQ(row_of(scene, item).previous_model, was.matrix);
        EXPECT_TRUE(!(item.displacement > 0.0f) || item.moved);
        EXPECT_EQ(scene.find(item.entity), &item);
        known.erase(item.entity);
    }
    EXPECT_EQ(scene.removed_bounds().size(), known.size());
    known = std::move(now);
}

void expect_equal(const scene::GpuScene& a, const scene::GpuScene& b) {
    ASSERT_EQ(a.draws().size(), b.draws().size());
    for (std::size_t i = 0; i < a.draws().size(); ++i) {
        const scene::DrawItem &x = a.draws()[i], &y = b.draws()[i];
        EXPECT_EQ(x.entity, y.entity);
        EXPECT_EQ(x.row, y.row);
        EXPECT_EQ(x.kind, y.kind);
        EXPECT_EQ(std::memcmp(x.textures, y.textures, sizeof x.textures), 0);
        EXPECT_EQ(std::memcmp(&x.constants, &y.constants, sizeof x.constants), 0);
        EXPECT_TRUE(x.is_static == y.is_static && x.casts_shadow == y.casts_shadow && x.closed == y.closed &&
                    x.mirrored == y.mirrored && x.single_sided == y.single_sided && x.scale == y.scale);
        EXPECT_TRUE(same(x.bounds, y.bounds));
        shared::InstanceRow left = row_of(a, x), right = row_of(b, y);
        left.previous_model = right.previous_model;
        EXPECT_EQ(std::memcmp(&left, &right, sizeof left), 0);
    }
    EXPECT_TRUE(same(a.bounds(), b.bounds()));
    EXPECT_TRUE(same(a.static_bounds(), b.static_bounds()));
    EXPECT_EQ(a.has_emission_textures(), b.has_emission_textures());
    EXPECT_EQ(a.materials().size, b.materials().size);
    EXPECT_EQ(std::memcmp(a.materials().data, b.materials().data, a.materials().size), 0);
}

TEST_F(GpuSceneTest, FollowingChangesEqualsStartingFromScratch) {
    SceneEditor editor;
    scene::ChangeTracker tracker;
    gpu::FrameResources resources(device());
    scene::GpuScene followed(device());
    std::map<ecs::Entity, Known> known;
    for (std::uint64_t step = 1; step <= 600 && !HasFailure(); ++step) {
        editor.edit();
        if (step % 3 == 0) // several edits a frame; mistakes with a single one show, too
            editor.edit();
        resources.begin_frame(step, step - 1);
        ASSERT_TRUE(followed.stage_meshes(editor.meshes, resources));
        ASSERT_TRUE(followed.update(tracker.collect(editor.registry, editor.meshes), editor.meshes, resources));
        check_motion(editor, followed, known);
        if (step % 10 == 0) {
            scene::GpuScene fresh(device());
            ASSERT_TRUE(fresh.stage_meshes(editor.meshes, resources));
            ASSERT_TRUE(fresh.update(editor.registry, editor.meshes, resources));
            expect_equal(followed, fresh);
        }
    }
    EXPECT_GT(followed.draws().size(), 20u);
}

// Vertices of a deformed mesh are copied until a frame that does so was recorded.
TEST_F(GpuSceneTest, UnrecordedVerticesAreCopiedAgain) {
    SceneEditor editor;
    scene::ChangeTracker tracker;
    gpu::FrameResources resources(device());
    scene::GpuScene scene(device());
    const auto submission = gpu::Submission::create(device(), 2).value();
    std::uint64_t serial = 0;
    // Whether this frame copies vertices.
    const auto frame = [&](bool recorded) {
        resources.begin_frame(++serial, 0);
        EXPECT_TRUE(scene.stage_meshes(editor.meshes, resources));
        EXPECT_TRUE(scene.update(tracker.collect(editor.registry, editor.meshes), editor.meshes, resources));
        gpu::FrameGraph graph(&device());
        scene.add_passes(graph);
        EXPECT_TRUE(graph.compile());
        const auto& passes = graph.compiled();
        const bool copies = std::any_of(passes.begin(), passes.end(),
                                        [](const gpu::CompiledPass& pass) { return pass.name == "deformed vertices"; });
        const auto record = [&](VkCommandBuffer commands) { return graph.execute(commands, resources, nullptr); };
        EXPECT_TRUE(recorded ? submission->immediate(record) : Status());
        return copies;
    };
    EXPECT_FALSE(frame(true)) << "all meshes are uploaded as they are";
    editor.meshes.replace(0, triangle(2.0f));
    EXPECT_TRUE(frame(false));
    EXPECT_TRUE(frame(false));
    EXPECT_TRUE(frame(true));
    EXPECT_FALSE(frame(true));
}

} // namespace
} // namespace sunfleck::tests

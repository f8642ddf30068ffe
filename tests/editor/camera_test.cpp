// The viewport's camera: whatever the wheel does, it looks somewhere.
#include "editor/window/camera.h"

#include <gtest/gtest.h>

namespace sunfleck::editor {
namespace {

bool is_sound(const Camera& camera) {
    const vec3 offset = camera.view().target - camera.view().position;
    return std::isfinite(glm::length(offset)) && glm::length(offset) > 0.0f &&
           std::isfinite(glm::length(camera.view().position));
}

// Past what it looked at, a notch at a time, about as fast at the end as when it came close; and back.
TEST(EditorCamera, TheWheelNeverStalls) {
    for (const float size : {0.01f, 5.0f, 3000.0f}) {
        SCOPED_TRACE(size);
        Camera camera;
        scene::CameraView view;
        view.position = vec3(0.2f, 0.1f, 1.0f) * size;
        view.target = vec3(0.0f);
        camera.set(view);
        const vec3 way = glm::normalize(view.target - view.position);
        for (int notch = 0; notch < 400; ++notch) {
            const vec3 before = camera.view().position;
            camera.dolly(1.0f, size);
            ASSERT_TRUE(is_sound(camera)) << notch;
            ASSERT_GT(glm::dot(camera.view().position - before, way), 1e-3f * size) << notch;
            ASSERT_NEAR(glm::length(glm::normalize(camera.view().target - camera.view().position) - way), 0.0f, 1e-3f);
        }
        EXPECT_GT(glm::dot(camera.view().position - view.target, way), 0.0f) << "it has passed its target";
        for (int notch = 0; notch < 2000; ++notch) {
            camera.dolly(-1.0f, size);
            ASSERT_TRUE(is_sound(camera)) << notch;
        }
    }
}

TEST(EditorCamera, NoticesNothingOfATargetWhereItStands) {
    app::InputState input;
    input.keys['W'] = input.keys['D'] = true;
    for (const vec3 target : {vec3(0.0f), vec3(0.0f, 1.0f, 0.0f)}) { // nowhere; along `up`
        scene::CameraView view;
        view.target = target;
        const auto after = [&](const auto& what) {
            Camera camera;
            camera.set(view);
            what(camera);
            return is_sound(camera);
        };
        EXPECT_TRUE(after([](Camera& camera) { camera.dolly(3.0f, 5.0f); }));
        EXPECT_TRUE(after([](Camera& camera) { camera.orbit(vec2(9.0f, 4.0f)); }));
        EXPECT_TRUE(after([](Camera& camera) { camera.look(vec2(9.0f, 4.0f)); }));
        EXPECT_TRUE(after([](Camera& camera) { camera.frame({vec3(-1.0f), vec3(2.0f)}); }));
        Camera camera;
        camera.set(view);
        EXPECT_TRUE(camera.fly(input, 0.1, 5.0f));
        EXPECT_TRUE(std::isfinite(glm::length(camera.view().position)));
        EXPECT_GT(glm::length(camera.view().position), 0.0f);
    }
}

} // namespace
} // namespace sunfleck::editor

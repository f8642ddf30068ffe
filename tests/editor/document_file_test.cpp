// What the editor's document writes is read again as it was, where glTF alone would have it otherwise.
#include "editor/document/edits.h"
#include "tests/support/folder.h"
#include "viewer/exposure.h"

#include <gtest/gtest.h>

namespace sunfleck::editor {
namespace {

class EditorFile : public testing::Test {
protected:
    static Entity add(Document& document, std::string_view name) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == name)
                return add_from(document, source, vec3(0.0f), 1.0f);
        ADD_FAILURE() << "no template " << name;
        return {};
    }
    const tests::Folder folder_{"editor_file"};
};

// What a node of glTF has in any case.
TEST_F(EditorFile, WhatAnEntityLacksItLacksInTheFileToo) {
    Document document;
    for (const char* name : {"Box", "Cylinder", "Ball"})
        add(document, name);
    const auto take = [&](const char* name, ecs::PoolBase& pool) {
        document.begin("Take away");
        document.set(document.find(name), pool, nullptr);
        document.commit();
    };
    take("box", pool_of<scene::Transform>(document));
    take("cylinder", pool_of<scene::Material>(document));
    take("ball", pool_of<scene::MeshInstance>(document));
    document.begin("Paint");
    scene::Material red;
    red.base_colour = vec3(0.5f, 0.25f, 0.125f);
    document.set(document.find("ball"), pool_of<scene::Material>(document), std::make_shared<scene::Material>(red));
    document.commit();
    ASSERT_TRUE(document.save(folder_ / "a.scene.json"));
    const auto opened = Document::open(folder_ / "a.scene.json");
    ASSERT_TRUE(opened) << opened.error().message;
    for (const char* name : {"box", "cylinder", "ball"}) {
        SCOPED_TRACE(name);
        const Entity was = document.find(name), is = (*opened)->find(name);
        ASSERT_TRUE((*opened)->exists(is));
        const ecs::Registry &before = document.registry(), &after = (*opened)->registry();
        EXPECT_EQ(after.has<scene::Transform>(is), before.has<scene::Transform>(was));
        EXPECT_EQ(after.has<scene::Material>(is), before.has<scene::Material>(was));
        EXPECT_EQ(after.has<scene::MeshInstance>(is), before.has<scene::MeshInstance>(was));
    }
    EXPECT_EQ((*opened)->registry().get<scene::Material>((*opened)->find("ball")).base_colour, red.base_colour);
}

TEST_F(EditorFile, AnEntityWithSeveralLightsKeepsThem) {
    Document document;
    const Entity lamp = add(document, "Point light");
    document.begin("Add lights");
    document.set(lamp, pool_of<scene::SpotLight>(document), std::make_shared<scene::SpotLight>());
    document.set(lamp, pool_of<scene::DirectionalLight>(document), std::make_shared<scene::DirectionalLight>());
    document.commit();
    ASSERT_TRUE(document.save(folder_ / "a.scene.json"));
    const auto opened = Document::open(folder_ / "a.scene.json");
    ASSERT_TRUE(opened) << opened.error().message;
    const Entity found = (*opened)->find("point light");
    const ecs::Registry& registry = (*opened)->registry();
    ASSERT_TRUE(registry.has<scene::PointLight>(found) && registry.has<scene::SpotLight>(found) &&
                registry.has<scene::DirectionalLight>(found));
    EXPECT_EQ(registry.get<scene::PointLight>(found).intensity,
              document.registry().get<scene::PointLight>(lamp).intensity);
}

// Whoever takes the last lamp away gets darkness, and no sky and sun when the scene is opened again.
TEST_F(EditorFile, WithoutLampsItStaysDark) {
    Document document;
    const Entity lamp = add(document, "Point light");
    add(document, "Box");
    for (const bool lit : {true, false}) {
        ASSERT_TRUE(document.save(folder_ / "a.scene.json"));
        const auto opened = Document::open(folder_ / "a.scene.json");
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_EQ((*opened)->entity_count(), lit ? 2u : 1u);
        remove(document, {lamp});
    }
}

// Their order in the registry is another once the scene was opened.
TEST_F(EditorFile, OfSeveralExposuresOneCountsInTheFileToo) {
    Document document;
    const Entity b = add(document, "Box"), a = add(document, "Ball"); // the order of names is the other way about
    ASSERT_TRUE(rename(document, b, "b"));
    ASSERT_TRUE(rename(document, a, "a"));
    document.begin("Expose");
    for (const auto& [entity, ev100] : {std::pair(b, 3.0f), std::pair(a, 9.0f)})
        document.set(entity, pool_of<scene::Exposure>(document),
                     std::make_shared<scene::Exposure>(scene::Exposure{ev100}));
    document.commit();
    ASSERT_TRUE(document.save(folder_ / "a.scene.json"));
    const auto opened = Document::open(folder_ / "a.scene.json");
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(viewer::scene_exposure(document.registry()), 3.0f);
    EXPECT_EQ(viewer::scene_exposure((*opened)->registry()), 3.0f);
}

} // namespace
} // namespace sunfleck::editor

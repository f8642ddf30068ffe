// Edits of components of several entities at once, and what hidden ones are told of.
#include "editor/document/edits.h"
#include "editor/window/scene_copy.h"

#include <gtest/gtest.h>

namespace sunfleck::editor {
namespace {

class EditorComponents : public testing::Test {
protected:
    EditorComponents() {
        for (const char* name : {"Box", "Ball", "Point light"})
            for (const scene::EntityTemplate& source : scene::entity_templates())
                if (source.name == name)
                    all_.push_back(add_from(*document_, source, vec3(1.0f, 2.0f, 3.0f), 1.0f));
        EXPECT_EQ(all_.size(), 3u);
    }
    template <typename T>
    const T& get(Entity entity) const {
        return document_->registry().get<T>(entity);
    }
    bool has(Entity entity, const ecs::PoolBase& pool) const { return pool.contains(entity); }
    std::size_t entries() const { return document_->history().position(); }
    const Field& field(const ecs::PoolBase& pool, std::string_view name) const {
        return *pool.description()->find(name);
    }

    const std::shared_ptr<Document> document_ = std::make_shared<Document>();
    Entities all_; // a box, a ball and a lamp
    ecs::PoolBase& materials_ = pool_of<scene::Material>(*document_);
    ecs::PoolBase& lamps_ = pool_of<scene::PointLight>(*document_);
};

TEST_F(EditorComponents, AreAddedOnlyWhereTheyAreNot) {
    ASSERT_TRUE(edit_field(*document_, {all_[0]}, materials_, field(materials_, "roughness"), "0.25"));
    const std::size_t before = entries();
    ASSERT_FALSE(has(all_[2], materials_));
    add_component(*document_, all_, materials_);
    EXPECT_EQ(entries(), before + 1) << "one entry for all";
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.25f) << "what is there stays";
    EXPECT_EQ(get<scene::Material>(all_[2]).roughness, scene::Material().roughness);
    remove_component(*document_, all_, lamps_);
    EXPECT_EQ(entries(), before + 2);
    EXPECT_FALSE(has(all_[2], lamps_));
    remove_component(*document_, all_, lamps_);
    EXPECT_EQ(entries(), before + 2) << "nobody has it: nothing changes";
    document_->undo();
    document_->undo();
    EXPECT_TRUE(has(all_[2], lamps_));
    EXPECT_FALSE(has(all_[2], materials_));
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.25f);
}

TEST_F(EditorComponents, ArePastedOverOthersAndWhereThereIsNone) {
    ASSERT_TRUE(edit_field(*document_, {all_[0]}, materials_, field(materials_, "roughness"), "0.25"));
    const ecs::Value copied = document_->registry().value(materials_, all_[0]);
    // What is copied later changes nothing of it.
    ASSERT_TRUE(edit_field(*document_, {all_[0]}, materials_, field(materials_, "roughness"), "0.75"));
    const float other = get<scene::Material>(all_[1]).roughness;
    ASSERT_NE(other, 0.25f);
    const std::size_t before = entries();
    paste_component(*document_, {all_[1], all_[2]}, materials_, copied);
    EXPECT_EQ(entries(), before + 1);
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.75f);
    EXPECT_EQ(get<scene::Material>(all_[1]).roughness, 0.25f);
    EXPECT_EQ(get<scene::Material>(all_[2]).roughness, 0.25f);
    document_->undo();
    EXPECT_EQ(get<scene::Material>(all_[1]).roughness, other);
    EXPECT_FALSE(has(all_[2], materials_));
}

// Of all that have it; where one does not take it, none does.
TEST_F(EditorComponents, AFieldIsSetOfAllOrOfNone) {
    const Field& roughness = field(materials_, "roughness");
    ASSERT_TRUE(edit_field(*document_, {all_[0]}, materials_, roughness, "0.25"));
    const std::size_t before = entries();
    const float other = get<scene::Material>(all_[1]).roughness;
    EXPECT_FALSE(edit_field(*document_, all_, materials_, roughness, "7"));
    EXPECT_FALSE(edit_field(*document_, all_, materials_, roughness, "nan"));
    EXPECT_EQ(entries(), before);
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.25f);
    EXPECT_EQ(get<scene::Material>(all_[1]).roughness, other);
    ASSERT_TRUE(edit_field(*document_, all_, materials_, roughness, "0.625"));
    EXPECT_EQ(entries(), before + 1);
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.625f);
    EXPECT_EQ(get<scene::Material>(all_[1]).roughness, 0.625f);
    EXPECT_FALSE(has(all_[2], materials_));
    document_->undo();
    EXPECT_EQ(get<scene::Material>(all_[0]).roughness, 0.25f);
    EXPECT_EQ(get<scene::Material>(all_[1]).roughness, other);
}

// A copy that shows the scene, as the window tells it after each frame.
class EditorHidden : public EditorComponents {
protected:
    void tell() {
        std::optional<SceneChange> change = collector_.collect(document_);
        filter_.apply(document_, hidden_, {}, change);
        if (change)
            copy_->apply(*change);
    }
    // The same as the document has: shown; only where it is: hidden.
    void expect_shown(Entity entity, bool shown) {
        for (const ecs::PoolBase* pool : document_->registry().all_pools()) {
            if (pool->is_derived() || !pool->is_copyable() || !pool->contains(entity))
                continue;
            const ecs::PoolBase& there = copy_->registry.counterpart(*pool);
            const std::string_view name = pool->description() == nullptr ? "" : pool->description()->name;
            const bool place = name == "Name" || name == "Parent" || name == "Transform";
            EXPECT_EQ(there.contains(entity), shown || place) << document_->name(entity) << " " << name;
            if (there.contains(entity) && pool->description() != nullptr) {
                EXPECT_TRUE(
                    same_value(*pool, document_->registry().value(*pool, entity), copy_->registry.value(there, entity)))
                    << document_->name(entity) << " " << name;
            }
        }
    }

    ChangeCollector collector_;
    HiddenFilter filter_;
    std::unordered_set<Entity> hidden_;
    std::unique_ptr<PlainCopy> copy_ = std::make_unique<PlainCopy>();
};

TEST_F(EditorHidden, IsToldWhereItIsAndNothingElse) {
    tell();
    for (const Entity entity : all_)
        expect_shown(entity, true);
    hidden_ = {all_[0], all_[2]};
    tell();
    expect_shown(all_[0], false);
    expect_shown(all_[1], true);
    expect_shown(all_[2], false);

    // Edits of what is hidden, of its place, too, and of what is not.
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document_);
    ASSERT_TRUE(edit_field(*document_, {all_[0], all_[1]}, materials_, field(materials_, "roughness"), "0.25"));
    ASSERT_TRUE(edit_field(*document_, {all_[2]}, transforms, field(transforms, "position"), "4,5,6"));
    tell();
    expect_shown(all_[0], false);
    expect_shown(all_[1], true);
    expect_shown(all_[2], false);
    document_->undo();
    tell();
    expect_shown(all_[2], false);

    // Shown again, it is as it was edited meanwhile.
    hidden_ = {all_[2]};
    tell();
    expect_shown(all_[0], true);
    EXPECT_EQ(copy_->registry.get<scene::Material>(all_[0]).roughness, 0.25f);
    expect_shown(all_[2], false);

    // What begins anew knows, too; and what is gone hides nothing.
    SceneChange everything = ChangeCollector::everything(document_);
    HiddenFilter::hide(hidden_, {}, everything);
    copy_ = std::make_unique<PlainCopy>();
    copy_->apply(everything);
    expect_shown(all_[0], true);
    expect_shown(all_[2], false);
    remove(*document_, {all_[2]});
    tell();
    EXPECT_FALSE(copy_->registry.alive(all_[2]) && copy_->registry.has<scene::Name>(all_[2]));
    document_->undo();
    tell();
    expect_shown(all_[2], false);
    hidden_.clear();
    tell();
    expect_shown(all_[2], true);
}

} // namespace
} // namespace sunfleck::editor

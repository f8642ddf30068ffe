// The editor's document: identities, gestures, history, names, files.
#include "tests/editor/random_edits.h"

#include "engine/core/file.h"
#include "engine/scene/summer_sky.h"
#include "tests/support/folder.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>
#include <malloc.h>

namespace sunfleck::editor {
namespace {

namespace fs = std::filesystem;

// A folder of the test's own, which goes with it.
class EditorDocument : public testing::Test {
protected:
    // The bytes of all that a save writes.
    std::string saved(Document& document) {
        const fs::path place = folder_ / "saved";
        fs::remove_all(place);
        fs::create_directories(place);
        const Status status = document.save(place / "a.scene.json");
        EXPECT_TRUE(status) << (status ? "" : status.error().message);
        std::string bytes;
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(place))
            files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        for (const fs::path& file : files)
            bytes += file.filename().string() + "\n" + read_file(file).value();
        return bytes;
    }
    static Entity add(Document& document, std::string_view name, vec3 position = vec3(0.0f)) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == name)
                return add_from(document, source, position, 1.0f);
        ADD_FAILURE() << "no template " << name;
        return {};
    }
    static void fill(Document& document) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(document, source, vec3(1.0f, 2.0f, 3.0f), 0.5f);
    }
    const tests::Folder folder_{"editor_document"};
};

TEST_F(EditorDocument, HandlesOutliveDeletion) {
    Document document;
    const Entity box = add(document, "Box");
    const Entity lamp = add(document, "Point light", {0, 1, 0});
    ASSERT_TRUE(reparent(document, {lamp}, box));
    remove(document, {box});
    EXPECT_FALSE(document.exists(box));
    EXPECT_FALSE(document.exists(lamp)); // what is below goes along
    add(document, "Ball");
    document.undo();
    document.undo();
    ASSERT_TRUE(document.exists(box));
    EXPECT_EQ(document.parent(lamp), box);
    EXPECT_EQ(document.registry().get<scene::PointLight>(lamp).intensity, vec3(40.0f));
    EXPECT_EQ(document.selection(), std::vector<Entity>{lamp});
}

TEST_F(EditorDocument, ADragIsOneEntryAndAGestureThatIsGivenUpNone) {
    Document document;
    const Entity box = add(document, "Box");
    const std::size_t before = document.history().entries().size();
    ecs::PoolBase& pool = pool_of<scene::Transform>(document);
    const Field& position = *pool.description()->find("position");
    document.begin("Move box");
    for (int i = 1; i <= 50; ++i)
        ASSERT_TRUE(set_field(document, {box}, pool, position, std::to_string(i) + ",0,0"));
    EXPECT_TRUE(document.commit());
    EXPECT_EQ(document.history().entries().size(), before + 1);
    EXPECT_EQ(document.history().entries().back().components.size(), 1u);
    document.undo();
    EXPECT_EQ(document.registry().get<scene::Transform>(box).position, vec3(0.0f));
    document.redo();
    EXPECT_EQ(document.registry().get<scene::Transform>(box).position, vec3(50, 0, 0));

    document.begin("Move box");
    ASSERT_TRUE(set_field(document, {box}, pool, position, "7,7,7"));
    document.cancel();
    EXPECT_EQ(document.registry().get<scene::Transform>(box).position, vec3(50, 0, 0));
    document.begin("Move box"); // there and back
    ASSERT_TRUE(set_field(document, {box}, pool, position, "7,7,7"));
    ASSERT_TRUE(set_field(document, {box}, pool, position, "50,0,0"));
    EXPECT_FALSE(document.commit());
    document.begin("Move box");
    ASSERT_TRUE(set_field(document, {box}, pool, position, "7,7,7"));
    document.undo(); // gives up the gesture, and undoes the entry before it
    EXPECT_EQ(document.registry().get<scene::Transform>(box).position, vec3(0.0f));
    EXPECT_EQ(document.history().entries().size(), before + 1);
}

// What costs are measured against.
TEST_F(EditorDocument, HistoryKnowsWhatSettingsWereBefore) {
    Document document;
    const auto set = [&](const char* value) {
        document.begin("Set lights");
        ASSERT_TRUE(document.set_setting("lights", value));
        document.commit();
    };
    const std::string usual = document.settings().get("lights");
    EXPECT_TRUE(document.history().old_settings().empty());
    set("500");
    set("600");
    EXPECT_EQ(document.history().old_settings(), (std::map<std::string, std::string>{{"lights", "500"}}));
    document.undo();
    EXPECT_EQ(document.history().old_settings().at("lights"), usual);
    document.undo();
    EXPECT_TRUE(document.history().old_settings().empty());
    document.redo();
    EXPECT_EQ(document.history().old_settings().at("lights"), usual);
}

TEST_F(EditorDocument, NamesAreDistinctAndClean) {
    Document document;
    const Entity a = add(document, "Box"), b = add(document, "Box"), c = add(document, "Box");
    EXPECT_EQ(document.name(a), "box");
    EXPECT_EQ(document.name(b), "box 2");
    EXPECT_EQ(document.name(c), "box 3");
    ASSERT_TRUE(rename(document, b, "box"));
    EXPECT_EQ(document.name(b), "box 2"); // its own old name is free again
    ASSERT_TRUE(rename(document, b, "a\nb\t\"c\""));
    EXPECT_EQ(document.name(b), "a b \"c\"");
    EXPECT_FALSE(rename(document, b, " \n"));
    ASSERT_TRUE(rename(document, c, std::string(10000, 'x')));
    EXPECT_EQ(document.name(c), std::string(120, 'x'));
    EXPECT_EQ(document.find("box"), a);
    EXPECT_TRUE(document.find("box 2").is_null());
    document.undo();
    document.undo();
    EXPECT_EQ(document.find("box 2"), b);
}

TEST_F(EditorDocument, PlacesInTheWorldStayWhenTheTreeChanges) {
    Document document;
    const Entity box = add(document, "Box", {1, 2, 3}), lamp = add(document, "Spot light", {-4, 5, 6});
    ecs::PoolBase& pool = pool_of<scene::Transform>(document);
    ASSERT_TRUE(edit_field(document, {box}, pool, *pool.description()->find("rotation"), "0.5,0.5,0.5,0.5"));
    ASSERT_TRUE(edit_field(document, {box}, pool, *pool.description()->find("scale"), "2,2,2"));
    const mat4 before = world_of(document, lamp);
    const auto expect_there = [&] {
        const mat4 now = world_of(document, lamp);
        for (int i = 0; i < 4; ++i)
            EXPECT_LT(glm::length(now[i] - before[i]), 1e-5f) << i; // some roundings of numbers below 10
    };
    ASSERT_TRUE(reparent(document, {lamp}, box));
    expect_there();
    EXPECT_FALSE(reparent(document, {box}, lamp)) << "a cycle";
    const Entity both = group(document, {lamp});
    expect_there();
    EXPECT_EQ(document.parent(both), box);
    ASSERT_TRUE(reparent(document, {lamp}, ecs::null_entity));
    expect_there();
}

TEST_F(EditorDocument, WhatOneSeesOfALampFollowsItsLight) {
    Document document;
    const Entity lamp = add(document, "Rectangle light");
    ecs::PoolBase& pool = pool_of<scene::AreaLight>(document);
    ASSERT_TRUE(edit_field(document, {lamp}, pool, *pool.description()->find("radiance"), "1,2,3"));
    EXPECT_EQ(document.registry().get<scene::Material>(lamp).emission, vec3(1, 2, 3));
    ASSERT_TRUE(edit_field(document, {lamp}, pool, *pool.description()->find("width"), "4"));
    const auto extent = [&] {
        return document.meshes().bounds(document.registry().get<scene::MeshInstance>(lamp).mesh).extent();
    };
    EXPECT_EQ(extent().x, 4.0f);
    document.undo();
    EXPECT_EQ(extent().x, 1.0f);
}

TEST_F(EditorDocument, SaveRefusesToReplaceForeignGeometryAndReopensTheSame) {
    Document document;
    fill(document);
    ASSERT_TRUE(edit_setting(document, gi::Settings::names()[0], document.settings().get(gi::Settings::names()[0])));
    ASSERT_TRUE(write_file(folder_ / "fox.glb", "somebody's work"));
    EXPECT_TRUE(document.unsaved());
    EXPECT_FALSE(document.save(folder_ / "fox.scene.json"));
    EXPECT_EQ(read_file(folder_ / "fox.glb").value(), "somebody's work");
    EXPECT_TRUE(document.unsaved());
    EXPECT_FALSE(document.save(folder_ / "fox.txt"));
    ASSERT_TRUE(document.save(folder_ / "mine.scene.json"));
    EXPECT_FALSE(document.unsaved());
    const std::string bytes = saved(document);
    auto again = Document::open(folder_ / "mine.scene.json");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ((*again)->entity_count(), document.entity_count());
    EXPECT_EQ(saved(**again), bytes);
}

// A copy of the document that hears of changes only through updates holds the same values.
void expect_same(Document& document, ecs::Registry& copy) {
    for (const ecs::PoolBase* pool : document.registry().described_pools()) {
        const ecs::PoolBase& other = copy.counterpart(*pool);
        ASSERT_EQ(pool->size(), other.size()) << pool->description()->name;
        for (const Entity entity : pool->entities())
            ASSERT_TRUE(same_value(*pool, document.registry().value(*pool, entity), copy.value(other, entity)))
                << pool->description()->name;
    }
}

void send(const std::vector<Update>& updates, ecs::Registry& copy) {
    for (const Update& update : updates) {
        if (!copy.alive(update.entity))
            copy.create_as(update.entity);
        copy.set_value(copy.counterpart(*update.pool), update.entity, update.value.get());
    }
}

TEST_F(EditorDocument, WhatAnotherProgramWroteIsNotReplacedUnasked) {
    Document first;
    add(first, "Box");
    const fs::path file = folder_ / "shared.scene.json";
    ASSERT_TRUE(first.save(file));
    auto opened = Document::open(file);
    ASSERT_TRUE(opened);
    Document& document = **opened;
    EXPECT_FALSE(document.file_changed());
    add(first, "Ball");
    ASSERT_TRUE(first.save(file));
    EXPECT_FALSE(first.file_changed());
    EXPECT_TRUE(document.file_changed());
    add(document, "Point light");
    const std::string theirs = read_file(file).value();
    const Status refused = document.save(file);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("changed by another program"), std::string::npos) << refused.error().message;
    EXPECT_EQ(read_file(file).value(), theirs);
    EXPECT_TRUE(document.unsaved());
    EXPECT_TRUE(document.save(file)) << "asked for twice";
    EXPECT_NE(read_file(file).value(), theirs);
    fs::remove(file);
    fs::remove(folder_ / "shared.glb");
    EXPECT_FALSE(document.file_changed()) << "what is gone can't be lost";
    add(document, "Box");
    EXPECT_TRUE(document.save(file));
}

TEST_F(EditorDocument, ACopyFollowsByUpdatesUnderTheSameHandles) {
    Document document;
    fill(document);
    ecs::Registry copy;
    copy.reserve_handles(document.handle_count() + 4096);
    send(document.all_updates(), copy);
    const Entity foreign = copy.create(); // as a renderer's light samples
    EXPECT_GE(foreign.index, document.handle_count() + 4096);
    tests::RandomEdits edits(document, 7);
    for (int i = 0; i < 300; ++i) {
        edits.once();
        if (edits.below(4) == 0)
            document.undo();
        if (i % 10 == 0) {
            send(document.take_updates(), copy);
            ASSERT_NO_FATAL_FAILURE(expect_same(document, copy)) << "edit " << i;
        }
    }
    EXPECT_FALSE(document.exists(foreign));
}

// Undoing everything gives the first file's bytes, redoing everything the last one's, and so does any place between.
// The short size has fewer edits of the same kinds.
TEST_F(EditorDocument, UndoAndRedoRestoreEveryByte) {
    const int edits_wanted = tests::by_size(400, 10000), places = tests::by_size(8, 100);
    for (const std::uint32_t seed : {1u, 2u}) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Document document;
        fill(document);
        const std::size_t start = document.history().position();
        const std::string first = saved(document);
        tests::RandomEdits edits(document, seed);
        std::map<std::size_t, std::string> bytes; // by position in the history
        std::map<std::string, int> kinds;
        for (int i = 0; i < edits_wanted; ++i) {
            ++kinds[edits.once()];
            if (i % (edits_wanted / places) == 0)
                bytes[document.history().position()] = saved(document);
        }
        for (const char* kind : {"add", "duplicate", "delete", "reparent", "rename", "group", "components", "setting",
                                 "field", "cancelled"})
            EXPECT_GT(kinds[kind], 0) << kind;
        const std::string last = saved(document);
        const auto check = [&] {
            const auto known = bytes.find(document.history().position());
            if (known != bytes.end()) {
                EXPECT_TRUE(saved(document) == known->second) << "at " << known->first;
            }
        };
        while (document.history().position() > start) {
            document.undo();
            check();
        }
        EXPECT_TRUE(saved(document) == first);
        while (document.redo())
            check();
        EXPECT_TRUE(saved(document) == last);
        EXPECT_LT(document.history().overhead(), document.history().entries().size() * 2048);
    }
}

// However much is selected.
TEST_F(EditorDocument, EntriesShareASelectionThatStays) {
    Document document;
    std::vector<Entity> all;
    document.begin("Add");
    for (int i = 0; i < 10'000; ++i) {
        auto named = std::make_shared<scene::Name>();
        named->name = "entity " + std::to_string(i);
        all.push_back(document.create());
        document.set(all.back(), pool_of<scene::Name>(document), std::move(named));
    }
    document.commit();
    const std::size_t before = document.history().overhead();
    document.select(all);
    ASSERT_EQ(document.selection().size(), all.size());
    constexpr std::size_t edits = 100;
    for (std::size_t i = 0; i < edits; ++i) {
        document.begin("Set");
        ASSERT_TRUE(document.set_setting("lights", std::to_string(100 + i)));
        ASSERT_TRUE(document.commit());
    }
    EXPECT_LT(document.history().overhead() - before, edits * 2048 + all.size() * sizeof(Entity));
    document.select({});
    ASSERT_TRUE(document.undo());
    EXPECT_EQ(document.selection(), all);
}

std::int64_t heap_in_use() {
    const struct mallinfo2 heap = mallinfo2();
    return std::int64_t(heap.uordblks + heap.hblkhd);
}

// What the values take that entries keep of components that came or went: of what was deleted, or is again once its
// making is undone. Long names count as short ones.
std::int64_t bytes_of_deleted(Document& document) {
    std::map<const ecs::PoolBase*, std::int64_t> bytes; // of a value
    for (const ecs::PoolBase* pool : document.registry().described_pools()) {
        std::vector<ecs::Value> values(100);
        const std::int64_t before = heap_in_use();
        for (ecs::Value& value : values)
            value = pool->default_value();
        bytes[pool] = (heap_in_use() - before) / std::int64_t(values.size());
    }
    std::int64_t result = 0;
    for (const HistoryEntry& entry : document.history().entries())
        for (const ComponentChange& change : entry.components)
            if (change.before == nullptr || change.after == nullptr)
                result += bytes[change.pool] + std::int64_t(sizeof change);
    return result;
}

// All that edits leave behind once they are undone: entries with their values, handles, meshes of lamps.
TEST_F(EditorDocument, AnEditTakesTwoKilobytesAtMost) {
    constexpr int edits_wanted = 10000;
    const auto sky = scene::summer_sky(); // which edits name, and which is there but once
    for (const std::uint32_t seed : {3u, 4u}) {
        Document document;
        fill(document);
        document.take_updates();
        const std::size_t start = document.history().position();
        const std::int64_t before = heap_in_use();
        tests::RandomEdits edits(document, seed);
        for (int i = 0; i < edits_wanted; ++i)
            edits.once();
        while (document.history().position() > start)
            document.undo();
        document.take_updates();
        const auto entries = std::int64_t(document.history().entries().size() - start);
        const std::int64_t left = heap_in_use() - before - bytes_of_deleted(document);
        std::printf("seed %u: %lld edits, %.0f B each\n", seed, static_cast<long long>(entries),
                    double(left) / double(entries));
        EXPECT_GT(entries, edits_wanted / 2);
        EXPECT_LE(left, 2048 * entries);
    }
}

} // namespace
} // namespace sunfleck::editor

// A document whose edits are kept for a crash.
#pragma once

#include "editor/window/recovery.h"
#include "engine/core/file.h"
#include "test_places.h"
#include "tests/editor/random_edits.h"
#include "tests/support/folder.h"

#include <csignal>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace sunfleck::editor {

namespace fs = std::filesystem;

class EditorJournal : public testing::Test {
protected:
    EditorJournal() {
        Document document;
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(document, source, vec3(1.0f, 2.0f, 3.0f), 0.5f);
        EXPECT_TRUE(document.save(folder_ / "room.scene.json"));
    }
    std::shared_ptr<Document> open() {
        auto opened = Document::open(folder_ / "room.scene.json");
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
        return opened ? std::shared_ptr<Document>(std::move(*opened)) : nullptr;
    }
    std::string saved(Document& document) {
        const fs::path place = folder_ / "saved";
        fs::remove_all(place);
        fs::create_directories(place);
        EXPECT_TRUE(document.save(place / "a.scene.json"));
        return read_file(place / "a.scene.json").value() + read_file(place / "a.glb").value();
    }
    // What the document has, whatever its handles: every described value by name.
    static std::string content(Document& document) {
        std::map<std::string, std::string> all;
        for (const Entity root : document.roots())
            for (const Entity entity : document.family(root)) {
                std::string& text = all[document.name(entity)];
                const Entity above = document.parent(entity);
                text = "below " + (above.is_null() ? std::string("nothing") : document.name(above)) + "\n";
                for (const ecs::PoolBase* pool : document.registry().described_pools()) {
                    if (!pool->contains(entity) || pool->is_derived())
                        continue;
                    text += std::string(pool->description()->name) + ":";
                    const void* value = pool->address(pool->position_of(entity.index));
                    for (const Field& field : pool->description()->fields)
                        if (field.kind != FieldKind::entity && pool->description()->name != "MeshInstance")
                            text += " " + field_to_text(field, value);
                    if (pool->description()->name == "MeshInstance")
                        text += std::to_string(
                            document.meshes()[static_cast<const scene::MeshInstance*>(value)->mesh].positions.size());
                    text += "\n";
                }
            }
        std::string result;
        for (const auto& [name, text] : all)
            result.append(name).append("\n").append(text);
        for (const std::string_view name : gi::Settings::names())
            result.append(name).append(" ").append(document.settings().get(name)).append("\n");
        return result;
    }

    // What a file of it has: in glTF every entity has a place, what has geometry has a material, and a material without
    // geometry is nobody's.
    std::string content_of_save(Document& document) {
        const fs::path place = folder_ / "copy";
        fs::remove_all(place);
        fs::create_directories(place);
        EXPECT_TRUE(document.save(place / "room.scene.json"));
        auto opened = Document::open(place / "room.scene.json");
        EXPECT_TRUE(opened);
        return opened ? content(**opened) : std::string();
    }
    static std::string first_difference(const std::string& a, const std::string& b) {
        std::istringstream lines_a(a), lines_b(b);
        std::string line_a, line_b, above;
        while (std::getline(lines_a, line_a) && std::getline(lines_b, line_b) && line_a == line_b)
            above = line_a;
        return "after '" + above + "' '" + line_a + "' is not '" + line_b + "'";
    }

    // One edit, as the program makes and keeps it. `saves`: now and then the document is saved.
    static void edit(const std::shared_ptr<Document>& document, tests::RandomEdits& edits, ChangeCollector& collector,
                     Recovery* recovery) {
        edits.once();
        if (recovery == nullptr)
            return;
        if (const auto change = collector.collect(document))
            recovery->change(*change);
        const std::size_t position = document->history().position();
        if (!document->unsaved())
            return recovery->saved(document->path().string());
        const std::string name = position > 0 ? document->history().entries()[position - 1].name : "";
        recovery->unsaved(document->path().string(), {name}, std::max<std::size_t>(position, 1));
    }

    // In a process of its own, which is killed after so many edits. `pause`: microseconds between them.
    void edit_and_die(std::uint32_t seed, int count, int pause) {
        const pid_t child = ::fork();
        if (child != 0) {
            int status = 0;
            ::waitpid(child, &status, 0);
            ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << "seed " << seed;
            return;
        }
        ::alarm(60); // whatever goes wrong, the test ends
        const std::shared_ptr<Document> document = open();
        ChangeCollector collector;
        Recovery recovery(folder_ / "recovery");
        recovery.change(*collector.collect(document));
        recovery.saved(document->path().string());
        while (!fs::exists(own_folder() / "base.json"))
            ::usleep(200);
        tests::RandomEdits edits(*document, seed);
        for (int i = 0; i < count; ++i) {
            edit(document, edits, collector, &recovery);
            ::usleep(useconds_t(pause));
        }
        ::kill(::getpid(), SIGKILL);
    }
    // The same, killed by another process after so many microseconds of edits. How many edits were made and kept.
    // `saves`: the document is saved after each.
    int edit_until_killed(std::uint32_t seed, bool saves, useconds_t after) {
        int ends[2];
        EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            ::alarm(60);
            const std::shared_ptr<Document> document = open();
            ChangeCollector collector;
            Recovery recovery(folder_ / "recovery");
            recovery.change(*collector.collect(document));
            recovery.saved(document->path().string());
            while (!fs::exists(own_folder() / "base.json"))
                ::usleep(200);
            tests::RandomEdits edits(*document, seed);
            const auto tell = [&](char letter) { return ::write(ends[1], &letter, 1) == 1; };
            for (int i = 0; i < 1000 && tell(i == 0 ? 'b' : 'e'); ++i) {
                edit(document, edits, collector, &recovery);
                if (saves && document->unsaved() && document->save(document->path()))
                    recovery.saved(document->path().string());
            }
            ::pause();
        }
        ::close(ends[1]);
        char letter = 0;
        EXPECT_EQ(::read(ends[0], &letter, 1), 1) << "it has begun";
        ::usleep(after);
        ::kill(child, SIGKILL);
        int made = 0;
        while (::read(ends[0], &letter, 1) == 1)
            ++made;
        ::close(ends[0]);
        int status = 0;
        ::waitpid(child, &status, 0);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        return made;
    }
    static JournalBase base_of(Document& document) {
        JournalBase base = JournalBase::of(document.registry());
        base.epoch = 1;
        base.revision = document.revision();
        return base;
    }
    fs::path own_folder() const {
        for (const auto& entry : fs::directory_iterator(folder_ / "recovery"))
            if (fs::exists(entry.path() / "journal"))
                return entry.path();
        return folder_.path;
    }
    const tests::Folder folder_{"editor_journal"};
};

} // namespace sunfleck::editor

// Who is below whom: after each edit, lists that follow what has moved are those of a look at everything. And what is
// kept for as long as a state stays: no edit is missed.
#include "tests/editor/random_edits.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <optional>

namespace sunfleck::editor {
namespace {

// From the components alone.
void expect_lists_of_everything(Document& document) {
    std::vector<Entity> roots;
    std::map<Entity, std::vector<Entity>> children;
    ecs::Registry& registry = document.registry();
    for (const Entity entity : registry.entities()) {
        if (!registry.has<scene::Name>(entity))
            continue;
        const scene::Parent* parent = registry.try_get<scene::Parent>(entity);
        const bool below =
            parent != nullptr && registry.alive(parent->parent) && registry.has<scene::Name>(parent->parent);
        (below ? children[parent->parent] : roots).push_back(entity);
    }
    EXPECT_EQ(document.roots(), roots);
    for (const Entity entity : registry.entities()) {
        const auto found = children.find(entity);
        EXPECT_EQ(document.children(entity), found == children.end() ? std::vector<Entity>() : found->second)
            << document.name(entity);
    }
}

// So many that edits of a few are followed one by one.
constexpr std::uint32_t entities = 2000;

std::unique_ptr<Document> make_tree(std::mt19937& random) {
    auto document = std::make_unique<Document>();
    std::vector<Entity> all;
    document->begin("fill");
    for (std::uint32_t i = 0; i < entities; ++i) {
        const Entity entity = document->create();
        document->set(entity, pool_of<scene::Name>(*document),
                      std::make_shared<scene::Name>(scene::Name{"entity " + std::to_string(i)}));
        if (i > 0 && random() % 4 != 0)
            document->set(entity, pool_of<scene::Parent>(*document),
                          std::make_shared<scene::Parent>(scene::Parent{all[random() % all.size()]}));
        all.push_back(entity);
    }
    document->commit();
    return document;
}

TEST(EditorTree, ListsFollowEveryEdit) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const auto document = make_tree(random);
        tests::RandomEdits edits(*document, seed);
        for (int step = 0; step < 60 && !testing::Test::HasFailure(); ++step) {
            for (std::uint32_t left = 1 + edits.below(3); left > 0; --left) // several before the lists are asked for
                switch (edits.below(5)) {
                case 0:
                    if (document->history().position() > 1) // what filled it stays
                        document->undo();
                    break;
                case 1:
                    document->redo();
                    break;
                default:
                    edits.once();
                }
            SCOPED_TRACE("step " + std::to_string(step));
            expect_lists_of_everything(*document);
        }
    }
}

// A parent that is there no more, and is there again: those below it are at the top meanwhile.
TEST(EditorTree, ChildrenOfNobodyAreAtTheTop) {
    std::mt19937 random(7);
    const auto document = make_tree(random);
    expect_lists_of_everything(*document);
    int rounds = 0;
    for (const Entity root : Entities(document->roots())) {
        if (document->children(root).empty() || ++rounds > 20)
            continue;
        const std::size_t below = document->children(root).size(), top = document->roots().size();
        document->begin("Take the name");
        document->set(root, pool_of<scene::Name>(*document), nullptr);
        document->commit();
        EXPECT_EQ(document->roots().size(), top - 1 + below);
        expect_lists_of_everything(*document);
        document->undo();
        EXPECT_EQ(document->roots().size(), top);
        expect_lists_of_everything(*document);
    }
    EXPECT_GE(rounds, 20);
}

// Where everything is, as what keeps places sees it.
std::string places(Document& document) {
    std::string bytes;
    const auto add = [&](const auto& value) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes.append(raw, sizeof raw);
    };
    for (const Entity entity : document.registry().entities())
        if (const auto placed = place_of(document, entity)) {
            add(entity);
            add(placed->world);
            add(placed->bounds);
        }
    for (const Entity entity : document.selection())
        add(entity);
    return bytes;
}

TEST(EditorTree, AStateIsAnotherAfterEveryChangeOfPlacesAndSelection) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        std::mt19937 random(seed);
        Document document;
        for (const scene::EntityTemplate& source : scene::entity_templates())
            add_from(document, source, vec3(float(random() % 9), 0.0f, 0.0f), 1.0f);
        tests::RandomEdits edits(document, seed);
        SeenState state;
        EXPECT_TRUE(state.follow(document));
        std::string before = places(document);
        int changed = 0;
        for (int step = 0; step < 400; ++step) {
            const Entities all = document.registry().entities();
            const Entity one = all.empty() ? Entity() : all[random() % all.size()];
            const std::uint32_t kind = edits.below(8);
            if (kind == 0) {
                document.undo();
            } else if (kind == 1) {
                document.redo();
            } else if (kind == 2) {
                document.select({one});
            } else if (kind == 3 && document.exists(one)) {
                document.toggle(one);
            } else if (kind == 4 && document.exists(one)) { // a drag that is given up, each half seen
                document.begin("Move");
                set_world(document, one, glm::translate(mat4(1.0f), vec3(float(step), 1.0f, 0.0f)));
                EXPECT_TRUE(state.follow(document) || places(document) == before);
                before = places(document);
                document.cancel();
            } else {
                edits.once();
            }
            const bool is_another = places(document) != before;
            EXPECT_TRUE(state.follow(document) || !is_another) << "seed " << seed << ", step " << step;
            EXPECT_FALSE(state.follow(document)) << "once";
            before = places(document);
            changed += is_another ? 1 : 0;
        }
        EXPECT_GE(changed, 100);
    }
}

// The next document may lie where the one before was, and have as many changes.
TEST(EditorTree, AnotherDocumentAtTheSamePlaceIsAnotherState) {
    std::optional<Document> document(std::in_place);
    SeenState state;
    EXPECT_TRUE(state.follow(*document));
    EXPECT_FALSE(state.follow(*document));
    document.emplace();
    EXPECT_TRUE(state.follow(*document));
}

} // namespace
} // namespace sunfleck::editor

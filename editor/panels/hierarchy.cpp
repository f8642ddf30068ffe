// The tree of entities: search, selection, names, and where they belong.
#include "editor/panels/panel.h"
#include "editor/window/commands.h"
#include "editor/window/switches.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <imgui_stdlib.h>

namespace sunfleck::editor {
namespace {

constexpr const char* payload_type = "entities";
constexpr std::size_t open_by_default = 400; // larger trees begin folded

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char letter) { return char(std::tolower(letter)); });
    return text;
}

struct Row {
    Entity entity;
    int depth;
    bool has_children;
};

class Hierarchy final : public Panel {
public:
    void draw(Session& session) override;

private:
    void follow(Session& session);
    void begin_renaming(Document& document, Entity entity);
    void open_above(Document& document, Entity entity);
    void find_rows(Document& document);
    void add_rows(Document& document, Entity entity, int depth);
    bool is_open(Entity entity) const { return open_by_default_ != (toggled_.count(entity) > 0); }
    void row(Session& session, std::size_t index);
    void row_input(Session& session, std::size_t index, bool pressed);
    void select(Session& session, std::size_t index);
    void switches(Session& session, Entity entity);
    void rename_box(Session& session, Entity entity);
    void drag_and_drop(Session& session, Entity entity);
    void drop(Session& session, Entity parent);
    void context_menu(Session& session, Entity entity);
    std::string kind_of(Document& document, Entity entity) const;
    void show_selection(Session& session);

    std::string filter_, filter_of_rows_;
    std::vector<Row> rows_;
    std::uint64_t document_ = 0; // its number
    std::uint64_t structure_revision_ = 0;
    std::unordered_set<Entity> toggled_;
    bool open_by_default_ = true, rows_are_old_ = true;
    bool is_tree_ = false; // some rows have others below them
    int deepest_ = 0;      // of the rows
    Entity renaming_, anchor_, shown_;
    int rename_frames_ = 0;
    std::string new_name_;
};

void Hierarchy::add_rows(Document& document, Entity entity, int depth) {
    // Without recursion: trees may be deep.
    std::vector<std::pair<Entity, int>> waiting{{entity, depth}};
    while (!waiting.empty()) {
        const auto [next, level] = waiting.back();
        waiting.pop_back();
        const std::vector<Entity>& children = document.children(next);
        rows_.push_back({next, level, !children.empty()});
        if (rows_.size() > document.entity_count())
            return; // a cycle in a damaged file
        if (is_open(next))
            for (auto child = children.rbegin(); child != children.rend(); ++child)
                waiting.emplace_back(*child, level + 1);
    }
}

void Hierarchy::follow(Session& session) {
    Document& document = *session.document;
    if (document_ != document.number()) {
        document_ = document.number();
        renaming_ = anchor_ = shown_ = ecs::null_entity;
        toggled_.clear();
        open_by_default_ = document.entity_count() <= open_by_default;
        rows_are_old_ = true;
    }
    if (!rows_are_old_ && structure_revision_ == document.structure_revision() && filter_of_rows_ == filter_)
        return;
    rows_are_old_ = false;
    structure_revision_ = document.structure_revision();
    filter_of_rows_ = filter_;
    find_rows(document);
    is_tree_ = std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.has_children; });
    deepest_ = 0;
    for (const Row& row : rows_)
        deepest_ = std::max(deepest_, row.depth);
}

// So that its row is there.
void Hierarchy::open_above(Document& document, Entity entity) {
    std::size_t level = 0;
    for (Entity above = document.parent(entity); !above.is_null(); above = document.parent(above)) {
        if (++level > document.entity_count())
            return; // a cycle in a damaged file
        if (is_open(above))
            continue;
        if (!toggled_.erase(above))
            toggled_.insert(above);
        rows_are_old_ = true;
    }
}

void Hierarchy::begin_renaming(Document& document, Entity entity) {
    renaming_ = entity;
    rename_frames_ = 0;
    new_name_ = document.name(entity);
}

void Hierarchy::find_rows(Document& document) {
    rows_.clear();
    if (filter_.empty()) {
        for (const Entity root : document.roots())
            add_rows(document, root, 0);
        return;
    }
    const std::string wanted = lower(filter_);
    for (const Entity root : document.roots())
        for (const Entity entity : document.family(root))
            if (lower(document.name(entity)).find(wanted) != std::string::npos ||
                lower(kind_of(document, entity)).find(wanted) != std::string::npos)
                rows_.push_back({entity, 0, false});
}

// The rarest of its components says best what it is.
std::string Hierarchy::kind_of(Document& document, Entity entity) const {
    const ecs::PoolBase* rarest = nullptr;
    for (const ecs::PoolBase* pool : document.registry().described_pools())
        if (pool->contains(entity) && !is_part_of_tree(document, *pool) &&
            (rarest == nullptr || pool->entities().size() < rarest->entities().size()))
            rarest = pool;
    return rarest == nullptr ? "" : std::string(rarest->description()->name);
}

void Hierarchy::select(Session& session, std::size_t index) {
    const ImGuiIO& io = ImGui::GetIO();
    const Entity entity = rows_[index].entity;
    if (io.KeyCtrl) {
        session.document->toggle(entity);
    } else if (io.KeyShift) {
        const auto from =
            std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.entity == anchor_; });
        std::size_t first = from == rows_.end() ? index : std::size_t(from - rows_.begin()), last = index;
        if (first > last)
            std::swap(first, last);
        Entities range;
        for (std::size_t i = first; i <= last; ++i)
            range.push_back(rows_[i].entity);
        session.document->select(range);
        shown_ = entity;
        return;
    } else {
        session.document->select({entity});
    }
    anchor_ = shown_ = entity;
}

void Hierarchy::rename_box(Session& session, Entity entity) {
    if (rename_frames_++ == 0) {
        ImGui::SetKeyboardFocusHere();
        ui::ask_for_quiet_frames();
    }
    ImGui::SetNextItemWidth(-1.0f);
    const bool enter = ImGui::InputText("##rename", &new_name_,
                                        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ui::note("rename", new_name_);
    const bool left = rename_frames_ > 2 && !ImGui::IsItemActive();
    if (!enter && !left)
        return;
    const bool escape = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false) && !enter;
    if (!escape && new_name_ != session.document->name(entity))
        session.messages.check(rename(*session.document, entity, new_name_));
    renaming_ = ecs::null_entity;
}

void Hierarchy::drop(Session& session, Entity parent) {
    if (!ImGui::BeginDragDropTarget())
        return;
    if (ImGui::AcceptDragDropPayload(payload_type) != nullptr)
        session.messages.check(reparent(*session.document, session.selected_tops(), parent));
    ImGui::EndDragDropTarget();
}

void Hierarchy::drag_and_drop(Session& session, Entity entity) {
    if (ImGui::BeginDragDropSource()) {
        if (!session.document->selected(entity))
            session.document->select({entity});
        ImGui::SetDragDropPayload(payload_type, &entity, sizeof entity);
        ImGui::TextUnformatted(what(*session.document, session.document->selection()).c_str());
        ImGui::EndDragDropSource();
    }
    drop(session, entity);
}

void Hierarchy::context_menu(Session& session, Entity entity) {
    if (!ImGui::BeginPopupContextItem("menu"))
        return;
    ui::close_by_escape();
    if (!session.document->selected(entity))
        session.document->select({entity});
    session.commands->menu("Edit", session);
    ImGui::EndPopup();
}

// An eye: shown, hidden, or, of a lamp that is muted, empty; a padlock, where it is locked.
void Hierarchy::switches(Session& session, Entity entity) {
    const bool hidden = session.hidden.count(entity) > 0, locked = session.locked.count(entity) > 0,
               muted = session.muted.count(entity) > 0;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetTextLineHeight();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 centre(low.x + 0.5f * side, low.y + 0.5f * side);
    if (ImGui::InvisibleButton("eye", ImVec2(side, side)))
        set_hidden(session, {entity}, !hidden);
    ui::note("eye " + session.document->name(entity), hidden ? "hidden" : muted ? "muted" : "shown");
    ui::tooltip(std::string(hidden  ? "Hidden: click to show it and what is below it"
                            : muted ? "Gives no light (Show, Mute lamps); click to hide it and what is below it"
                                    : "Shown: click to hide it and what is below it") +
                (locked ? "\n\nLocked (Show, Lock)" : ""));
    const ImU32 colour = ImGui::GetColorU32(ImGui::IsItemHovered() ? ImGuiCol_Text : ImGuiCol_TextDisabled);
    if (locked)
        list->AddRectFilled(ImVec2(centre.x - 0.2f * side, centre.y - 0.1f * side),
                            ImVec2(centre.x + 0.2f * side, centre.y + 0.28f * side), colour, 1.0f);
    if (hidden)
        list->AddLine(ImVec2(centre.x - 0.28f * side, centre.y), ImVec2(centre.x + 0.28f * side, centre.y), colour,
                      1.5f);
    else if (muted && !locked)
        list->AddCircle(centre, 0.2f * side, colour, 0, 1.5f);
    else if (!locked)
        list->AddCircleFilled(centre, 0.2f * side, colour);
    ImGui::SameLine(0.0f, 0.1f * ui::unit());
}

void Hierarchy::row_input(Session& session, std::size_t index, bool pressed) {
    const Entity entity = rows_[index].entity;
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0))
        begin_renaming(*session.document, entity);
    else if (pressed)
        select(session, index);
    drag_and_drop(session, entity);
    context_menu(session, entity);
}

void Hierarchy::row(Session& session, std::size_t index) {
    Document& document = *session.document;
    const Row row = rows_[index];
    ImGui::PushID(int(row.entity.index));
    switches(session, row.entity);
    // Deep trees are indented less, so that there is room for names in the deepest rows.
    const float room = std::max(ImGui::GetContentRegionAvail().x - 10.0f * ui::unit(), 0.0f);
    const float level = std::min(0.8f * ui::unit(), room / float(std::max(deepest_, 1)));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + level * float(row.depth));
    if (row.has_children) {
        const bool open = is_open(row.entity);
        if (ImGui::ArrowButton("open", open ? ImGuiDir_Down : ImGuiDir_Right)) {
            if (!toggled_.erase(row.entity))
                toggled_.insert(row.entity);
            rows_are_old_ = true;
        }
        ui::note("open " + document.name(row.entity), open ? "open" : "");
        ImGui::SameLine(0.0f, 0.2f * ui::unit());
    } else if (is_tree_) {
        ImGui::Dummy(ImVec2(ImGui::GetFrameHeight(), 0.0f));
        ImGui::SameLine(0.0f, 0.2f * ui::unit());
    }
    if (renaming_ == row.entity) {
        rename_box(session, row.entity);
    } else {
        const bool selected = document.selected(row.entity);
        const bool pressed = ImGui::Selectable("##row", selected, ImGuiSelectableFlags_AllowDoubleClick,
                                               ImVec2(0.0f, ImGui::GetTextLineHeight()));
        ui::note(document.name(row.entity), selected ? "selected" : "");
        const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
        ImDrawList* list = ImGui::GetWindowDrawList();
        const std::string& name = document.name(row.entity);
        const bool dim = session.hidden.count(row.entity) > 0;
        const std::string shown = ui::fitted(name, high.x - low.x - 2.0f);
        list->AddText(ImVec2(low.x + 2.0f, low.y), ImGui::GetColorU32(dim ? ImGuiCol_TextDisabled : ImGuiCol_Text),
                      shown.c_str());
        if (shown != name)
            ui::tooltip(name);
        const std::string kind = kind_of(document, row.entity);
        const float wide = ImGui::CalcTextSize(kind.c_str()).x;
        if (ImGui::CalcTextSize(name.c_str()).x + wide + ui::unit() < high.x - low.x)
            list->AddText(
                ImVec2(high.x - wide - 4.0f, low.y),
                ImGui::GetColorU32(selected || ImGui::IsItemHovered() ? ImGuiCol_Text : ImGuiCol_TextDisabled),
                kind.c_str());
        row_input(session, index, pressed);
    }
    ImGui::PopID();
}

// What was selected elsewhere, or is to be renamed, is scrolled to.
void Hierarchy::show_selection(Session& session) {
    const std::vector<Entity>& selection = session.document->selection();
    const Entity last = selection.empty() ? ecs::null_entity : selection.back();
    const Entity to_rename = std::exchange(session.to_rename, ecs::null_entity);
    if (session.document->exists(to_rename))
        begin_renaming(*session.document, to_rename);
    else if (last == shown_)
        return;
    shown_ = last;
    open_above(*session.document, last);
    follow(session);
    const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.entity == last; });
    if (found != rows_.end())
        ImGui::SetScrollFromPosY(ImGui::GetCursorStartPos().y +
                                 float(found - rows_.begin()) * ImGui::GetTextLineHeightWithSpacing());
}

void Hierarchy::draw(Session& session) {
    const ui::Scope scope("hierarchy");
    ui::text_box("search", filter_, "Search", -1.0f);
    ui::tooltip("Names of entities and of their components");
    if (!session.to_rename.is_null())
        filter_.clear(); // it may not be among what was found
    const bool searched = filter_of_rows_ != filter_;
    follow(session);
    ImGui::TextDisabled(filter_.empty() ? "%zu entities" : "%zu found",
                        filter_.empty() ? session.document->entity_count() : rows_.size());
    drop(session, ecs::null_entity);
    ImGui::BeginChild("rows");
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(2.0f, 0.0f));
    if (searched && filter_.empty())
        shown_ = ecs::null_entity; // where what is selected is, is another place now
    show_selection(session);
    if (searched && !filter_.empty())
        ImGui::SetScrollY(0.0f);              // what is found begins at the top
    if (!session.document->exists(renaming_)) // deleted meanwhile
        renaming_ = ecs::null_entity;
    ImGuiListClipper clipper;
    clipper.Begin(int(rows_.size()), ImGui::GetTextLineHeightWithSpacing());
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd && std::size_t(i) < rows_.size(); ++i)
            row(session, std::size_t(i));
    ImGui::PopStyleVar();
    if (rows_.empty())
        ui::hint(filter_.empty() ? "Nothing here yet: drop a file on the window, or choose Add." : "");
    ImGui::EndChild();
}

} // namespace

std::unique_ptr<Panel> make_hierarchy() {
    return std::make_unique<Hierarchy>();
}

} // namespace sunfleck::editor

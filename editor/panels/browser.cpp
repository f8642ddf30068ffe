// Tables of what the lighting keeps, as techniques and what they share declare them: sorted by any column, with what
// can be done to a row. A row that is about a light sample singles it out in overlays; names select.
#include "editor/panels/panel.h"
#include "editor/window/fields.h"
#include "gi_module/technique.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace sunfleck::editor {
namespace {

class Browser final : public Panel {
public:
    void draw(Session& session) override;

private:
    void list_of_tables(Session& session);
    void table(Session& session, const gi::Listing& listing);
    void row(Session& session, const gi::Listing& listing, int place);
    void cell(Session& session, const gi::ListingColumn& column, const gi::ListingCell& value);
    void actions(Session& session, const gi::Listing& listing, const gi::ListingRow& row);
    void sort(Session& session);

    std::string chosen_;
    std::shared_ptr<const ShownListing> shown_; // that the order is of
    std::vector<std::uint32_t> order_;          // of the rows
    int column_ = 0;                            // that they are sorted by
    bool falling_ = false;
};

std::string number_of(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string names_of(Session& session, const std::vector<Entity>& entities) {
    std::string text;
    for (const Entity entity : entities) {
        text += text.empty() ? "" : ", ";
        text += entity.is_null()                   ? "what stands still"
                : session.document->exists(entity) ? session.document->name(entity)
                                                   : "(not known)";
    }
    return text;
}

std::string text_of(Session& session, const gi::ListingCell& cell) {
    if (const auto* number = std::get_if<double>(&cell))
        return number_of(*number);
    if (const auto* text = std::get_if<std::string>(&cell))
        return *text;
    return names_of(session, std::get<std::vector<Entity>>(cell));
}

const gi::Listing* find_listing(const std::string& name) {
    const std::vector<const gi::Listing*> all = gi::all_listings();
    for (const gi::Listing* listing : all)
        if (listing->name == name)
            return listing;
    return all.empty() ? nullptr : all.front();
}

void Browser::list_of_tables(Session& session) {
    std::vector<const gi::Listing*> all = gi::all_listings();
    std::stable_sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->group < b->group; });
    std::string_view group;
    for (const gi::Listing* listing : all) {
        if (listing->group != group) {
            group = listing->group;
            ui::heading(readable_name(group));
        }
        if (ui::choice(readable_name(listing->name) + "##" + std::string(listing->name), listing->name == chosen_,
                       listing->tooltip)) {
            chosen_ = std::string(listing->name);
            column_ = 0;
            falling_ = false;
            shown_.reset();
        }
        if (listing->of_place && listing->name == chosen_) {
            bool inspects = session.gizmo.mode == GizmoMode::inspect;
            if (ui::toggle("Choose a place", inspects, "A click in the picture chooses the place that this is of (I)"))
                session.gizmo.mode = inspects ? GizmoMode::inspect : GizmoMode::move;
        }
    }
}

void Browser::sort(Session& session) {
    const std::vector<gi::ListingRow>& rows = shown_->content.rows;
    order_.resize(rows.size());
    std::iota(order_.begin(), order_.end(), 0u);
    const auto column = std::size_t(column_);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const gi::ListingCell &first = rows[a].cells[column], &second = rows[b].cells[column];
        if (const auto* x = std::get_if<double>(&first), *y = std::get_if<double>(&second);
            x != nullptr && y != nullptr)
            return *x < *y;
        return text_of(session, first) < text_of(session, second);
    };
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (rows[a].cells.size() <= column || rows[b].cells.size() <= column)
            return false;
        return falling_ ? before(b, a) : before(a, b);
    });
}

void Browser::cell(Session& session, const gi::ListingColumn& column, const gi::ListingCell& value) {
    const std::string text = text_of(session, value);
    ui::label(text);
    ui::note(column.name, text);
    const auto* entities = std::get_if<std::vector<Entity>>(&value);
    if (entities == nullptr || !ImGui::IsItemClicked())
        return;
    std::vector<Entity> known;
    for (const Entity entity : *entities)
        if (session.document->exists(entity))
            known.push_back(entity);
    if (!known.empty())
        session.document->select(known);
}

void Browser::actions(Session& session, const gi::Listing& listing, const gi::ListingRow& row) {
    for (std::uint32_t i = 0; i < listing.actions.size(); ++i) {
        const gi::ListingAction& action = listing.actions[i];
        if (i > 0)
            ImGui::SameLine();
        const std::string name(action.name);
        bool on = i < row.on.size() && row.on[i] != 0;
        const bool asked = action.stays ? ui::toggle(name, on, action.tooltip) : ui::button(name, action.tooltip);
        if (asked)
            session.scene.act({std::string(listing.name), i, row.key, on});
    }
}

void Browser::row(Session& session, const gi::Listing& listing, int place) {
    const gi::ListingRow& row = shown_->content.rows[order_[std::size_t(place)]];
    const ui::Scope scope("row " + std::to_string(place));
    ImGui::PushID(int(row.key));
    ImGui::TableNextRow();
    const bool chosen = row.sample && session.view.chosen_sample == row.sample;
    if (!listing.actions.empty()) {
        ImGui::TableNextColumn();
        actions(session, listing, row);
    }
    for (std::size_t i = 0; i < listing.columns.size() && i < row.cells.size(); ++i) {
        ImGui::TableNextColumn();
        if (i > 0 || !row.sample) {
            cell(session, listing.columns[i], row.cells[i]);
            continue;
        }
        const std::string text = text_of(session, row.cells[0]);
        ImGui::AlignTextToFramePadding();
        if (ui::choice(text, chosen, "Click: singled out in overlays"))
            session.view.chosen_sample = chosen ? std::nullopt : row.sample;
        ui::note(listing.columns[0].name, text);
    }
    ImGui::PopID();
}

// As wide as their names and what they usually hold: what there is no room for is scrolled to.
void set_up_columns(const gi::Listing& listing) {
    if (!listing.actions.empty()) {
        float width = 0.0f;
        for (const gi::ListingAction& action : listing.actions)
            width +=
                ImGui::CalcTextSize(std::string(action.name).c_str()).x + (action.stays ? 2.6f : 1.6f) * ui::unit();
        ImGui::TableSetupColumn("##actions", ImGuiTableColumnFlags_NoSort | ImGuiTableColumnFlags_WidthFixed, width);
    }
    for (const gi::ListingColumn& column : listing.columns) {
        const std::string name(column.name);
        const float width = std::max(ImGui::CalcTextSize(name.c_str()).x + 1.6f * ui::unit(), 5.0f * ui::unit());
        ImGui::TableSetupColumn(name.c_str(), ImGuiTableColumnFlags_WidthFixed, width);
    }
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    for (std::size_t i = 0; i < listing.columns.size(); ++i) {
        const gi::ListingColumn& column = listing.columns[i];
        ImGui::TableSetColumnIndex(int(i) + (listing.actions.empty() ? 0 : 1));
        ImGui::TableHeader(std::string(column.name).c_str());
        ui::note("by " + std::string(column.name));
        ui::tooltip(std::string(column.tooltip) + (column.unit.empty() ? "" : "\n\nUnit: " + std::string(column.unit)));
    }
}

void Browser::table(Session& session, const gi::Listing& listing) {
    const int first = listing.actions.empty() ? 0 : 1; // of the listing's columns
    if (!ImGui::BeginTable(chosen_.c_str(), int(listing.columns.size()) + first,
                           ImGuiTableFlags_Sortable | ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY |
                               ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable))
        return;
    ImGui::TableSetupScrollFreeze(first, 1);
    set_up_columns(listing);
    if (ImGuiTableSortSpecs* order = ImGui::TableGetSortSpecs();
        order != nullptr && order->SpecsCount > 0 && order->SpecsDirty) {
        column_ = std::max(order->Specs->ColumnIndex - first, 0);
        falling_ = order->Specs->SortDirection == ImGuiSortDirection_Descending;
        order->SpecsDirty = false;
        sort(session);
    }
    ImGuiListClipper clipper;
    clipper.Begin(int(order_.size()));
    while (clipper.Step())
        for (int place = clipper.DisplayStart; place < clipper.DisplayEnd; ++place)
            row(session, listing, place);
    ImGui::EndTable();
}

void Browser::draw(Session& session) {
    const ui::Scope scope("browser");
    const gi::Listing* listing = find_listing(chosen_);
    if (listing == nullptr)
        return;
    chosen_ = std::string(listing->name);
    session.listing = chosen_;
    if (ImGui::BeginChild("tables", ImVec2(13.0f * ui::unit(), 0.0f)))
        list_of_tables(session);
    ImGui::EndChild();
    ImGui::SameLine();
    if (ImGui::BeginChild("rows")) {
        const std::shared_ptr<const ShownListing> newest = session.scene.listing();
        if (newest == nullptr || newest->name != chosen_) {
            ImGui::TextDisabled("Waits for the next picture");
        } else {
            if (newest != shown_) {
                shown_ = newest;
                sort(session);
            }
            ui::label(shown_->content.summary);
            ui::note("summary", shown_->content.summary);
            if (!shown_->content.rows.empty())
                table(session, *listing);
        }
    }
    ImGui::EndChild();
}

} // namespace

std::unique_ptr<Panel> make_browser() {
    return std::make_unique<Browser>();
}

} // namespace sunfleck::editor

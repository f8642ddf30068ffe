#include "editor/window/colour_box.h"

#include "editor/document/lamp_flux.h"
#include "editor/window/field_parts.h"
#include "editor/window/value_box.h"
#include "engine/io/gltf.h"

#include <algorithm>
#include <cmath>
#include <imgui_internal.h>

namespace sunfleck::editor {
namespace {

float encoded(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}
vec3 encoded(vec3 linear) {
    return {encoded(linear.x), encoded(linear.y), encoded(linear.z)};
}
vec3 decoded(vec3 srgb) {
    return {scene::linear_from_srgb(srgb.x), scene::linear_from_srgb(srgb.y), scene::linear_from_srgb(srgb.z)};
}

// Colour and how much of it: the brightest component of light, 1 for a reflectance.
float intensity_of(const Field& field, vec3 value) {
    return field.unit.empty() ? 1.0f : std::max({value.x, value.y, value.z});
}

// CIE 1960.
glm::dvec2 chromaticity(vec3 colour) {
    const glm::dvec3 rgb(colour);
    const double x = 0.4124564 * rgb.x + 0.3575761 * rgb.y + 0.1804375 * rgb.z;
    const double y = 0.2126729 * rgb.x + 0.7151522 * rgb.y + 0.0721750 * rgb.z;
    const double z = 0.0193339 * rgb.x + 0.1191920 * rgb.y + 0.9503041 * rgb.z;
    return glm::dvec2(4.0 * x, 6.0 * y) / (x + 15.0 * y + 3.0 * z);
}

using Phase = ui::NumberEdit::Phase;

// What becomes of one object's value: where several differ, each goes on from its own.
using Change = std::function<vec3(vec3 own)>;

// The drag that is the gesture that is open, and the values before it; there is one pointer.
struct ColourDrag {
    ImGuiID box = 0; // 0: there is none
    std::vector<vec3> before;
};
ColourDrag& the_drag() {
    static ColourDrag only;
    return only;
}

struct ColourBox {
    Session& session;
    const FieldSource& source;
    vec3 value; // the first object's
    float intensity;
    ImGuiID id;

    bool is_dragged() const { return the_drag().box == id; }
    void type(const Change& change) const {
        apply_field_text(session, source,
                         [&](const void* object) { return colour_text(change(colour_of(*source.field, object))); });
    }
    void begin() const {
        the_drag() = {id, {}};
        for (const void* object : source.objects)
            the_drag().before.push_back(colour_of(*source.field, object));
        session.document->begin(source.gesture);
    }
    void drag(const Change& change) const {
        Document& document = *session.document;
        const std::vector<vec3>& before = the_drag().before;
        // Ended by something else: loss of focus, a value that cannot be, another selection.
        if (!document.in_gesture() || before.size() != source.objects.size())
            return;
        for (std::size_t i = 0; i < before.size(); ++i)
            if (const Status status = source.set(i, colour_text(change(before[i]))); !status) {
                session.messages.check(status);
                return document.cancel();
            }
    }
    void end(bool keep) const {
        if (!is_dragged())
            return;
        the_drag() = {};
        if (keep)
            session.document->commit();
        else
            session.document->cancel();
    }
    bool any(const std::function<bool(vec3 own)>& is_so) const {
        return std::any_of(source.objects.begin(), source.objects.end(),
                           [&](const void* object) { return is_so(colour_of(*source.field, object)); });
    }
    // `changed`: what a number makes of an object's own value.
    void number(const std::string& name, const ui::NumberLook& look,
                const std::function<vec3(vec3 own, double number)>& changed) const {
        const ui::NumberEdit edit = ui::number_box(name, look);
        ImGui::SameLine();
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(name.c_str());
        switch (edit.phase) {
        case Phase::began:
            return begin();
        case Phase::dragged:
            return drag([&](vec3 own) { return changed(own, edit.value); });
        case Phase::ended:
            return end(true);
        case Phase::cancelled:
            return end(false);
        case Phase::typed:
            if (const std::optional<double> typed = typed_value(session, name, edit.text, look))
                type([&](vec3 own) { return changed(own, *typed); });
            return;
        case Phase::none:
            return;
        }
    }
};

void hue_picker(const ColourBox& box) {
    const Field& field = *box.source.field;
    vec3 shown = encoded(glm::clamp(box.value / std::max(box.intensity, 1e-12f), 0.0f, 1.0f));
    const bool changed = ImGui::ColorPicker3("##picker", &shown.x,
                                             ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                                                 ImGuiColorEditFlags_DisplayRGB | ImGuiColorEditFlags_InputRGB);
    ui::note("picker");
    if (changed) {
        const bool is_light = !field.unit.empty();
        vec3 chosen = decoded(shown);
        const float brightest = std::max({chosen.x, chosen.y, chosen.z});
        if (is_light && brightest > 0.0f)
            chosen /= brightest;
        if (!box.is_dragged())
            box.begin();
        box.drag([&](vec3 own) { return chosen * intensity_of(field, own); });
    }
    if (!ImGui::IsAnyItemActive()) // a number says itself that its drag has ended
        box.end(true);
}

void amount_row(const ColourBox& box, const std::string& name, const std::string& unit, double factor) {
    const auto intensity = [&](vec3 own) { return intensity_of(*box.source.field, own); };
    ui::NumberLook look;
    look.value = double(box.intensity) * factor;
    look.mixed = box.any([&](vec3 own) { return intensity(own) != box.intensity; });
    look.maximum = box.source.field->maximum * factor;
    look.unit = unit;
    look.width = 9.0f * ui::unit();
    box.number(name, look, [&](vec3 own, double number) {
        const float brightest = intensity(own);
        return (brightest > 0.0f ? own / brightest : vec3(1.0f)) * float(number / factor);
    });
    ui::tooltip("The brightest component; colours keep their ratios");
}

void amount_rows(const ColourBox& box) {
    const Field& field = *box.source.field;
    const double lumens = double(io::luminous_efficacy);
    amount_row(box, "Intensity", std::string(field.unit), 1.0);
    if (const std::string unit = photometric_unit(field.unit); !unit.empty())
        amount_row(box, "Photometric", unit, lumens);
    if (const double flux = flux_per_unit(field, box.source.objects[0]); flux > 0.0 && box.source.objects.size() == 1)
        amount_row(box, "Flux", "lm", lumens * flux);
}

void temperature_row(const ColourBox& box) {
    constexpr double usual = 6500.0; // where a drag begins that begins at no temperature
    const std::optional<float> kelvin = colour_temperature(box.value);
    const bool differ = box.any([&](vec3 own) {
        const vec3 beside = own * box.intensity - box.value * intensity_of(*box.source.field, own);
        const float whole = std::max(box.intensity * intensity_of(*box.source.field, own), 1e-30f);
        const bool same_colour = glm::length(beside) < 1e-5f * whole; // which is quicker to see
        return !same_colour && colour_temperature(own) != kelvin;
    });
    ui::NumberLook look;
    look.value = kelvin ? double(*kelvin) : usual;
    look.mixed = !kelvin || differ;
    look.instead = differ ? "mixed" : "none";
    look.enabled = box.intensity > 0.0f || differ;
    look.minimum = double(coldest_body);
    look.maximum = double(hottest_body);
    look.unit = "K";
    look.whole = true;
    look.width = 9.0f * ui::unit();
    box.number("Temperature", look, [&](vec3 own, double number) {
        return intensity_of(*box.source.field, own) * black_body_colour(float(number));
    });
    ui::tooltip("Of the black body whose colour comes closest: candle 1,900 K, bulb 2,700 K, noon 5,500 K, blue sky "
                "10,000 K");
}

} // namespace

vec3 black_body_colour(float kelvin) {
    const double t = std::clamp(double(kelvin), double(coldest_body), double(hottest_body)), u = 1e3 / t;
    const double x = t <= 4000.0 ? ((-0.2661239 * u - 0.2343589) * u + 0.8776956) * u + 0.179910
                                 : ((-3.0258469 * u + 2.1070379) * u + 0.2226347) * u + 0.240390;
    const double y = t <= 2222.0   ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                     : t <= 4000.0 ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                                   : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
    const double X = x / y, Z = (1.0 - x - y) / y;
    const vec3 colour(float(3.2404542 * X - 1.5371385 - 0.4985314 * Z),
                      float(-0.9692660 * X + 1.8760108 + 0.0415560 * Z),
                      float(0.0556434 * X - 0.2040259 + 1.0572252 * Z));
    const vec3 seen = glm::max(colour, vec3(0.0f));
    return seen / std::max({seen.x, seen.y, seen.z});
}

std::optional<float> colour_temperature(vec3 colour) {
    if (std::max({colour.x, colour.y, colour.z}) <= 0.0f)
        return std::nullopt;
    constexpr double most = 0.05, at_an_end = 1e-4; // at an end of the range, the closest one may lie beyond
    constexpr int steps = 128;
    // In reciprocal temperatures, 1/MK, along which the locus goes about evenly.
    const double coldest = 1e6 / double(coldest_body), hottest = 1e6 / double(hottest_body);
    const glm::dvec2 seen = chromaticity(colour);
    const auto away = [&](double reciprocal) {
        return glm::length(chromaticity(black_body_colour(float(1e6 / reciprocal))) - seen);
    };
    const auto at = [&](int step) { return hottest + (coldest - hottest) * double(step) / steps; };
    int best = 0;
    for (int step = 1; step <= steps; ++step)
        if (away(at(step)) < away(at(best)))
            best = step;
    double low = at(std::max(best - 1, 0)), high = at(std::min(best + 1, steps));
    while (high - low > 1e-4) {
        const double third = (high - low) / 3.0;
        if (away(low + third) < away(high - third))
            high -= third;
        else
            low += third;
    }
    const double found = 0.5 * (low + high);
    const bool is_end = found - hottest < 1e-3 || coldest - found < 1e-3;
    if (away(found) > (is_end ? at_an_end : most))
        return std::nullopt;
    return float(1e6 / found);
}

std::string photometric_unit(std::string_view unit) {
    if (unit == "W/sr")
        return "cd";
    if (unit == "W/m2")
        return "lx";
    if (unit == "W/(sr m2)")
        return "cd/m\xc2\xb2";
    return "";
}

void colour_cell(Session& session, const FieldSource& source) {
    const vec3 value = colour_of(*source.field, source.objects[0]);
    const float intensity = intensity_of(*source.field, value);
    const vec3 shown = encoded(glm::clamp(value / std::max(intensity, 1e-12f), 0.0f, 1.0f));
    const float side = ImGui::GetFrameHeight();
    const ColourBox box{session, source, value, intensity, ImGui::GetID("colour")};
    if (ImGui::ColorButton("colour", ImVec4(shown.x, shown.y, shown.z, 1.0f), ImGuiColorEditFlags_NoTooltip,
                           ImVec2(side, side)))
        ImGui::OpenPopup("colour");
    ui::note("colour");
    ui::tooltip("Choose a colour");
    if (!ImGui::BeginPopup("colour"))
        return box.end(false); // it was closed in the middle of a drag
    const bool escape = ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape], false);
    if (box.is_dragged() && escape && !ui::editing_number()) { // a number takes it itself
        ImGui::ClearActiveID();
        box.end(false);
    } else {
        ui::close_by_escape();
    }
    ImGui::SetNextItemWidth(13.0f * ui::unit());
    hue_picker(box);
    if (!source.field->unit.empty()) {
        amount_rows(box);
        temperature_row(box);
    }
    ImGui::EndPopup();
}

} // namespace sunfleck::editor

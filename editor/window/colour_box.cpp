#include "editor/window/colour_box.h"

#include "editor/document/lamp_flux.h"
#include "editor/window/field_parts.h"
#include "editor/window/widgets.h"
#include "engine/io/gltf.h"

#include <algorithm>
#include <cmath>

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

// The photometric unit of a radiometric one; none: "".
std::string photometric(std::string_view unit) {
    if (unit == "W/sr")
        return "cd";
    if (unit == "W/m2")
        return "lx";
    if (unit == "W/(sr m2)")
        return "cd/m\xc2\xb2";
    return "";
}

void set_colour(Session& session, const FieldSource& source, vec3 value) {
    apply_field_text(session, source, [&](const void*) { return colour_text(value); });
}

// A gesture that lasts as long as the pointer is held.
void set_while_dragged(Session& session, const FieldSource& source, vec3 value) {
    Document& document = *session.document;
    if (!document.in_gesture())
        document.begin(source.gesture);
    for (std::size_t i = 0; i < source.objects.size(); ++i)
        if (const Status status = source.set(i, colour_text(value)); !status) {
            session.messages.check(status);
            document.cancel();
            return;
        }
}

void hue_picker(Session& session, const FieldSource& source, vec3 value, float intensity) {
    vec3 shown = encoded(glm::clamp(value / std::max(intensity, 1e-12f), 0.0f, 1.0f));
    const bool changed = ImGui::ColorPicker3("##picker", &shown.x,
                                             ImGuiColorEditFlags_PickerHueWheel | ImGuiColorEditFlags_NoSidePreview |
                                                 ImGuiColorEditFlags_DisplayRGB | ImGuiColorEditFlags_InputRGB);
    ui::note("picker");
    if (changed) {
        vec3 chosen = decoded(shown);
        const float brightest = std::max({chosen.x, chosen.y, chosen.z});
        if (!source.field->unit.empty() && brightest > 0.0f)
            chosen /= brightest;
        set_while_dragged(session, source, chosen * (source.field->unit.empty() ? 1.0f : intensity));
    }
    if (session.document->in_gesture() && !ImGui::IsAnyItemActive())
        session.document->commit();
}

void amount_row(Session& session, const FieldSource& source, vec3 value, float intensity) {
    const double lumens = double(io::luminous_efficacy);
    const vec3 colour = intensity > 0.0f ? value / intensity : vec3(1.0f);
    const auto row = [&](const char* name, const std::string& unit, double factor) {
        ui::NumberLook look;
        look.value = double(intensity) * factor;
        look.maximum = source.field->maximum * factor;
        look.unit = unit;
        look.width = 9.0f * ui::unit();
        const ui::NumberEdit edit = ui::number_box(name, look);
        ImGui::SameLine();
        ImGui::TextUnformatted(name);
        ui::tooltip("The brightest component; colours keep their ratios");
        const double given = edit.phase == ui::NumberEdit::Phase::typed ? std::atof(edit.text.c_str()) : edit.value;
        if (edit.phase == ui::NumberEdit::Phase::typed)
            set_colour(session, source, colour * float(given / factor));
        if (edit.phase == ui::NumberEdit::Phase::dragged)
            set_while_dragged(session, source, colour * float(given / factor));
    };
    row("Intensity", std::string(source.field->unit), 1.0);
    if (const std::string unit = photometric(source.field->unit); !unit.empty())
        row("Photometric", unit, lumens);
    if (const double flux = flux_per_unit(*source.field, source.objects[0]); flux > 0.0 && source.objects.size() == 1)
        row("Flux", "lm", lumens * flux);
}

void temperature_row(Session& session, const FieldSource& source, float intensity) {
    static float kelvin = 3000.0f;
    ui::NumberLook look;
    look.value = double(kelvin);
    look.minimum = 1667.0;
    look.maximum = 25000.0;
    look.unit = "K";
    look.whole = true;
    look.width = 9.0f * ui::unit();
    const ui::NumberEdit edit = ui::number_box("Temperature", look);
    ImGui::SameLine();
    ImGui::TextUnformatted("Temperature");
    ui::tooltip("Colour of a black body: candle 1,900 K, bulb 2,700 K, noon 5,500 K, blue sky 10,000 K");
    const bool typed = edit.phase == ui::NumberEdit::Phase::typed;
    if (!typed && edit.phase != ui::NumberEdit::Phase::dragged)
        return;
    const double given = typed ? std::atof(edit.text.c_str()) : edit.value;
    kelvin = std::clamp(float(given), 1667.0f, 25000.0f);
    const vec3 value = intensity * black_body_colour(kelvin);
    if (typed)
        set_colour(session, source, value);
    else
        set_while_dragged(session, source, value);
}

} // namespace

vec3 black_body_colour(float kelvin) {
    const double t = std::clamp(double(kelvin), 1667.0, 25000.0), u = 1e3 / t;
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

void colour_cell(Session& session, const FieldSource& source) {
    const vec3 value = colour_of(*source.field, source.objects[0]);
    const float intensity = intensity_of(*source.field, value);
    const vec3 shown = encoded(glm::clamp(value / std::max(intensity, 1e-12f), 0.0f, 1.0f));
    const float side = ImGui::GetFrameHeight();
    if (ImGui::ColorButton("colour", ImVec4(shown.x, shown.y, shown.z, 1.0f), ImGuiColorEditFlags_NoTooltip,
                           ImVec2(side, side)))
        ImGui::OpenPopup("colour");
    ui::note("colour");
    ui::tooltip("Choose a colour");
    if (!ImGui::BeginPopup("colour"))
        return;
    ui::close_by_escape();
    ImGui::SetNextItemWidth(13.0f * ui::unit());
    hue_picker(session, source, value, intensity);
    if (!source.field->unit.empty()) {
        amount_row(session, source, value, intensity);
        temperature_row(session, source, intensity);
    }
    ImGui::EndPopup();
}

} // namespace sunfleck::editor

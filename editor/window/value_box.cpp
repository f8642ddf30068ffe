#include "editor/window/value_box.h"

#include "editor/window/field_parts.h"

namespace sunfleck::editor {

std::optional<double> typed_value(Session& session, const std::string& meaning, const std::string& text,
                                  const ui::NumberLook& look) {
    const std::optional<double> number = typed_number(text);
    if (number && *number >= look.minimum && *number <= look.maximum)
        return number;
    const std::string most =
        look.maximum < unbounded ? " to " + ui::number_text(look.maximum, look.whole) : std::string(" or more");
    session.messages.say("'" + text + "' is not a value of '" + meaning +
                             "': " + ui::number_text(look.minimum, look.whole) + most +
                             (look.unit.empty() ? "" : " " + look.unit),
                         Message::Kind::error);
    return std::nullopt;
}

std::optional<double> value_box(Session& session, const std::string& name, const std::string& meaning,
                                const ui::NumberLook& look) {
    using Phase = ui::NumberEdit::Phase;
    static double before = 0.0; // the drag that goes on: there is one pointer
    const ui::NumberEdit edit = ui::number_box(name, look);
    switch (edit.phase) {
    case Phase::began:
        before = look.value;
        return std::nullopt;
    case Phase::dragged:
        return edit.value;
    case Phase::cancelled:
        return before;
    case Phase::typed:
        return typed_value(session, meaning, edit.text, look);
    case Phase::ended:
    case Phase::none:
        break;
    }
    return std::nullopt;
}

} // namespace sunfleck::editor

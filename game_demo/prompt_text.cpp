#include "game_demo/prompt_text.h"

namespace sunfleck::demo {
namespace {

const char* verb(simulation::Interaction interaction) {
    switch (interaction) {
    case simulation::Interaction::open:
        return "open";
    case simulation::Interaction::close:
        return "close";
    case simulation::Interaction::switch_lamps:
        return "switch the lamp";
    case simulation::Interaction::take:
        return "take the lantern";
    case simulation::Interaction::none:
        break;
    }
    return "";
}

} // namespace

std::string prompt_text(const DemoSettings& settings, simulation::Interaction interaction, bool carries_lantern,
                        bool with_gamepad) {
    const auto button = [&](Action action, const char* of_gamepad) {
        return with_gamepad ? std::string(of_gamepad) : app::key_name(settings.bindings[std::size_t(action)]);
    };
    if (interaction != simulation::Interaction::none)
        return button(Action::use, "A") + "  " + verb(interaction);
    return carries_lantern ? button(Action::put_down, "X") + "  put down the lantern" : std::string();
}

const char* help_text(bool is_game) {
    return is_game ? "In each room an eye looks at a wall. The door opens once enough light of the eye's\n"
                     "colours comes back from there; the bars below show how much does. Carry the lantern,\n"
                     "slide panels, open shutters, push the block. The pause menu has a hint, and puts\n"
                     "a room back as it was."
                   : "Walk into balls and crates to push them. The lift in the green room\n"
                     "leads to the attic. Switches beside the doors turn lamps on and off.";
}

} // namespace sunfleck::demo

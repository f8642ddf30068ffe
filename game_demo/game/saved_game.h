// A game as text, for checkpoints: JSON with a version and a checksum. Entities are told by their names.
#pragma once

#include "game_demo/game/game_world.h"

#include <functional>

namespace sunfleck::demo {

// `level`: its identity (checkpoint_files.h).
std::string save_game(const GameWorld& world, const std::string& level);
// The same in two parts: what the world holds now is kept, and any thread makes the text of it, which takes longer.
std::function<std::string()> keep_game(const GameWorld& world, const std::string& level);
// The text without its line breaks, as recordings begin with it.
std::string on_one_line(std::string saved);
// Into a world of the same level; its world hash is then what it was when the text was made. An error says what is
// wrong with the text (damage, another level or one that was changed since, another version); the world may be half of
// each then and must be restarted.
Status load_game(GameWorld& world, const std::string& level, const std::string& text);

} // namespace sunfleck::demo

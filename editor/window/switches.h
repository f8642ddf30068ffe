// Which entities are shown, which lamps shine, and which are left alone by clicks, handles and Delete: switches of the
// session, of which the document and its file know nothing. They are of entities with all that is below them.
#pragma once

#include "editor/window/session.h"

namespace sunfleck::editor {

// With all that is below them, each once.
Entities with_families(Document& document, const Entities& entities);
void set_hidden(Session& session, const Entities& entities, bool hidden);
// What is selected is locked, or no longer where all of it is.
void toggle_lock(Session& session);
// The lamps among what is selected and below are muted, or no longer where all of them are.
void toggle_mute(Session& session);
// Whether once more would undo them.
bool is_locked(Session& session);
bool is_muted(Session& session);
bool is_solo(const Session& session);
// All lamps but those among what is selected and below are hidden, and whatever was; once more: what was hidden before.
void toggle_solo(Session& session);
// Of the selection's topmost those that may be moved and deleted: neither they nor anything below them is locked.
Entities free_tops(Session& session);
// Deletes these, and says what stays.
void delete_selection(Session& session);

} // namespace sunfleck::editor

// An edit of one component of an entity that is known by its name, as a gesture of its own.
#pragma once

#include "editor/document/edits.h"

#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <string>

namespace sunfleck::editor {

template <typename T>
void change(Document& document, const std::string& name, const std::function<void(T&)>& edit) {
    const Entity entity = document.find(name);
    ASSERT_TRUE(document.exists(entity)) << name;
    auto value = std::make_shared<T>(document.registry().get<T>(entity));
    edit(*value);
    document.begin("Change " + name);
    document.set(entity, pool_of<T>(document), std::move(value));
    document.commit();
}

} // namespace sunfleck::editor
